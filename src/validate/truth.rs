//! The exact answers. `truth/README.md` tells where they come from.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::error::ValidateError;

/// Exact answers. Lengths are in mean free paths, lights send 1 W, unless said otherwise.
#[derive(Clone, Debug)]
pub struct Truth {
    /// A point light in a medium without end.
    pub infinite: Infinite,
    /// A point light at the centre of a ball.
    pub ball: Vec<BallTruth>,
    /// Radiance along rays past it.
    pub glow: Vec<GlowingBall>,
    /// The same in a medium without end.
    pub glow_infinite: Vec<GlowSeen>,
    /// Single scattering along rays.
    pub airlight: Vec<AirlightRay>,
    /// What slabs reflect and let pass.
    pub slab: Vec<SlabTruth>,
    /// Fluence in slabs by depth.
    pub slab_fluence: Vec<SlabFluence>,
    /// Media that vary.
    pub hetero: Hetero,
}

impl Truth {
    /// The answers that come with the program.
    ///
    /// # Errors
    /// They are damaged.
    pub fn embedded() -> Result<Self, ValidateError> {
        Ok(Self {
            infinite: read("infinite.json", include_str!("truth/infinite.json"))?,
            ball: read("sphere.json", include_str!("truth/sphere.json"))?,
            glow: read("glow.json", include_str!("truth/glow.json"))?,
            glow_infinite: read("glow_infinite.json", include_str!("truth/glow_infinite.json"))?,
            airlight: read("airlight.json", include_str!("truth/airlight.json"))?,
            slab: read("slab.json", include_str!("truth/slab.json"))?,
            slab_fluence: read("slab_fluence.json", include_str!("truth/slab_fluence.json"))?,
            hetero: read("hetero.json", include_str!("truth/hetero.json"))?,
        })
    }
}

fn read<T: DeserializeOwned>(file: &'static str, text: &str) -> Result<T, ValidateError> {
    serde_json::from_str(text).map_err(|source| ValidateError::Truth { file, source })
}

/// A point light in a medium without end, isotropic but for `hg`.
#[derive(Clone, Debug, Deserialize)]
pub struct Infinite {
    /// Collisions a photon within a radius, by albedo and radius.
    pub enclosed: BTreeMap<String, BTreeMap<String, f64>>,
    /// Fluence by albedo and radius.
    pub phi: BTreeMap<String, BTreeMap<String, f64>>,
    /// Fluence of light scattered exactly so many times, albedo 1, by radius.
    pub orders_albedo1: BTreeMap<String, BTreeMap<String, f64>>,
    /// Henyey-Greenstein scattering.
    pub hg: Vec<FluenceByRadius>,
}

/// Fluence about a point light in an anisotropic medium.
#[derive(Clone, Debug, Deserialize)]
pub struct FluenceByRadius {
    /// sigma_s / sigma_t.
    pub albedo: f64,
    /// Mean cosine.
    pub g: f64,
    /// Radii.
    pub r: Vec<f64>,
    /// Fluence at each.
    pub phi: Vec<f64>,
}

/// A point light at the centre of a ball.
#[derive(Clone, Debug, Deserialize)]
pub struct BallTruth {
    /// sigma_s / sigma_t.
    #[serde(rename = "a")]
    pub albedo: f64,
    /// Of the ball.
    #[serde(rename = "R")]
    pub radius: f64,
    /// Collisions a photon.
    pub mean_collisions: f64,
    /// Share of the light that escapes.
    pub escape: f64,
    /// Radii.
    pub r: Vec<f64>,
    /// Fluence at each.
    pub phi: Vec<f64>,
}

/// Radiance along rays past a point light at the centre of a ball.
#[derive(Clone, Debug, Deserialize)]
pub struct GlowingBall {
    /// sigma_s / sigma_t.
    pub albedo: f64,
    /// Of the ball.
    #[serde(rename = "R")]
    pub radius: f64,
    /// Impact parameters over the radius.
    #[serde(rename = "b_over_R")]
    pub impacts: Vec<f64>,
    /// Radiance at each, the light itself left out.
    #[serde(rename = "L")]
    pub radiance: Vec<f64>,
}

