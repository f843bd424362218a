//! The passes of a render: independent, averaged, and as many as the limits ask for.

use std::num::NonZeroUsize;
use std::time::Instant;

use crate::emission::Emission;
use crate::film::Film;
use crate::light::Shadows;
use crate::math::Stream;
use crate::medium::Extinction;
use crate::reference::PathTracer;
use crate::render::error_estimate::ErrorProbes;
use crate::render::film_pass::{FilmPass, PassFilm};
use crate::render::lit_lattice::ReadFrom;
use crate::render::regression::Filtered;
use crate::render::scattered_light::{BouncedReader, LatticeReader, ScatteredLight};
use crate::render::{
    ErrorEstimate, Gather, LitMedium, Observer, Reader, RenderError, RenderOptions, RenderReport,
    Rendering, Stage, lit_lattice,
};
use crate::scene::Scene;

/// Photons a pixel and pass, where the image is made to a limit: what makes noise of photons and of rays about equal.
const PHOTONS_A_PIXEL: f64 = 2.0;

/// The same where paths end in what the photons leave, which says little of the noise.
const PHOTONS_A_PIXEL_OF_PATHS: f64 = 0.25;

/// The fewest and the most photons of such a pass.
const PHOTONS_A_PASS: [u64; 2] = [1 << 12, 1 << 20];

/// Points a ray of such a pass, of single and of multiple scattering each: the next pass looks between them.
const POINTS_A_RAY: usize = 4;

/// Paths a ray of such a pass, which cost many times what a point does.
const PATHS_A_RAY: usize = 2;

/// What the estimated bias is off by, as a share of the estimated noise.
const BIAS_NOISE: f64 = 0.1;

/// The fewest photons of an estimate that k shrinks to: below, its noise is that of outliers.
const FEWEST_OF_K: usize = 8;

/// Columns of shadows a pixel: beyond, its rays look fewer times towards the light than columns are made.
const COLUMNS_A_PIXEL: usize = 4;

/// Passes from which the error is believed in.
const FEWEST_FOR_ERROR: u32 = 4;

/// Radius of the filter that is tried first \[pixels\].
const FIRST_RADIUS: usize = 2;

/// Share of the passes done after which the error is measured again at the latest: that of the filter takes time.
const MOST_TO_MEASURE: f64 = 0.3;

/// The share of the error asked for that may be bias.
const BIAS_SHARE: f64 = 0.6;

/// A render under way.
pub struct Passes<'a, E> {
    scene: &'a Scene,
    extinction: &'a E,
    options: &'a RenderOptions,
    observer: &'a dyn Observer,
    started: Instant,
    strategy: Strategy<'a>,
    /// Made by the first pass that wants them.
    shadows: Option<Shadows>,
    samples_per_pixel: usize,
    /// Points a ray, of single and of multiple scattering.
    most_samples: [usize; 2],
    /// Passes begun, with those that a finer lattice replaced.
    begun: u32,
    film: Film,
    probes: ErrorProbes,
    /// Of the image that the filter makes, once it is tried.
    filtered: Option<Filtered>,
    /// Passes at which the error is next measured.
    next_measure: u32,
    report: RenderReport,
}

/// Where scattered light is gathered from.
enum Strategy<'a> {
    Knn,
    Lattice {
        emission: Emission<'a>,
        resolution: usize,
        /// Collisions of paths that end in it; `None`: it is read where the camera looks.
        bounces: Option<u32>,
    },
}

