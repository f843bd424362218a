//! Rendering: passes of tracing, building and gathering, averaged on a film.
//!
//! [`LitMedium`] is a medium with its photon map, ready to be read along any ray: the film is made of such
//! readings. A host renderer builds a [`LitScene`] and asks for its own.

mod calibration;
mod distances;
mod emitted_light;
mod film_pass;
mod lit_medium;
mod lit_scene;
mod observer;
mod photon_query;
mod pixel_peak;
mod reader;
mod report;
mod shadow;
mod single_scatter;

pub use calibration::Calibration;
pub use lit_medium::LitMedium;
pub use lit_scene::{LightReader, LitScene};
pub use observer::{Observer, Stage, Unobserved};
pub use reader::{RayRadiance, Reader};
pub use report::{RenderReport, StageSeconds};

use std::time::Instant;

use crate::film::{Film, Pixel};
use crate::map::MapError;
use crate::math::Stream;
use crate::medium::{Bounds, Extinction, MediumExtinction};
use crate::scene::Scene;

/// How a scene is rendered.
#[derive(Clone, Copy, Debug)]
pub struct RenderOptions {
    /// Independent passes, at least 1; the film is their mean.
    pub passes: u32,
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
    /// More photons than memory allows.
    #[error(
        "a pass of {emitted} photons stores more than {limit}; use fewer photons a pass and more --passes"
    )]
    TooManyPhotons {
        /// Photons emitted per pass.
        emitted: u64,
        /// Most that are stored.
        limit: usize,
    },
    /// The photon map could not be built.
    #[error(transparent)]
    Map(#[from] MapError),
}

/// Renders all passes, or those until the observer asks to stop: at least one.
///
/// # Errors
/// An infinite medium, or more photons than memory allows.
pub fn render(
    scene: &Scene,
    options: &RenderOptions,
    observer: &dyn Observer,
) -> Result<Rendering, RenderError> {
    if matches!(scene.medium.bounds, Bounds::Infinite) {
        return Err(RenderError::InfiniteMedium);
    }
    match &scene.medium.extinction {
        MediumExtinction::Uniform(uniform) => render_passes(scene, uniform, options, observer),
        MediumExtinction::Chromatic(chromatic) => {
            render_passes(scene, chromatic, options, observer)
        }
        MediumExtinction::Grid(grid) => render_passes(scene, &**grid, options, observer),
    }
}

fn render_passes<E: Extinction>(
    scene: &Scene,
    extinction: &E,
    options: &RenderOptions,
    observer: &dyn Observer,
) -> Result<Rendering, RenderError> {
    let mut film = Film::new(scene.camera.width, scene.camera.height);
    let mut report = RenderReport::default();
    for pass in 0..options.passes.max(1) {
        let seed = pass_seed(scene.photons.seed, pass);
        let lit = LitMedium::prepare(scene, extinction, seed, observer, &mut report)?;
        let started = Instant::now();
        observer.stage_started(Stage::Gather, film.pixels.len() as u64);
        film_pass::add_pass(&mut film, scene, &lit, seed, observer);
        observer.stage_finished(Stage::Gather);
        report.seconds.gather += started.elapsed().as_secs_f64();
        report.passes_done += 1;
        if observer.cancelled() {
            break;
        }
    }
    let share = 1.0 / f64::from(report.passes_done);
    film.pixels.iter_mut().for_each(|pixel| *pixel = scaled(pixel, share));
    Ok(Rendering { film, report })
}

/// The seed of a pass: the scene's own for the first, so that one pass is the render without passes.
fn pass_seed(seed: u64, pass: u32) -> u64 {
    if pass == 0 { seed } else { Stream::Scramble.hash(seed, u64::from(pass)) }
}

fn scaled(pixel: &Pixel, factor: f64) -> Pixel {
    Pixel {
        single_scatter: pixel.single_scatter * factor,
        multiple_scatter: pixel.multiple_scatter * factor,
        emission: pixel.emission * factor,
        transmittance: pixel.transmittance * factor,
        photon_count: pixel.photon_count * factor,
        kernel_radius: pixel.kernel_radius * factor,
        ..*pixel
    }
}