/// Radiance along a ray past a point light in a medium without end.
#[derive(Clone, Debug, Deserialize)]
pub struct GlowSeen {
    /// sigma_s / sigma_t.
    pub albedo: f64,
    /// From the ray's start to the light.
    pub camera_distance: f64,
    /// Smallest distance of the ray to the light.
    pub impact: f64,
    /// Radiance of all scattered light.
    #[serde(rename = "L_total")]
    pub total: f64,
    /// Of light scattered once.
    #[serde(rename = "L_single")]
    pub single: f64,
}

/// Single scattering of a point light along a ray.
#[derive(Clone, Debug, Deserialize)]
pub struct AirlightRay {
    /// What it tries.
    pub name: String,
    /// The light's place \[m\].
    pub light: [f64; 3],
    /// The ray's start \[m\].
    pub origin: [f64; 3],
    /// The ray's direction, of any length.
    pub dir_unnormalised: [f64; 3],
    /// Its end \[m\]; nothing: none.
    pub tmax: Option<f64>,
    /// \[1/m\]
    pub sigma_t: f64,
    /// sigma_s / sigma_t.
    pub albedo: f64,
    /// Mean cosine.
    pub g: f64,
    /// `infinite`, or the box from -1 to 1.
    pub medium: String,
    /// Radiance.
    #[serde(rename = "L")]
    pub radiance: f64,
}

/// What a slab does with light along its normal, and with the same radiance from all sides.
#[derive(Clone, Debug, Deserialize)]
pub struct SlabTruth {
    /// sigma_s / sigma_t.
    #[serde(rename = "a")]
    pub albedo: f64,
    /// Mean cosine.
    pub g: f64,
    /// Optical thickness; nothing: without end.
    pub tau: Option<f64>,
    /// Share reflected, along the normal.
    #[serde(rename = "R_normal")]
    pub reflected_normal: f64,
    /// Share that passes, unscattered light included.
    #[serde(rename = "T_normal")]
    pub passed_normal: f64,
    /// Share reflected, from all sides.
    #[serde(rename = "R_diffuse")]
    pub reflected_diffuse: f64,
    /// Share that passes.
    #[serde(rename = "T_diffuse")]
    pub passed_diffuse: f64,
}

/// Fluence in a slab by depth, for a flux of 1.
#[derive(Clone, Debug, Deserialize)]
pub struct SlabFluence {
    /// sigma_s / sigma_t.
    #[serde(rename = "a")]
    pub albedo: f64,
    /// Mean cosine.
    pub g: f64,
    /// Optical thickness; nothing: without end.
    pub tau: Option<f64>,
    /// Depths.
    pub depth: Vec<f64>,
    /// Fluence at each, of light along the normal.
    pub phi_normal: Vec<f64>,
    /// The same of light from all sides.
    pub phi_diffuse: Vec<f64>,
}

/// Media that vary from place to place.
#[derive(Clone, Debug, Deserialize)]
pub struct Hetero {
    /// Optical depths through fields of closed form.
    pub depths: Vec<Depth>,
    /// Statistics of delta and of ratio tracking.
    pub tracking: Vec<Tracking>,
    /// Free flight where sigma_t = 0.75 x, from 0.
    pub free_flight: FreeFlight,
}

/// An optical depth.
#[derive(Clone, Debug, Deserialize)]
pub struct Depth {
    /// Which.
    pub name: String,
    /// How much.
    pub tau: f64,
}

/// How estimates of a transmittance are distributed.
#[derive(Clone, Debug, Deserialize)]
pub struct Tracking {
    /// The field.
    pub name: String,
    /// The majorant \[1/m\].
    pub majorant: f64,
    /// Their mean.
    pub transmittance: f64,
    /// Variance of ratio tracking.
    pub ratio_variance: f64,
    /// Variance of delta tracking.
    pub delta_variance: f64,
    /// Lookups of ratio tracking.
    pub lookups: f64,
}

/// A distribution of distances.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct FreeFlight {
    /// \[m\]
    pub mean: f64,
    /// \[m^2\]
    pub variance: f64,
}
