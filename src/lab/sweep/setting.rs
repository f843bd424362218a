//! One way of making an image: its settings, and the image.

use super::error::SweepError;
use crate::emission::EmissionKind;
use crate::estimate::Divisor;
use crate::film::Film;
use crate::reference::{Limits, Unwatched, render_reference};
use crate::render::{Gather, RenderOptions, Unobserved, render};
use crate::scene::{RenderSettings, Scene};

/// Most passes to a target: one that cannot be reached must end, too.
const MOST_PASSES: u32 = 1 << 12;

/// One way of making an image. What it does not say is as in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SweepSetting {
    /// One pass, gathered from the k nearest photons.
    Knn {
        /// Photons emitted.
        photons: u64,
        /// How they are sampled.
        emission: EmissionKind,
        /// Photons of one estimate.
        k: usize,
        /// Numerator of the estimate.
        divisor: Divisor,
        /// Rays a pixel.
        rays: usize,
    },
    /// One pass, gathered from a lattice.
    Lattice {
        /// Photons emitted.
        photons: u64,
        /// How they are sampled.
        emission: EmissionKind,
        /// Cells along its longest side; `None`: by the number of photons.
        cells: Option<usize>,
        /// Rays a pixel.
        rays: usize,
    },
    /// Passes until the estimated error is reached; photons, cells, rays and where light is gathered from are the plan's.
    Target {
        /// Relative error to reach.
        error: f64,
        /// How photons are sampled.
        emission: EmissionKind,
    },
    /// The reference path tracer.
    Paths {
        /// Paths a pixel, at least 2.
        paths: u64,
    },
}

/// An image, and how far from the truth it takes itself to be.
pub(super) struct Made {
    pub(super) film: Film,
    /// Relative error as the image itself estimates it; `None` where it cannot.
    pub(super) estimated_error: Option<f64>,
}

impl SweepSetting {
    /// The word for its mode: `knn`, `lattice`, `target` or `paths`.
    pub fn mode(&self) -> &'static str {
        match self {
            Self::Knn { .. } => "knn",
            Self::Lattice { .. } => "lattice",
            Self::Target { .. } => "target",
            Self::Paths { .. } => "paths",
        }
    }

    /// Makes the image; `planned` is how the scene itself would be rendered. The scene's settings are left as they were used.
    pub(super) fn make(
        &self,
        scene: &mut Scene,
        planned: RenderSettings,
        seed: u64,
    ) -> Result<Made, SweepError> {
        scene.photons.seed = seed;
        let mut options = RenderOptions::passes(1);
        match *self {
            Self::Knn { photons, emission, k, divisor, rays } => {
                use_photons(scene, photons, emission, rays);
                scene.render.gather = Gather::Knn;
                (scene.estimate.k, scene.estimate.divisor) = (k, divisor);
            }
            Self::Lattice { photons, emission, cells, rays } => {
                use_photons(scene, photons, emission, rays);
                (scene.render.gather, scene.render.lattice) = (Gather::Lattice, cells);
            }
            Self::Target { error, emission } => {
                scene.photons.emission = emission;
                scene.is_photon_count_given = false;
                scene.render = planned;
                options.passes = MOST_PASSES;
                options.target_error = Some(error);
            }
            Self::Paths { paths } => return trace_paths(scene, paths),
        }
        let rendering = render(scene, &options, &Unobserved)?;
        let estimated_error = rendering.report.error.map(|error| error.total());
        Ok(Made { film: rendering.film, estimated_error })
    }
}

fn use_photons(scene: &mut Scene, photons: u64, emission: EmissionKind, rays: usize) {
    (scene.photons.count, scene.is_photon_count_given) = (photons, true);
    scene.photons.emission = emission;
    scene.render.samples_per_pixel = rays;
}

fn trace_paths(scene: &Scene, paths: u64) -> Result<Made, SweepError> {
    let limits = Limits { samples: Some(paths), ..Limits::default() };
    let reference = render_reference(scene, &limits, &Unwatched)?;
    let estimated_error = Some(reference.progress.relative_error);
    Ok(Made { film: reference.film, estimated_error })
}
