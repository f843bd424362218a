//! The plan of a render: what this scene needs of the program, and nothing more.

use std::fmt;

use serde::Serialize;

use super::Scene;
use super::expected_collisions::expected_collisions;
use super::file::emission_word;
use super::grid_use::{GridRole, GridUse};
use super::light_counts::LightCounts;
use crate::math::Rgb;
use crate::medium::{Medium, MediumExtinction};
use crate::render::Gather;

/// What a scene needs; printed before a render and part of its report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// Kind of extinction.
    pub medium: MediumKind,
    /// Whether scattered light goes all ways alike.
    pub isotropic: bool,
    /// Mean cosine of the angle by which it is scattered; `None` where volumes differ in that: then there is no lattice.
    pub mean_cosine: Option<f64>,
    /// Volumes that make up the medium.
    pub volumes: usize,
    /// Those of them that are density grids.
    pub grid_volumes: usize,
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
    /// The sum of several volumes.
    Several,
}

/// A photon and its place in the tree \[bytes\].
const PHOTON_BYTES: u64 = 110;

impl Plan {
    /// The plan of a scene.
    pub fn of(scene: &Scene) -> Self {
        let medium = &scene.medium;
        let volumes = match &medium.extinction {
            MediumExtinction::Several(volumes) => volumes.media(),
            _ => std::slice::from_ref(medium),
        };
        let is_grid = |volume: &&Medium| matches!(volume.extinction, MediumExtinction::Grid(_));
        let grid_volumes = volumes.iter().filter(is_grid).count();
        let is_chromatic = |volume: &Medium| {
            matches!(volume.extinction, MediumExtinction::Chromatic(_))
                || volume.albedo != Rgb::splat(volume.albedo.x)
                || volume.color.is_some()
        };
        let expected_stored = (scene.photons.count as f64 * expected_collisions(scene)) as u64;
        Self {
            medium: match (volumes.len(), grid_volumes) {
                (1, 0) => MediumKind::Homogeneous,
                (1, _) => MediumKind::Grid,
                _ => MediumKind::Several,
            },
            isotropic: medium.is_isotropic(),
            mean_cosine: medium.shared_phase().map(|phase| phase.mean_cosine()),
            volumes: volumes.len(),
            grid_volumes,
            chromatic: volumes.iter().any(is_chromatic),
            grids: scene.grids.clone(),
            lights: LightCounts::of(&scene.lights),
            majorants: grid_volumes > 0,
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
        let medium = match (self.medium, self.grid_volumes) {
            (MediumKind::Homogeneous, _) => "homogeneous".into(),
            (MediumKind::Grid, _) => "density grid".into(),
            (MediumKind::Several, grids) => {
                format!("{} volumes, {grids} from density grids", self.volumes)
            }
        };
        let needs = match (self.majorants, self.grids.iter().any(glows)) {
            (true, true) => "majorants, emission",
            (true, false) => "majorants, no emission",
            (false, true) => "emission",
            (false, false) => "no grid, no majorants, no emission",
        };
        let phase = match (self.isotropic, self.mean_cosine) {
            (true, _) => "isotropic".into(),
            (false, Some(cosine)) => format!("anisotropic (mean cosine {cosine:.2})"),
            (false, None) => "each with its own phase function".into(),
        };
        let color = if self.chromatic { ", chromatic" } else { "" };
        let lights = self.lights.to_string();
        let lights = if lights.is_empty() { "no light but its own" } else { &lights };
        writeln!(f, "{medium}, {phase}{color}, {lights}: {needs}")?;
        for grid in &self.grids {
            let megabytes = grid.memory_bytes.div_ceil(1_000_000);
            write!(f, "{} from grid {:?}", grid.role.name(), grid.name)?;
            if self.volumes > 1 {
                write!(f, " of {}, used {}", grid.file, times(grid.volumes))?;
            }
            writeln!(f, ", {megabytes} MB")?;
        }
        write!(f, "{} photons a pass ({}), ", self.photons, self.emission)?;
        match self.gather {
            Gather::Auto | Gather::Lattice => write!(f, "their flights gathered in a lattice"),
            Gather::Bounce => write!(f, "in a lattice that ends the camera's paths"),
            Gather::Knn => write!(
                f,
                "k = {} (divisor {}); about {} stored, {} MB",
                self.k,
                self.divisor,
                self.expected_stored,
                self.photon_memory_bytes.div_ceil(1_000_000),
            ),
        }?;
        match self.mean_cosine {
            Some(_) => Ok(()),
            None => write!(f, "; no lattice, as volumes differ in their phase functions"),
        }
    }
}

fn times(count: usize) -> String {
    if count == 1 { "once".into() } else { format!("{count} times") }
}
