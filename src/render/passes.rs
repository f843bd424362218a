//! The passes of a render: independent, averaged, and as many as the limits ask for.

use std::num::NonZeroUsize;
use std::path::Path;
use std::time::Instant;

use crate::emission::Emission;
use crate::estimate::Divisor;
use crate::light::{LightChoice, Shadows};
use crate::math::Stream;
use crate::medium::Extinction;
use crate::reference::PathTracer;
use crate::render::error_estimate::fewest_passes;
use crate::render::film_pass::{FilmPass, PassFilm};
use crate::render::light_groups::{LightGroups, empty_film};
use crate::render::lit_lattice::ReadFrom;
use crate::render::scattered_light::{BouncedReader, LatticeReader, ScatteredLight};
use crate::render::{
    Calibration, Checkpoints, ErrorEstimate, Gather, LitMedium, MAX_LATTICE, Observer, Reader,
    RenderError, RenderOptions, RenderReport, RenderState, Rendering, Stage, lit_lattice,
};
use crate::scene::Scene;
use crate::trace::PowerBalance;

/// Photons a pixel and pass, where the image is made to a limit: what makes noise of photons and of rays about equal.
const PHOTONS_A_PIXEL: f64 = 2.0;

/// The same where paths end in what the photons leave, which says little of the noise.
const PHOTONS_A_PIXEL_OF_PATHS: f64 = 0.25;

/// Photons a pixel that cost little beside its ray.
const CHEAP_PHOTONS_A_PIXEL: f64 = 0.2;

/// Photons of a pass that cost nothing beside its rays.
const MIN_USEFUL_PHOTONS: f64 = 16384.0;

/// The fewest and the most photons of such a pass.
const PHOTONS_A_PASS: [u64; 2] = [1 << 12, 1 << 20];

/// Points a ray of such a pass, of single and of multiple scattering each: the next pass looks between them.
const POINTS_A_RAY: usize = 4;

/// Paths a ray, of such a pass and of any other, which cost many times what a point does.
const PATHS_A_RAY: usize = 2;

/// What the estimated bias is off by, as a share of the estimated noise.
const BIAS_NOISE: f64 = 0.1;

/// The fewest photons of an estimate that k shrinks to: below, its noise is that of outliers.
const FEWEST_OF_K: usize = 8;

/// Passes that the photons which a lattice is expected to take are divided into at least: its noise does not depend on the number of pixels.
const FEWEST_PASSES: u64 = 4;

/// Columns of shadows a pixel: beyond, its rays look fewer times towards the light than columns are made.
const COLUMNS_A_PIXEL: usize = 4;

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
    groups: LightGroups,
    state: RenderState,
    /// Passes of which this run measured the error last.
    measured_at: u32,
    /// Where the state is written after every pass.
    save_to: Option<&'a Path>,
    /// Seconds that the state had taken when this run began.
    seconds_before: f64,
}

/// Where scattered light is gathered from.
enum Strategy<'a> {
    Knn,
    Lattice {
        emission: Emission<'a>,
        /// Collisions of paths that end in it; `None`: it is read where the camera looks.
        bounces: Option<u32>,
    },
}

