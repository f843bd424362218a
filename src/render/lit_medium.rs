//! A medium with its photon map.

use std::num::NonZeroUsize;
use std::time::Instant;

use crate::emission::Emission;
use crate::estimate::{EstimateOptions, Estimator};
use crate::map::{Columns, PhotonMap};
use crate::math::square_maps::square_to_sphere;
use crate::math::{Ball, DVec2, Ray, Rgb, mean_channel};
use crate::medium::{Bounds, Extinction};
use crate::render::{Observer, Reader, RenderError, RenderReport, Stage};
use crate::scene::Scene;
use crate::trace::{MapFrame, TraceSettings, trace_photons};

/// Most photons that one pass may store: they take 15 GB while the map is built.
const MAX_STORED: usize = 1 << 27;

/// The largest radius of a query, as a share of the medium's, where the scene does not say.
const MAX_RADIUS_SHARE: f64 = 0.25;

/// A medium with its photon map, shared by all threads; [`LitMedium::reader`] gives each its own way in.
#[derive(Debug)]
pub struct LitMedium<'a, E> {
    scene: &'a Scene,
    extinction: &'a E,
    map: PhotonMap,
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
        let medium = &scene.medium;
        let started = Instant::now();
        let emission = scene_emission(scene, extinction, scene.photons.count, 1, seed);
        let settings = trace_settings(scene);
        let lit_from = scene.lights.iter().find_map(|light| light.position());
        let frame = MapFrame::of(medium, lit_from);
        observer.stage_started(Stage::Trace, emission.count());
        let traced = trace_photons(&emission, medium, extinction, frame, settings, |steps| {
            observer.advanced(steps);
        });
        observer.stage_finished(Stage::Trace);
        report.seconds.trace += started.elapsed().as_secs_f64();
        if traced.overflow {
            let emitted = scene.photons.count;
            return Err(RenderError::TooManyPhotons { emitted, limit: MAX_STORED });
        }

        let started = Instant::now();
        observer.stage_started(Stage::Build, traced.photons.len() as u64);
        let columns = Columns {
            direction: !medium.phase.is_isotropic(),
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
        Ok(Self { scene, extinction, map })
    }

    /// A reader for one thread.
    pub fn reader(&self) -> Reader<'_, E, Estimator<'_, E>> {
        let estimate = &self.scene.estimate;
        let unit = self.map.frame().unit;
        let options = EstimateOptions {
            k: NonZeroUsize::new(estimate.k).unwrap_or(NonZeroUsize::MIN),
            divisor: estimate.divisor,
            kernel: estimate.kernel,
            max_radius: estimate.max_radius.unwrap_or(MAX_RADIUS_SHARE * unit),
        };
        let estimator = Estimator::new(&self.scene.medium, self.extinction, &self.map, options);
        Reader::new(self.scene, self.extinction, estimator)
    }

    /// The photon map.
    pub fn map(&self) -> &PhotonMap {
        &self.map
    }
}

/// The photons of one pass.
pub(super) fn scene_emission<'a, E: Extinction>(
    scene: &'a Scene,
    extinction: &E,
    photons: u64,
    photons_per_ray: u64,
    seed: u64,
) -> Emission<'a> {
    let medium = &scene.medium;
    Emission::with_shared_rays(
        &scene.lights,
        medium,
        |ray| {
            let span = medium.bounds.intersect(ray);
            span.map_or(0.0, |span| extinction.opacity(ray, span, Rgb::ONE))
        },
        mean_free_path(extinction, &medium.bounds),
        scene.photons.emission,
        photons,
        photons_per_ray,
        seed,
    )
}

/// What is kept of their paths.
pub(super) fn trace_settings(scene: &Scene) -> TraceSettings {
    TraceSettings {
        max_order: scene.photons.max_order,
        min_stored_order: u32::from(!scene.render.photons_only),
        max_stored: MAX_STORED,
    }
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
