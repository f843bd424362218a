//! Reading OpenVDB files.
//!
//! [`VolumeSource`] is the seam: whatever reads the file returns plain [`SparseGrid`]s.

mod sparse;

pub use sparse::{SparseGrid, Tile};
