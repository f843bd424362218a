//! The plan of a render: what this scene needs of the program, and nothing more.

use std::fmt;

use serde::Serialize;

use super::Scene;
use super::expected_collisions::expected_collisions;
use super::file::emission_word;
use super::grid_use::{GridRole, GridUse};
use super::light_counts::LightCounts;
use crate::math::Rgb;
use crate::medium::MediumExtinction;
use crate::render::Gather;

/// What a scene needs; printed before a render and part of its report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// Kind of extinction.
    pub medium: MediumKind,
    /// Whether scattered light goes all ways alike.
    pub isotropic: bool,
    /// Mean cosine of the angle by which it is scattered.
    pub mean_cosine: f64,
    /// Whether sigma_t or the albedo differs between the channels.
    pub chromatic: bool,
    /// The grids used, in the order in which they were read.
    pub grids: Vec<GridUse>,
    /// Lights of each kind.
    pub lights: LightCounts,
    /// Whether free flights are sampled against majorants (delta tracking) rather than in closed form.
    pub majorants: bool,
    /// Photons emitted per pass.
    pub photons: u64,
    /// How they are sampled, as scene files spell it.
    pub emission: &'static str,
    /// How light scattered twice or more is gathered from them.
    pub gather: Gather,
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

/// A photon and its place in the tree \[bytes\].
const PHOTON_BYTES: u64 = 110;

impl Plan {
    /// The plan of a scene.
    pub fn of(scene: &Scene) -> Self {
        let medium = &scene.medium;
        let is_grid = matches!(medium.extinction, MediumExtinction::Grid(_));
        let expected_stored = (scene.photons.count as f64 * expected_collisions(scene)) as u64;
        Self {
            medium: if is_grid { MediumKind::Grid } else { MediumKind::Homogeneous },
            isotropic: medium.phase.is_isotropic(),
            mean_cosine: medium.phase.mean_cosine(),
            chromatic: matches!(medium.extinction, MediumExtinction::Chromatic(_))
                || medium.albedo != Rgb::splat(medium.albedo.x)
                || medium.color.is_some(),
            grids: scene.grids.clone(),
            lights: LightCounts::of(&scene.lights),
            majorants: is_grid,
            photons: scene.photons.count,
            emission: emission_word(scene.photons.emission),
            gather: scene.render.gather,
            k: scene.estimate.k,
            divisor: scene.estimate.divisor.name(),
            expected_stored,
            photon_memory_bytes: expected_stored.saturating_mul(PHOTON_BYTES),
        }
    }
}

/// What the medium needs, a line for each grid, and what the photons cost.
impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let glows = |grid: &GridUse| matches!(grid.role, GridRole::Temperature | GridRole::Flame);
        let (medium, needs) = match self.medium {
            MediumKind::Homogeneous => ("homogeneous", "no grid, no majorants, no emission"),
            MediumKind::Grid if self.grids.iter().any(glows) => {
                ("density grid", "majorants, emission")
            }
            MediumKind::Grid => ("density grid", "majorants, no emission"),
        };
        let phase = match self.isotropic {
            true => "isotropic".into(),
            false => format!("anisotropic (mean cosine {:.2})", self.mean_cosine),
        };
        let color = if self.chromatic { ", chromatic" } else { "" };
        let lights = self.lights.to_string();
        let lights = if lights.is_empty() { "no light but its own" } else { &lights };
        writeln!(f, "{medium}, {phase}{color}, {lights}: {needs}")?;
        for grid in &self.grids {
            let megabytes = grid.memory_bytes.div_ceil(1_000_000);
            writeln!(f, "{} from grid {:?}, {megabytes} MB", grid.role.name(), grid.name)?;
        }
        write!(f, "{} photons a pass ({}), ", self.photons, self.emission)?;
        match self.gather {
            Gather::Lattice => write!(f, "their flights gathered in a lattice"),
            Gather::Knn => write!(
                f,
                "k = {} (divisor {}); about {} stored, {} MB",
                self.k,
                self.divisor,
                self.expected_stored,
                self.photon_memory_bytes.div_ceil(1_000_000),
            ),
        }
    }
}
