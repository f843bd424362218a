//! Rendering: passes of tracing, building and gathering, averaged on a film.
//!
//! [`LitMedium`] is a medium with its photon map, ready to be read along any ray: the film is made of such
//! readings. A host renderer builds a [`LitScene`] and asks for its own.

mod bake;
mod calibration;
mod checkpoint;
mod distances;
mod emitted_light;
mod error_estimate;
mod film_pass;
mod light_groups;
mod lit_lattice;
mod lit_medium;
mod lit_scene;
mod memory;
mod observer;
mod owned_lit_scene;
mod passes;
mod photon_query;
mod pixel_peak;
mod pixel_samples;
mod ray_depths;
mod reader;
mod regression;
mod render_state;
mod report;
mod scattered_light;
mod single_scatter;
mod used_settings;

pub use bake::{BakeOptions, BakeReport, Baked, bake, even_densities};
pub use calibration::Calibration;
pub use checkpoint::CheckpointError;
pub use error_estimate::ErrorEstimate;
pub use lit_medium::LitMedium;
pub use lit_scene::{LightReader, LitScene};
pub use observer::{Observer, Stage, Unobserved};
pub use owned_lit_scene::{NotCalibrated, OwnedLitScene};
pub use passes::photons_per_pass;
pub use reader::{RayRadiance, Reader};
pub use render_state::RenderState;
pub use report::{CalibrationFigures, PhotonCounts, RenderFigures, RenderReport, StageSeconds};
pub use scattered_light::Gather;
pub use used_settings::UsedSettings;

use std::path::Path;

use crate::film::Film;
use crate::map::MapError;
use crate::medium::{Bounds, MediumExtinction};
use crate::scene::Scene;
use lit_lattice::MAX_RESOLUTION as MAX_LATTICE;
use passes::Passes;

/// When a render ends: whichever comes first.
#[derive(Clone, Copy, Debug)]
pub struct RenderOptions {
    /// Independent passes, at least 1; the film is their mean.
    pub passes: u32,
    /// Estimated error of the image, root mean square over its mean.
    pub target_error: Option<f64>,
    /// Wall-clock time \[s\]; the first pass is always made.
    pub seconds: Option<f64>,
    /// What the film holds beside the usual layers.
    pub layers: CostlyLayers,
}

/// Layers that cost something to find.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CostlyLayers {
    /// How deep pixels look.
    pub depths: bool,
    /// The image of each light, by the name that the scene gives it: each is gathered by itself, from its own of the same photons, and
    /// the film is their sum.
    pub lights: bool,
}

impl RenderOptions {
    /// So many passes, and no other limit.
    pub fn passes(passes: u32) -> Self {
        let layers = CostlyLayers::default();
        Self { passes: passes.max(1), target_error: None, seconds: None, layers }
    }

    /// So many passes, or, where their number is left open, as many as a target error or a time \[s\] takes; without either as many
    /// as the scene's way of gathering wants.
    pub fn for_scene(
        scene: &Scene,
        passes: Option<u32>,
        target_error: Option<f64>,
        seconds: Option<f64>,
    ) -> Self {
        let is_limited = target_error.is_some() || seconds.is_some();
        let passes = passes.unwrap_or(match scene.render.gather {
            _ if is_limited => u32::MAX,
            // What the filter goes by is how passes differ.
            Gather::Bounce => 4,
            _ => 1,
        });
        Self { target_error, seconds, ..Self::passes(passes) }
    }

    /// Whether something else than the number of passes ends the render: then passes are small.
    pub fn has_limit(&self) -> bool {
        self.target_error.is_some() || self.seconds.is_some()
    }
}

/// What a render gives.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The mean of all passes.
    pub film: Film,
    /// How it was made.
    pub report: RenderReport,
}

/// Why a scene could not be rendered.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The medium has no end.
    #[error("medium.bounds: an infinite medium cannot be rendered; give it a box or a sphere")]
    InfiniteMedium,
    /// Volumes scatter differently, and cells of a lattice hold the light of one phase function.
    #[error("render.gather: volumes with different phase functions have no lattice; use \"knn\"")]
    NoLattice,
    /// More photons than memory allows.
    #[error(
        "a pass of {emitted} photons stores more than the {limit} that memory has room for; use fewer photons a pass and more --passes"
    )]
    TooManyPhotons {
        /// Photons emitted per pass.
        emitted: u64,
        /// Most that are stored.
        limit: usize,
    },
    /// An image or a lattice that memory has no room for.
    #[error("{what} takes {needed_mib} MiB of memory and {free_mib} MiB are free; {way_out}")]
    OutOfMemory {
        /// What does not fit.
        what: String,
        /// What it takes \[MiB\].
        needed_mib: u64,
        /// What is free \[MiB\].
        free_mib: u64,
        /// What to do.
        way_out: &'static str,
    },
    /// More voxels than memory allows.
    #[error(
        "the light of {voxels} voxels needs more than {limit_mib} MiB; allow more with --max-volume-memory, or take fewer --voxels"
    )]
    TooManyVoxels {
        /// Voxels of all leaves.
        voxels: u64,
        /// Memory allowed \[MiB\].
        limit_mib: u64,
    },
    /// There is no such medium.
    #[error("there is no medium {number}; the media of a scene are numbered from 0")]
    NoSuchMedium {
        /// The one asked for.
        number: usize,
    },
    /// The photon map could not be built.
    #[error(transparent)]
    Map(#[from] MapError),
}

/// Where a render begins, and where it is kept.
#[derive(Clone, Debug, Default)]
pub struct Checkpoints<'a> {
    /// The state to go on from, instead of from no pass; of the same scene and options ([`RenderState::load`]).
    pub resume_from: Option<RenderState>,
    /// The file to which the state is written after every pass.
    pub save_to: Option<&'a Path>,
}

/// Renders all passes, or those until the observer asks to stop: at least one.
///
/// # Errors
/// An infinite medium, a lattice for volumes that scatter differently, or more photons than memory allows.
pub fn render(
    scene: &Scene,
    options: &RenderOptions,
    observer: &dyn Observer,
) -> Result<Rendering, RenderError> {
    render_from(scene, options, observer, Checkpoints::default())
}

/// The same from a state that was kept, and keeping it: what is rendered in several runs is, byte for byte, what one run
/// renders that ends by the same number of passes.
///
/// # Errors
/// As [`render`]. A checkpoint that cannot be written is none: the observer is told.
pub fn render_from(
    scene: &Scene,
    options: &RenderOptions,
    observer: &dyn Observer,
    checkpoints: Checkpoints,
) -> Result<Rendering, RenderError> {
    if matches!(scene.medium.bounds, Bounds::Infinite) {
        return Err(RenderError::InfiniteMedium);
    }
    if scene.render.gather != Gather::Knn && scene.medium.shared_phase().is_none() {
        return Err(RenderError::NoLattice);
    }
    let lights = if options.layers.lights { scene.lights.len() } else { 0 };
    memory::check_image(scene.camera.width * scene.camera.height, lights)?;
    match &scene.medium.extinction {
        MediumExtinction::Uniform(uniform) => {
            Passes::new(scene, uniform, options, observer, checkpoints).run()
        }
        MediumExtinction::Chromatic(chromatic) => {
            Passes::new(scene, chromatic, options, observer, checkpoints).run()
        }
        MediumExtinction::Grid(grid) => {
            Passes::new(scene, &**grid, options, observer, checkpoints).run()
        }
        MediumExtinction::Several(volumes) => {
            Passes::new(scene, &**volumes, options, observer, checkpoints).run()
        }
    }
}
