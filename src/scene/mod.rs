//! The scene: what the file says, checked and made ready.

use crate::camera::Camera;
use crate::emission::EmissionKind;
use crate::estimate::{Divisor, Kernel};
use crate::light::Light;
use crate::medium::Medium;

/// A validated scene. Nothing in it can be out of range.
#[derive(Debug)]
pub struct Scene {
    /// Where the image is taken from.
    pub camera: Camera,
    /// What fills it.
    pub medium: Medium,
    /// At least one.
    pub lights: Vec<Light>,
    /// How photons are emitted and followed.
    pub photons: PhotonSettings,
    /// How the photon map is read.
    pub estimate: EstimateSettings,
    /// How pixels are sampled.
    pub render: RenderSettings,
}

/// `[photons]`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonSettings {
    /// Photons emitted per pass.
    pub count: u64,
    /// How they are sampled.
    pub emission: EmissionKind,
    /// Seed of every random number.
    pub seed: u64,
    /// Scatterings a photon is followed through; what is cut is counted.
    pub max_order: u32,
}

/// `[estimate]`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimateSettings {
    /// Photons of one estimate.
    pub k: usize,
    /// Numerator of the estimate.
    pub divisor: Divisor,
    /// Weight by distance.
    pub kernel: Kernel,
    /// Largest radius of a query \[m\]; `None`: a share of the medium's size.
    pub max_radius: Option<f64>,
}

/// `[render]`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// Rays a pixel, jittered in a grid of that many cells.
    pub samples_per_pixel: usize,
    /// Photon-map queries a ray.
    pub march_samples: usize,
    /// Single-scattering points a ray and light.
    pub light_samples: usize,
    /// Whether single scattering, too, comes from photons (for the lab).
    pub photons_only: bool,
}
