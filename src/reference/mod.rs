//! The reference: an unbiased path tracer for the scenes of the photon mapper.
//!
//! It has scenes, media and lights in common with the photon mapper and none of its estimators: no photons, no map, no stored
//! paths. A pixel is the mean of independent paths from the camera (see [`PathLight`] for the layers), each of any length; with the mean
//! comes its variance. What is not noise in the difference of a render and its reference is bias.
//!
//! Sample s of pixel p draws from a stream that depends on (seed, s, p) alone, and a pixel adds up its samples in
//! order: the image is the same for any number of threads, and for any division into passes.

mod aim;
mod equi_angular;
mod glow;
mod light_sample;
mod limits;
mod path;
mod pixel_places;
mod running_pixel;
mod segment;

pub use limits::{Limits, Progress};
pub use path::PathLight;

use std::ops::Range;
use std::time::Instant;

use rayon::prelude::*;

use crate::film::Film;
use crate::math::{DVec2, Random, Ray, Stream, mean_channel};
use crate::medium::{Bounds, Extinction, MediumExtinction};
use crate::scene::Scene;
pub(crate) use path::PathTracer;
use pixel_places::PixelPlaces;
use running_pixel::add_sample;
use segment::peak_of;

/// Pixels that one task renders.
const SHARE: usize = 32;

/// An image with its noise.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Means over all samples, with `variance` and `sample_count`.
    pub film: Film,
    /// How it ended.
    pub progress: Progress,
    /// Mean of all pixels and channels \[W/(m^2 sr)\].
    pub mean: f64,
}

/// Watches a reference in the making. Calls come from the thread that asked for it.
pub trait PassObserver {
    /// A pass is done: every pixel has as many samples as `progress` says.
    fn pass_done(&self, progress: &Progress);

    /// Whether to end after the pass in flight.
    fn cancelled(&self) -> bool;
}

/// Watches nothing and never stops.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl PassObserver for Unwatched {
    fn pass_done(&self, _: &Progress) {}

    fn cancelled(&self) -> bool {
        false
    }
}

/// Why there is no reference of a scene.
#[derive(Debug, thiserror::Error)]
pub enum ReferenceError {
    /// Light is neither absorbed nor leaves.
    #[error(
        "medium.albedo: paths in an infinite medium that absorbs nothing have no end; lower the albedo below 1 or give the medium bounds"
    )]
    Endless,
}

/// Renders the image of a scene, seeded by its `photons.seed`, until a limit is reached or the observer asks to stop.
///
/// # Errors
/// [`ReferenceError::Endless`].
pub fn render_reference(
    scene: &Scene,
    limits: &Limits,
    observer: &dyn PassObserver,
) -> Result<Reference, ReferenceError> {
    check_paths_end(scene)?;
    let mut film = Film::new(scene.camera.width, scene.camera.height);
    let started = Instant::now();
    let mut samples = 0;
    let progress = loop {
        let next = samples + limits.next_pass(samples);
        match &scene.medium.extinction {
            MediumExtinction::Uniform(uniform) => {
                add_pass(&mut film, scene, uniform, samples..next)
            }
            MediumExtinction::Chromatic(chromatic) => {
                add_pass(&mut film, scene, chromatic, samples..next)
            }
            MediumExtinction::Grid(grid) => add_pass(&mut film, scene, &**grid, samples..next),
            MediumExtinction::Several(volumes) => {
                add_pass(&mut film, scene, &**volumes, samples..next)
            }
        }
        samples = next;
        let (seconds, relative_error) = (started.elapsed().as_secs_f64(), relative_error(&film));
        let share_done = limits.share_done(samples, seconds, relative_error);
        let progress = Progress { samples, seconds, relative_error, share_done };
        observer.pass_done(&progress);
        if share_done >= 1.0 || observer.cancelled() {
            break progress;
        }
    };
    let mean = mean_radiance(&film);
    Ok(Reference { film, progress, mean })
}

/// The light that one path finds along a ray: a random number whose mean is exact.
///
/// # Errors
/// [`ReferenceError::Endless`].
pub fn path_light(
    scene: &Scene,
    ray: &Ray,
    random: &mut Random,
) -> Result<PathLight, ReferenceError> {
    check_paths_end(scene)?;
    Ok(match &scene.medium.extinction {
        MediumExtinction::Uniform(uniform) => {
            PathTracer::new(scene, uniform).light_along(*ray, random)
        }
        MediumExtinction::Chromatic(chromatic) => {
            PathTracer::new(scene, chromatic).light_along(*ray, random)
        }
        MediumExtinction::Grid(grid) => PathTracer::new(scene, &**grid).light_along(*ray, random),
        MediumExtinction::Several(volumes) => {
            PathTracer::new(scene, &**volumes).light_along(*ray, random)
        }
    })
}

/// In bounds every path leaves; without, it must be absorbed.
fn check_paths_end(scene: &Scene) -> Result<(), ReferenceError> {
    let medium = &scene.medium;
    let is_endless =
        matches!(medium.bounds, Bounds::Infinite) && medium.max_albedo().max_element() >= 1.0;
    if is_endless { Err(ReferenceError::Endless) } else { Ok(()) }
}

/// Adds samples to every pixel.
fn add_pass<E: Extinction>(film: &mut Film, scene: &Scene, extinction: &E, samples: Range<u64>) {
    let width = film.width;
    let peaks: Vec<DVec2> = scene
        .lights
        .iter()
        .filter_map(|light| scene.camera.project(peak_of(light, &scene.medium)?))
        .collect();
    film.pixels.par_chunks_mut(SHARE).enumerate().for_each(|(share, pixels)| {
        let mut tracer = PathTracer::new(scene, extinction);
        for (place, pixel) in pixels.iter_mut().enumerate() {
            let index = share * SHARE + place;
            let corner = DVec2::new((index % width) as f64, (index / width) as f64);
            let places = PixelPlaces::new(corner, &peaks);
            for sample in samples.clone() {
                let seed = Stream::Reference.hash(scene.photons.seed, sample);
                let mut random = Stream::Reference.random(seed, index as u64);
                let place = places.sample(&mut random);
                let ray = scene.camera.ray(place.position.x, place.position.y);
                let seen = tracer.light_along(ray, &mut random);
                add_sample(pixel, &seen, place.weight);
            }
        }
    });
}

fn mean_radiance(film: &Film) -> f64 {
    let sum: f64 = film.pixels.iter().map(|pixel| mean_channel(pixel.radiance())).sum();
    sum / film.pixels.len().max(1) as f64
}

/// Root of the mean variance over the mean.
fn relative_error(film: &Film) -> f64 {
    let sum: f64 = film.pixels.iter().map(|pixel| mean_channel(pixel.variance)).sum();
    let error = (sum / film.pixels.len().max(1) as f64).sqrt();
    if error > 0.0 { error / mean_radiance(film) } else { 0.0 }
}