impl<'a, E: Extinction> Passes<'a, E> {
    /// None yet, or those of a state that was kept.
    pub fn new(
        scene: &'a Scene,
        extinction: &'a E,
        options: &'a RenderOptions,
        observer: &'a dyn Observer,
        checkpoints: Checkpoints<'a>,
    ) -> Self {
        let is_limited = options.has_limit();
        let mut samples_per_pixel = scene.render.samples_per_pixel;
        let mut resolution = 0;
        let strategy = match scene.render.gather {
            Gather::Knn => Strategy::Knn,
            Gather::Auto | Gather::Lattice | Gather::Bounce => {
                let photons = photons_per_pass(scene, options);
                let mut total = photons.saturating_mul(u64::from(options.passes));
                if is_limited {
                    samples_per_pixel = 1;
                    total = expected_photons(options.target_error);
                }
                let emission = lit_lattice::emission(scene, extinction, photons);
                let asked = scene.render.lattice;
                resolution = asked.unwrap_or_else(|| lit_lattice::resolution::<E>(total));
                let bounces = scene.render.bounces;
                let bounces = (scene.render.gather == Gather::Bounce).then_some(bounces);
                Strategy::Lattice { emission, bounces }
            }
        };
        let Checkpoints { resume_from, save_to } = checkpoints;
        let film = || empty_film(scene, options);
        let state = resume_from.unwrap_or_else(|| RenderState::new(film(), resolution));
        let groups = LightGroups::of(scene, options);
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
                (false, Gather::Bounce) => [usize::MAX, PATHS_A_RAY],
                (false, _) => [usize::MAX; 2],
            },
            groups,
            seconds_before: state.seconds,
            state,
            measured_at: 0,
            save_to,
        }
    }

    /// Renders passes until a limit is reached or the observer asks to stop: at least one, unless there are some already.
    pub fn run(mut self) -> Result<Rendering, RenderError> {
        if self.state.begun > 0 {
            self.save();
        }
        while !self.has_ended() {
            self.refine();
            self.add_pass()?;
            if self.state.report.passes_done >= self.state.next_measure {
                self.measure();
            }
            self.state.seconds = self.seconds();
            let report = &self.state.report;
            self.observer.pass_finished(report.passes_done, report.error);
            self.observer.image(&self.state.film);
            self.save();
        }
        Ok(self.finish())
    }

    /// Measures the error of the image, filtered where that is less, and says when to measure again.
    fn measure(&mut self) {
        let filters = self.filters();
        self.measured_at = self.state.report.passes_done;
        let RenderState { probes, film, report, filter_radius, .. } = &mut self.state;
        let Some(error) = probes.error() else { return };
        report.error = Some(error);
        if let Some(halves) = probes.halves(film).filter(|_| filters) {
            let unfiltered = ErrorEstimate { bias: 0.0, ..error };
            let chosen = halves.best_radius(unfiltered, *filter_radius, probes.mean());
            let ErrorEstimate { noise, bias } = chosen.error;
            report.error = Some(ErrorEstimate { noise, bias: bias.hypot(error.bias) });
            *filter_radius = chosen.radius;
        }
        self.state.next_measure = self.state.report.passes_done + self.passes_to_measure();
    }

    /// Passes until the error is worth measuring again: those that bring its noise down to what is asked for, were nothing else to change, but
    /// not many more than there are.
    fn passes_to_measure(&self) -> u32 {
        let done = f64::from(self.state.report.passes_done);
        let enough = |target: f64| {
            let ErrorEstimate { noise, bias } = self.state.report.error?;
            let noise_left = (target * target - bias * bias).max(0.0);
            Some(done * noise * noise / noise_left)
        };
        let all = self.options.target_error.and_then(enough).unwrap_or(f64::INFINITY);
        let most = (MOST_TO_MEASURE * done).ceil();
        (0.9 * all - done).clamp(1.0, most.max(1.0)) as u32
    }

    /// Whether the filter is asked for, and has something to go by. Layers of single lights are to add up to the image.
    fn filters(&self) -> bool {
        let render = &self.scene.render;
        let is_noisy = self.options.has_limit() || render.gather == Gather::Bounce;
        render.filter.unwrap_or(is_noisy)
            && !render.photons_only
            && self.groups.names.is_empty()
            && self.state.probes.mean() > 0.0
    }

    /// The image, filtered if the filter pays.
    fn finish(mut self) -> Rendering {
        // This is not kept: a render that goes on must measure when one would that never ended here.
        if self.measured_at != self.state.report.passes_done {
            self.measure();
        }
        let filters = self.filters();
        let RenderState { mut film, mut report, probes, filter_radius, .. } = self.state;
        let unfiltered = probes.error().map_or(0.0, |error| error.noise);
        let halves = probes.halves(&film).filter(|_| filters && filter_radius > 0);
        let filtered = halves.map(|halves| halves.filtered(filter_radius, probes.mean()));
        if let Some(filtered) = filtered {
            // Pixel by pixel the filter's noise is not known: on the whole it is that much less.
            let ratio = (filtered.error.noise / unfiltered).powi(2).min(1.0);
            for (pixel, multiple) in film.pixels.iter_mut().zip(filtered.multiple) {
                pixel.multiple_scatter = multiple;
                pixel.variance *= ratio;
            }
            report.filter_radius = filter_radius;
        }
        Rendering { film, report }
    }

    /// Writes the state. A disk that is full ends no render: the observer is told.
    fn save(&self) {
        let Some(path) = self.save_to else { return };
        if let Err(failure) = self.state.save(path, self.scene, self.options) {
            self.observer.checkpoint_failed(&failure);
        }
    }

    /// Wall-clock time of this run and those before \[s\].
    fn seconds(&self) -> f64 {
        self.seconds_before + self.started.elapsed().as_secs_f64()
    }

    /// Renders the next pass, in the parts that its layers ask for, and averages it in.
    fn add_pass(&mut self) -> Result<(), RenderError> {
        let mut pass: Option<PassFilm> = None;
        let mut power = PowerBalance::default();
        for (choice, layer) in self.groups.parts.clone() {
            let calibration = self.calibration()?;
            let mut part_report = RenderReport { calibration, ..RenderReport::default() };
            let part = self.gather_part(choice, &mut part_report)?;
            self.state.report.add_costs(&part_report);
            power.add(&part_report.power);
            match (&mut pass, layer) {
                (Some(pass), _) => pass.add_light(&part, layer),
                (None, None) => pass = Some(part),
                (None, Some(layer)) => pass = Some(part.into_layer(&self.groups.names, layer)),
            }
        }
        let Some(pass) = pass else { return Ok(()) };
        let RenderState { begun, film, probes, report, .. } = &mut self.state;
        report.power.average_in(&power, report.passes_done);
        film.average_in(&pass.film, report.passes_done);
        probes.add((*begun % 2) as usize, &pass.film, &pass.coarse_differences);
        *begun += 1;
        report.passes_done += 1;
        Ok(())
    }

    /// What k photons count as, where it is measured: once a render, and of all lights together, as each alone has few photons.
    fn calibration(&mut self) -> Result<Option<Calibration>, RenderError> {
        let Self { scene, extinction, observer, groups, .. } = self;
        let known = self.state.report.calibration;
        let is_measured = scene.estimate.divisor == Divisor::Calibrated;
        let is_knn = matches!(self.strategy, Strategy::Knn);
        if known.is_some() || !is_knn || !is_measured || groups.names.is_empty() {
            return Ok(known);
        }
        let mut report = RenderReport::default();
        LitMedium::prepare(scene, *extinction, scene.photons.seed, *observer, &mut report)?;
        self.state.report.add_costs(&report);
        Ok(report.calibration)
    }

    /// Traces and gathers some of the light of the next pass. Adds to `report`.
    fn gather_part(
        &mut self,
        choice: LightChoice,
        report: &mut RenderReport,
    ) -> Result<PassFilm, RenderError> {
        let Self { scene, extinction, observer, .. } = self;
        let RenderState { begun, resolution, .. } = self.state;
        let seed = pass_seed(scene.photons.seed, begun);
        let film_pass = FilmPass {
            scene,
            seed,
            half: begun % 2,
            samples_per_pixel: self.samples_per_pixel,
            first_sample: u64::from(begun / 2) * self.samples_per_pixel as u64,
            choice,
            finds_depths: self.options.layers.depths,
        };
        Ok(match &mut self.strategy {
            Strategy::Knn => {
                let mut lit =
                    LitMedium::prepare_for(choice, scene, *extinction, seed, *observer, report)?;
                if self.options.has_limit() {
                    lit = lit.with_k(shrunk_k(scene.estimate.k, begun));
                }
                gather(&film_pass, || lit.reader(), *observer, report)
            }
            Strategy::Lattice { emission, bounces } => {
                emission.reseed(seed);
                emission.choose(choice);
                // Beyond the photons that it was chosen for cells go on shrinking.
                let emitted = emission.count().saturating_mul(u64::from(begun) + 1);
                let grown = match self.options.has_limit() && scene.render.lattice.is_none() {
                    true => lit_lattice::resolution::<E>(emitted),
                    false => 0,
                };
                let from = if bounces.is_some() { ReadFrom::Anywhere } else { ReadFrom::Camera };
                let lattice = &lit_lattice::trace(
                    scene,
                    *extinction,
                    emission,
                    (grown.max(resolution), from, choice),
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
                            let paths = PathTracer::new(scene, *extinction)
                                .with_shadows(shadows)
                                .with_choice(choice);
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
        })
    }

    /// Whether a limit is reached, or the end asked for.
    fn has_ended(&self) -> bool {
        let done = self.state.report.passes_done;
        let within = |target: f64| {
            let error = self.state.report.error.map_or(f64::INFINITY, |error| error.total());
            done >= fewest_passes(self.state.film.pixels.len()) && error <= target
        };
        done > 0
            && (self.is_out_of_passes()
                || self.options.target_error.is_some_and(within)
                || self.observer.cancelled())
    }

    /// Whether there is no pass or no time left.
    fn is_out_of_passes(&self) -> bool {
        // A pass that would end too late is not begun.
        let begun = f64::from(self.state.begun);
        let is_late = |budget: f64| self.seconds() * (begun + 1.0) / begun > budget;
        self.state.report.passes_done >= self.options.passes
            || self.options.seconds.is_some_and(is_late)
    }

    /// Begins anew with a finer lattice, where the first passes show that bias alone would miss the target.
    fn refine(&mut self) {
        let state = &mut self.state;
        let fewest = fewest_passes(state.film.pixels.len());
        // That of the lattice alone.
        let (Some(target), Some(error)) = (self.options.target_error, state.probes.error()) else {
            return;
        };
        // What the estimate of the bias may be off by itself counts as noise.
        let too_much = (error.bias - BIAS_NOISE * error.noise) / (BIAS_SHARE * target);
        let can = matches!(self.strategy, Strategy::Lattice { .. })
            && state.resolution < MAX_LATTICE
            && self.scene.render.lattice.is_none();
        if state.report.passes_done < fewest || too_much <= 1.0 || !can {
            return;
        }
        let finer = state.resolution as f64 * (1.2 * too_much.sqrt()).clamp(1.2, 4.0);
        state.resolution = (finer as usize).min(MAX_LATTICE);
        state.restart_film();
        self.measured_at = 0;
    }
}

/// Photons that a pass emits: those of the scene, or, where it leaves that open and either a limit ends the render or paths are bounced, what
/// suits the size of the image.
pub fn photons_per_pass(scene: &Scene, options: &RenderOptions) -> u64 {
    let is_small = match scene.render.gather {
        Gather::Knn => false,
        Gather::Auto | Gather::Lattice => options.has_limit(),
        Gather::Bounce => true,
    };
    if is_small && !scene.is_photon_count_given {
        let [fewest, most] = PHOTONS_A_PASS;
        let pixels = (scene.camera.width * scene.camera.height) as f64;
        let photons = match scene.render.gather {
            Gather::Bounce => PHOTONS_A_PIXEL_OF_PATHS * pixels,
            _ => {
                let needed = options.target_error.map(|error| expected_photons(Some(error)));
                let most = needed.map_or(f64::INFINITY, |photons| (photons / FEWEST_PASSES) as f64);
                let cheap = MIN_USEFUL_PHOTONS.max(CHEAP_PHOTONS_A_PIXEL * pixels);
                (PHOTONS_A_PIXEL * pixels).min(most.max(cheap))
            }
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
pub(super) fn pass_seed(seed: u64, pass: u32) -> u64 {
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