impl<'a, E: Extinction> Passes<'a, E> {
    /// None yet.
    pub fn new(
        scene: &'a Scene,
        extinction: &'a E,
        options: &'a RenderOptions,
        observer: &'a dyn Observer,
    ) -> Self {
        let is_limited = options.has_limit();
        let mut samples_per_pixel = scene.render.samples_per_pixel;
        let strategy = match scene.render.gather {
            Gather::Knn => Strategy::Knn,
            Gather::Lattice | Gather::Bounce => {
                let photons = photons_per_pass(scene, options);
                let mut total = photons.saturating_mul(u64::from(options.passes));
                if is_limited {
                    samples_per_pixel = 1;
                    total = expected_photons(options.target_error);
                }
                let emission = lit_lattice::emission(scene, extinction, photons);
                let resolution = scene.render.lattice;
                let resolution = resolution.unwrap_or_else(|| lit_lattice::resolution::<E>(total));
                let bounces = scene.render.bounces;
                let bounces = (scene.render.gather == Gather::Bounce).then_some(bounces);
                Strategy::Lattice { emission, resolution, bounces }
            }
        };
        Self {
            scene,
            extinction,
            options,
            observer,
            started: Instant::now(),
            strategy,
            shadows: None,
            samples_per_pixel,
            most_samples: match (is_limited, scene.render.gather) {
                (true, Gather::Bounce) => [POINTS_A_RAY, PATHS_A_RAY],
                (true, _) => [POINTS_A_RAY; 2],
                (false, _) => [usize::MAX; 2],
            },
            begun: 0,
            film: Film::new(scene.camera.width, scene.camera.height),
            probes: ErrorProbes::new(scene.camera.width, scene.camera.height),
            filtered: None,
            next_measure: 2,
            report: RenderReport::default(),
        }
    }

    /// Renders passes until a limit is reached or the observer asks to stop: at least one.
    pub fn run(mut self) -> Result<Rendering, RenderError> {
        loop {
            self.add_pass()?;
            let (done, cancelled) = (self.report.passes_done, self.observer.cancelled());
            let is_last = cancelled || self.is_out_of_passes();
            if done >= self.next_measure || is_last {
                self.measure();
                self.next_measure = done + self.passes_to_measure();
            }
            self.observer.pass_finished(done, self.report.error);
            if is_last || self.is_on_target() {
                return Ok(self.finish());
            }
            self.refine();
        }
    }

    /// Measures the error of the image, filtered where that is less.
    fn measure(&mut self) {
        let Some(error) = self.probes.error() else { return };
        self.report.error = Some(error);
        if !self.filters() {
            return;
        }
        let Some(halves) = self.probes.halves() else { return };
        let unfiltered = ErrorEstimate { bias: 0.0, ..error };
        let radius = self.filtered.as_ref().map_or(FIRST_RADIUS, |filtered| filtered.radius);
        let filtered = halves.filtered(unfiltered, radius, self.probes.mean());
        let ErrorEstimate { noise, bias } = filtered.error;
        self.report.error = Some(ErrorEstimate { noise, bias: bias.hypot(error.bias) });
        self.filtered = Some(filtered);
    }

    /// Passes until the error is worth measuring again: those that bring its noise down to what is asked for, were nothing else to change, but
    /// not many more than there are.
    fn passes_to_measure(&self) -> u32 {
        let done = f64::from(self.report.passes_done);
        let enough = |target: f64| {
            let ErrorEstimate { noise, bias } = self.report.error?;
            let noise_left = (target * target - bias * bias).max(0.0);
            Some(done * noise * noise / noise_left)
        };
        let all = self.options.target_error.and_then(enough).unwrap_or(f64::INFINITY);
        let most = (MOST_TO_MEASURE * done).ceil();
        (0.9 * all - done).clamp(1.0, most.max(1.0)) as u32
    }

    /// Whether the filter is asked for, and has something to go by.
    fn filters(&self) -> bool {
        let render = &self.scene.render;
        let is_noisy = self.options.has_limit() || render.gather == Gather::Bounce;
        let asked = render.filter.unwrap_or(is_noisy);
        asked && !self.scene.render.photons_only && self.probes.mean() > 0.0
    }

    /// The image, filtered if the filter pays.
    fn finish(mut self) -> Rendering {
        let unfiltered = self.probes.error().map_or(0.0, |error| error.noise);
        if let Some(filtered) = self.filtered.filter(|filtered| filtered.radius > 0) {
            // Pixel by pixel the filter's noise is not known: on the whole it is that much less.
            let ratio = (filtered.error.noise / unfiltered).powi(2).min(1.0);
            for (pixel, multiple) in self.film.pixels.iter_mut().zip(filtered.multiple) {
                pixel.multiple_scatter = multiple;
                pixel.variance *= ratio;
            }
            self.report.filter_radius = filtered.radius;
        }
        Rendering { film: self.film, report: self.report }
    }

