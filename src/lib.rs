//! Volumetric photon mapping of homogeneous and OpenVDB media.

pub mod camera;
pub mod emission;
pub mod estimate;
pub mod film;
pub mod light;
pub mod map;
pub mod math;
pub mod medium;
pub mod render;
pub mod scene;
pub mod trace;
