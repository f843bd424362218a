//! A medium with its photon map.

use std::num::NonZeroUsize;
use std::time::Instant;

use crate::emission::{Emission, EmissionKind, EmissionSettings};
use crate::estimate::{Divisor, EstimateOptions, Estimator, Kernel};
use crate::light::LightChoice;
use crate::map::{Columns, PhotonMap};
use crate::math::square_maps::square_to_sphere;
use crate::math::{Ball, DVec2, Ray, Rgb, mean_channel};
use crate::medium::{Bounds, Extinction};
use crate::render::calibration::Calibrator;
use crate::render::{Observer, Reader, RenderError, RenderReport, Stage, memory};
use crate::scene::Scene;
use crate::trace::{MapFrame, TraceSettings, trace_photons};

/// Most photons that one pass may store: they take 15 GB while the map is built.
const MAX_STORED: usize = 1 << 27;

/// What a stored photon takes while the map is built \[bytes\].
const BYTES_A_PHOTON: u64 = 112;

/// The largest radius of a query, as a share of the medium's, where the scene does not say.
const MAX_RADIUS_SHARE: f64 = 0.25;

/// A medium with its photon map, shared by all threads; [`LitMedium::reader`] gives each its own way in.
#[derive(Debug)]
pub struct LitMedium<'a, E> {
    scene: &'a Scene,
    extinction: &'a E,
    map: PhotonMap,
    k: NonZeroUsize,
    /// What k photons count as.
    constant: f64,
}

impl<'a, E: Extinction> LitMedium<'a, E> {
    /// Emits and traces the photons of one pass and builds their map. Adds to `report`.
    ///
    /// # Errors
    /// More photons than memory allows.
    pub fn prepare(
        scene: &'a Scene,
        extinction: &'a E,
        seed: u64,
        observer: &dyn Observer,
        report: &mut RenderReport,
    ) -> Result<Self, RenderError> {
        Self::prepare_for(LightChoice::All, scene, extinction, seed, observer, report)
    }

    /// The same of some light alone.
    pub(super) fn prepare_for(
        choice: LightChoice,
        scene: &'a Scene,
        extinction: &'a E,
        seed: u64,
        observer: &dyn Observer,
        report: &mut RenderReport,
    ) -> Result<Self, RenderError> {
        let medium = &scene.medium;
        let started = Instant::now();
        let (kind, count) = (scene.photons.emission, scene.photons.count);
        let settings = EmissionSettings { kind, count, photons_per_ray: 1, seed };
        let mut emission = scene_emission(scene, extinction, settings);
        emission.choose(choice);
        let limit = most_stored();
        let settings = TraceSettings { max_stored: limit, ..trace_settings(scene) };
        let lit_from = scene.lights.iter().find_map(|light| light.position());
        let frame = MapFrame::of(medium, lit_from);
        observer.stage_started(Stage::Trace, emission.chosen_count());
        let traced = trace_photons(&emission, medium, extinction, frame, settings, |steps| {
            observer.advanced(steps);
        });
        observer.stage_finished(Stage::Trace);
        report.seconds.trace += started.elapsed().as_secs_f64();
        if traced.overflow {
            let emitted = scene.photons.count;
            return Err(RenderError::TooManyPhotons { emitted, limit });
        }

        let started = Instant::now();
        observer.stage_started(Stage::Build, traced.photons.len() as u64);
        let columns = Columns {
            direction: !medium.is_isotropic(),
            sigma_t: !E::IS_UNIFORM,
            order: scene.render.photons_only,
        };
        let map = PhotonMap::build(&traced.photons, frame, columns)?;
        observer.advanced(traced.photons.len() as u64);
        observer.stage_finished(Stage::Build);
        report.seconds.build += started.elapsed().as_secs_f64();
        report.emitted_count += traced.emitted_count;
        report.stored_count += map.len() as u64;
        report.bytes_per_photon = map.bytes_per_photon();
        report.power.average_in(&traced.balance, report.passes_done);
        let k = photons_of_estimate(scene);
        let constant = match scene.estimate.divisor.constant(k) {
            Some(constant) => constant,
            None => calibrated_constant(scene, extinction, settings, &map, emission, report),
        };
        Ok(Self { scene, extinction, map, k, constant })
    }

    /// The same, read from fewer photons than the scene asks for; a calibrated divisor is of its own k, which stays.
    pub fn with_k(mut self, k: NonZeroUsize) -> Self {
        if let Some(constant) = self.scene.estimate.divisor.constant(k) {
            (self.k, self.constant) = (k, constant);
        }
        self
    }

    /// A reader for one thread.
    pub fn reader(&self) -> Reader<'_, E, Estimator<'_, E>> {
        map_reader(self.scene, self.extinction, &self.map, self.k, self.constant)
    }