    fn add_pass(&mut self) -> Result<(), RenderError> {
        let Self { scene, extinction, observer, report, .. } = self;
        let seed = pass_seed(scene.photons.seed, self.begun);
        let half = self.begun % 2;
        let film_pass = FilmPass {
            scene,
            seed,
            half,
            samples_per_pixel: self.samples_per_pixel,
            first_sample: u64::from(self.begun / 2) * self.samples_per_pixel as u64,
        };
        let made = match &mut self.strategy {
            Strategy::Knn => {
                let mut lit = LitMedium::prepare(scene, *extinction, seed, *observer, report)?;
                if self.options.has_limit() {
                    lit = lit.with_k(shrunk_k(scene.estimate.k, self.begun));
                }
                gather(&film_pass, || lit.reader(), *observer, report)
            }
            Strategy::Lattice { emission, resolution, bounces } => {
                emission.reseed(seed);
                // Beyond the photons that it was chosen for cells go on shrinking.
                let emitted = emission.count().saturating_mul(u64::from(self.begun) + 1);
                let grown = match self.options.has_limit() && scene.render.lattice.is_none() {
                    true => lit_lattice::resolution::<E>(emitted),
                    false => 0,
                };
                let from = if bounces.is_some() { ReadFrom::Anywhere } else { ReadFrom::Camera };
                let resolution = grown.max(*resolution);
                let lattice = &lit_lattice::trace(
                    scene,
                    *extinction,
                    emission,
                    (resolution, from),
                    *observer,
                    report,
                )?;
                let shadows: &Shadows = self.shadows.get_or_insert_with(|| {
                    let most = COLUMNS_A_PIXEL * scene.camera.width * scene.camera.height;
                    Shadows::of(&scene.lights, &scene.medium, *extinction, most)
                });
                let (most_samples, phase) = (self.most_samples, scene.medium.phase);
                let lattice = || LatticeReader { lattice, phase };
                match *bounces {
                    None => {
                        let reader = || {
                            Reader::new(scene, *extinction, lattice())
                                .with_shadows(shadows)
                                .with_most_samples(most_samples)
                        };
                        gather(&film_pass, reader, *observer, report)
                    }
                    Some(bounces) => {
                        let reader = || {
                            let paths = PathTracer::new(scene, *extinction).with_shadows(shadows);
                            let lattice = lattice();
                            let bounced = BouncedReader { lattice, paths, bounces, seed };
                            Reader::new(scene, *extinction, bounced)
                                .with_shadows(shadows)
                                .with_most_samples(most_samples)
                        };
                        gather(&film_pass, reader, *observer, report)
                    }
                }
            }
        };
        self.begun += 1;
        self.film.average_in(&made.film, report.passes_done);
        self.probes.add(half as usize, &made.film, &made.coarse_differences);
        report.passes_done += 1;
        Ok(())
    }

    /// Whether the image is as good as it is asked to be.
    fn is_on_target(&self) -> bool {
        let (Some(target), Some(error)) = (self.options.target_error, self.report.error) else {
            return false;
        };
        self.report.passes_done >= FEWEST_FOR_ERROR && error.total() <= target
    }

    /// Whether there is no pass or no time left.
    fn is_out_of_passes(&self) -> bool {
        // A pass that would end too late is not begun.
        let seconds = self.started.elapsed().as_secs_f64();
        let next = seconds * f64::from(self.begun + 1) / f64::from(self.begun);
        self.report.passes_done >= self.options.passes
            || self.options.seconds.is_some_and(|budget| next > budget)
    }

