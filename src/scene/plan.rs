//! The plan of a render: what this scene needs of the program, and nothing more.

use std::fmt;

use serde::Serialize;

use super::Scene;
use super::file::{divisor_word, emission_word};
use crate::light::Light;
use crate::math::{Rgb, max_channel};
use crate::medium::{Bounds, MediumExtinction, Phase};

/// What a scene needs; printed before a render and part of its report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// Kind of extinction.
    pub medium: MediumKind,
    /// Whether scattered light goes all ways alike.
    pub isotropic: bool,
    /// Whether sigma_t or the albedo differs between the channels.
    pub chromatic: bool,
    /// Lights of each kind.
    pub lights: LightCounts,
    /// Whether free flights are sampled against majorants (delta tracking) rather than in closed form.
    pub majorants: bool,
    /// Photons emitted per pass.
    pub photons: u64,
    /// How they are sampled, as scene files spell it.
    pub emission: &'static str,
    /// Photons of one estimate.
    pub k: usize,
    /// Numerator of the estimate, as scene files spell it.
    pub divisor: &'static str,
    /// Photons that a pass is expected to store, to the order of magnitude.
    pub expected_stored: u64,
    /// Memory of the photon map of one pass, to the order of magnitude \[bytes\].
    pub photon_memory_bytes: u64,
}

/// How extinction varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum MediumKind {
    /// The same everywhere.
    Homogeneous,
    /// From a density grid.
    Grid,
}

/// How many lights of each kind a scene has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[allow(missing_docs)]
pub struct LightCounts {
    pub point: usize,
    pub spot: usize,
    pub directional: usize,
    pub environment: usize,
    pub quad: usize,
    pub sphere: usize,
}

/// A photon and its place in the tree \[bytes\].
const PHOTON_BYTES: u64 = 64;

impl Plan {
    /// The plan of a scene.
    pub fn of(scene: &Scene) -> Self {
        let medium = &scene.medium;
        let is_grid = matches!(medium.extinction, MediumExtinction::Grid(_));
        let expected_stored = (scene.photons.count as f64 * expected_collisions(scene)) as u64;
        Self {
            medium: if is_grid { MediumKind::Grid } else { MediumKind::Homogeneous },
            isotropic: medium.phase == Phase::Isotropic,
            chromatic: matches!(medium.extinction, MediumExtinction::Chromatic(_))
                || medium.albedo != Rgb::splat(medium.albedo.x),
            lights: LightCounts::of(&scene.lights),
            majorants: is_grid,
            photons: scene.photons.count,
            emission: emission_word(scene.photons.emission),
            k: scene.estimate.k,
            divisor: divisor_word(scene.estimate.divisor),
            expected_stored,
            photon_memory_bytes: expected_stored.saturating_mul(PHOTON_BYTES),
        }
    }
}

/// Collisions of a photon that enters the medium: with probability p of colliding on a flight and albedo a,
/// p + p (a p) + p (a p)^2 + ... up to the largest order followed.
fn expected_collisions(scene: &Scene) -> f64 {
    let collides = 1.0 - (-typical_optical_depth(scene)).exp();
    let goes_on = collides * max_channel(scene.medium.albedo);
    let orders = f64::from(scene.photons.max_order);
    let geometric = (1.0 - goes_on.powf(orders)) / (1.0 - goes_on);
    collides * if goes_on < 1.0 { geometric } else { orders }
}

/// Optical depth over the mean chord 4 V / S of the medium (Cauchy).
fn typical_optical_depth(scene: &Scene) -> f64 {
    let sigma_t = match &scene.medium.extinction {
        MediumExtinction::Uniform(uniform) => uniform.sigma_t,
        MediumExtinction::Chromatic(chromatic) => max_channel(chromatic.sigma_t),
        MediumExtinction::Grid(_) => 0.0,
    };
    if sigma_t == 0.0 { 0.0 } else { sigma_t * mean_chord(&scene.medium.bounds) }
}

fn mean_chord(bounds: &Bounds) -> f64 {
    let of_edges = |[u, v, w]: [crate::math::DVec3; 3]| {
        let faces = u.cross(v).length() + v.cross(w).length() + w.cross(u).length();
        2.0 * u.cross(v).dot(w).abs() / faces
    };
    match bounds {
        Bounds::Box { min, max } => {
            let size = *max - *min;
            of_edges([
                size.with_y(0.0).with_z(0.0),
                size.with_x(0.0).with_z(0.0),
                size.with_x(0.0).with_y(0.0),
            ])
        }
        Bounds::Sphere { radius, .. } => 4.0 / 3.0 * radius,
        Bounds::Parallelepiped(shape) => of_edges(shape.edges()),
        Bounds::Infinite => f64::INFINITY,
    }
}

impl LightCounts {
    fn of(lights: &[Light]) -> Self {
        let mut counts = Self::default();
        for light in lights {
            *match light {
                Light::Point(_) => &mut counts.point,
                Light::Spot(_) => &mut counts.spot,
                Light::Directional(_) => &mut counts.directional,
                Light::Environment(_) => &mut counts.environment,
                Light::Quad(_) => &mut counts.quad,
                Light::Sphere(_) => &mut counts.sphere,
            } += 1;
        }
        counts
    }

    fn by_name(&self) -> [(usize, &'static str); 6] {
        [
            (self.point, "point"),
            (self.spot, "spot"),
            (self.directional, "directional"),
            (self.environment, "environment"),
            (self.quad, "quad"),
            (self.sphere, "sphere"),
        ]
    }
}

/// `1 point light, 2 sphere lights`
impl fmt::Display for LightCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let present = self.by_name().into_iter().filter(|(count, _)| *count > 0);
        let words = present.map(|(count, name)| {
            format!("{count} {name} light{}", if count == 1 { "" } else { "s" })
        });
        f.write_str(&words.collect::<Vec<_>>().join(", "))
    }
}

/// Two lines: what the medium needs, and what the photons cost.
impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (medium, needs) = match self.medium {
            MediumKind::Homogeneous => ("homogeneous", "no grid, no majorants, no emission"),
            MediumKind::Grid => ("density grid", "majorants, no emission"),
        };
        let phase = if self.isotropic { "isotropic" } else { "anisotropic" };
        let color = if self.chromatic { ", chromatic" } else { "" };
        writeln!(f, "{medium}, {phase}{color}, {}: {needs}", self.lights)?;
        write!(
            f,
            "{} photons a pass ({}), k = {} (divisor {}); about {} stored, {} MB",
            self.photons,
            self.emission,
            self.k,
            self.divisor,
            self.expected_stored,
            self.photon_memory_bytes.div_ceil(1_000_000),
        )
    }
}