    /// The photon map, and what k photons of it count as.
    pub(super) fn into_map(self) -> (PhotonMap, f64) {
        (self.map, self.constant)
    }

    /// The photon map.
    pub fn map(&self) -> &PhotonMap {
        &self.map
    }
}

/// A reader of a photon map of the scene, whose estimates are of k photons that count as `constant`.
pub(super) fn map_reader<'a, E: Extinction>(
    scene: &'a Scene,
    extinction: &'a E,
    map: &'a PhotonMap,
    k: NonZeroUsize,
    constant: f64,
) -> Reader<'a, E, Estimator<'a, E>> {
    let options = EstimateOptions {
        k,
        constant,
        kernel: scene.estimate.kernel,
        max_radius: max_radius(scene, map.frame()),
    };
    Reader::new(scene, extinction, Estimator::new(&scene.medium, extinction, map, options))
}

/// The photons of one pass.
pub(super) fn scene_emission<'a, E: Extinction>(
    scene: &'a Scene,
    extinction: &E,
    settings: EmissionSettings,
) -> Emission<'a> {
    let medium = &scene.medium;
    let opacity = |ray: &Ray| {
        let span = medium.bounds.intersect(ray);
        span.map_or(0.0, |span| extinction.opacity(ray, span, Rgb::ONE))
    };
    let mean_free_path = mean_free_path(extinction, &medium.bounds);
    Emission::with_settings(&scene.lights, medium, opacity, mean_free_path, settings)
}

/// Most photons that there is room for.
fn most_stored() -> usize {
    memory::free_bytes().map_or(MAX_STORED, |free| MAX_STORED.min((free / BYTES_A_PHOTON) as usize))
}

/// What is kept of their paths.
pub(super) fn trace_settings(scene: &Scene) -> TraceSettings {
    TraceSettings {
        max_order: scene.photons.max_order,
        min_stored_order: u32::from(!scene.render.photons_only),
        max_stored: MAX_STORED,
    }
}

pub(super) fn photons_of_estimate(scene: &Scene) -> NonZeroUsize {
    NonZeroUsize::new(scene.estimate.k).unwrap_or(NonZeroUsize::MIN)
}

/// Largest radius of a query \[m\].
fn max_radius(scene: &Scene, frame: MapFrame) -> f64 {
    scene.estimate.max_radius.unwrap_or(MAX_RADIUS_SHARE * frame.unit)
}

/// What k photons of the map count as, measured once a render, as one pass is like another.
fn calibrated_constant<E: Extinction>(
    scene: &Scene,
    extinction: &E,
    settings: TraceSettings,
    map: &PhotonMap,
    own_emission: Emission,
    report: &mut RenderReport,
) -> f64 {
    if let Some(calibration) = report.calibration {
        return calibration.constant;
    }
    let k = photons_of_estimate(scene);
    if scene.estimate.kernel == Kernel::Epanechnikov {
        // The k-th photon has no weight: there is nothing to leave out.
        return Divisor::KMinus1.constant(k).unwrap_or(1.0);
    }
    let started = Instant::now();
    let seed = scene.photons.seed;
    let count = scene.photons.count;
    let kind = EmissionKind::Stratified;
    let stratified = EmissionSettings { kind, count, photons_per_ray: 1, seed };
    let emission = match scene.photons.emission {
        EmissionKind::Sobol => scene_emission(scene, extinction, stratified),
        EmissionKind::Random | EmissionKind::Stratified => own_emission,
    };
    let medium = &scene.medium;
    let max_radius = max_radius(scene, map.frame());
    let calibrator =
        Calibrator { emission: &emission, medium, extinction, settings, map, k, max_radius };
    let calibration = calibrator.calibrate(seed);
    report.seconds.calibrate += started.elapsed().as_secs_f64();
    report.calibration = Some(calibration);
    calibration.constant
}

/// A typical mean free path \[m\]: the inverse of the mean sigma_t along rays through the middle. It shapes strata
/// and nothing else.
fn mean_free_path<E: Extinction>(extinction: &E, bounds: &Bounds) -> f64 {
    let middle = bounds.enclosing_ball().unwrap_or(Ball { center: glam::DVec3::ZERO, radius: 1.0 });
    let (mut depth, mut length) = (0.0, 0.0);
    for i in 0..16 {
        let u = DVec2::new((f64::from(i % 4) + 0.5) / 4.0, (f64::from(i / 4) + 0.5) / 4.0);
        let ray = Ray::new(middle.center, square_to_sphere(u));
        if let Some(mut span) = bounds.intersect(&ray) {
            span.end = span.end.min(span.start + 2.0 * middle.radius);
            depth += mean_channel(extinction.optical_depth(&ray, span));
            length += span.length();
        }
    }
    if depth > 0.0 { length / depth } else { 1e3 * middle.radius }
}