    /// Begins anew with a finer lattice, where the first passes show that bias alone would miss the target.
    fn refine(&mut self) {
        let (Some(target), Some(error)) = (self.options.target_error, self.probes.error()) else {
            return;
        };
        let Strategy::Lattice { resolution, .. } = &mut self.strategy else { return };
        // What the estimate of the bias may be off by itself counts as noise.
        let too_much = (error.bias - BIAS_NOISE * error.noise) / (BIAS_SHARE * target);
        let can = *resolution < lit_lattice::MAX_RESOLUTION && self.scene.render.lattice.is_none();
        if self.report.passes_done < FEWEST_FOR_ERROR || too_much <= 1.0 || !can {
            return;
        }
        let finer = *resolution as f64 * (1.2 * too_much.sqrt()).clamp(1.2, 4.0);
        *resolution = (finer as usize).min(lit_lattice::MAX_RESOLUTION);
        self.film = Film::new(self.film.width, self.film.height);
        self.probes = ErrorProbes::new(self.film.width, self.film.height);
        self.filtered = None;
        self.next_measure = FEWEST_FOR_ERROR;
        self.report.passes_done = 0;
    }
}

/// Photons that a pass emits: those of the scene, or, where it leaves that open and either a limit ends the render or paths are bounced, what
/// suits the size of the image.
pub fn photons_per_pass(scene: &Scene, options: &RenderOptions) -> u64 {
    let is_small = match scene.render.gather {
        Gather::Knn => false,
        Gather::Lattice => options.has_limit(),
        Gather::Bounce => true,
    };
    if is_small && !scene.is_photon_count_given {
        let [fewest, most] = PHOTONS_A_PASS;
        let pixels = (scene.camera.width * scene.camera.height) as f64;
        let photons = match scene.render.gather {
            Gather::Bounce => PHOTONS_A_PIXEL_OF_PATHS * pixels,
            _ => PHOTONS_A_PIXEL * pixels,
        };
        return (photons as u64).clamp(fewest, most);
    }
    scene.photons.count
}

/// Photons that an image of that error takes in smoke or fog, to the order of magnitude.
fn expected_photons(target_error: Option<f64>) -> u64 {
    let target = target_error.unwrap_or(0.02);
    (1.5e5 * (0.05 / target).powi(2)).min(1e12) as u64
}

/// The photons of an estimate in a pass of many: with k falling as the pass to the power of -3/7 the noise of the mean falls as
/// fast as its bias, the mean square of both as the number of passes to the power of -4/7, as it does for one pass of as many photons.
fn shrunk_k(k: usize, pass: u32) -> NonZeroUsize {
    let shrunk = k as f64 * (f64::from(pass) + 1.0).powf(-3.0 / 7.0);
    let fewest = k.min(FEWEST_OF_K);
    NonZeroUsize::new((shrunk.round() as usize).max(fewest)).unwrap_or(NonZeroUsize::MIN)
}

/// Gathers a pass, timed and observed.
fn gather<'a, E: Extinction + 'a, S: ScatteredLight>(
    pass: &FilmPass<'a>,
    reader: impl Fn() -> Reader<'a, E, S> + Sync,
    observer: &dyn Observer,
    report: &mut RenderReport,
) -> PassFilm {
    let started = Instant::now();
    let camera = &pass.scene.camera;
    observer.stage_started(Stage::Gather, (camera.width * camera.height) as u64);
    let made = pass.render(reader, observer);
    observer.stage_finished(Stage::Gather);
    report.seconds.gather += started.elapsed().as_secs_f64();
    made
}

/// The seed of a pass: the scene's own for the first, so that one pass is the render without passes.
fn pass_seed(seed: u64, pass: u32) -> u64 {
    if pass == 0 { seed } else { Stream::Scramble.hash(seed, u64::from(pass)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn k_shrinks_with_passes_but_not_below_what_is_asked_for() {
        assert_eq!(shrunk_k(50, 0).get(), 50);
        // 128^(-3/7) = 1/8.
        assert_eq!(shrunk_k(200, 127).get(), 25);
        assert_eq!(shrunk_k(50, 1_000_000).get(), 8);
        assert_eq!(shrunk_k(3, 1_000_000).get(), 3);
    }
}
