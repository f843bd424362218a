//! The photon maps of one way of emission, traced as for a render.
//!
//! All photons are traced, and those kept that a query can reach: the shell about r = 1 where the queries lie. The map
//! of a shell answers queries in it as the map of all photons would.

use std::ops::Range;

use super::analytic::AnalyticScene;
use crate::emission::{Emission, EmissionKind};
use crate::lab::error::LabError;
use crate::light::Light;
use crate::map::{Columns, PhotonMap};
use crate::math::{Ray, Rgb};
use crate::medium::{Extinction, Medium};
use crate::trace::{MapFrame, Photon, TraceSettings, trace_photons};

/// How far powers of photons may differ from each other: rounding to single precision.
const EQUAL_POWER: f32 = 1e-6;

/// Scatterings followed: with an albedo of 0.9 the chance of one more is 10^-45.
const MAX_ORDER: u32 = 1000;

/// What photon maps are made of.
pub(super) struct PhotonMaps {
    scene: AnalyticScene,
    medium: Medium,
    lights: [Light; 1],
    kind: EmissionKind,
    count: u64,
    /// Distances from the light at which photons are kept \[m\].
    kept: Range<f64>,
}

impl PhotonMaps {
    pub(super) fn new(
        scene: AnalyticScene,
        kind: EmissionKind,
        count: u64,
        kept: Range<f64>,
    ) -> Self {
        Self { scene, medium: scene.medium(), lights: [scene.light()], kind, count, kept }
    }

    /// The map of a seed.
    ///
    /// # Errors
    /// The map cannot be built, or its photons are not equally strong, so that counting them would not do.
    pub(super) fn map(&self, seed: u64) -> Result<PhotonMap, LabError> {
        let extinction = self.scene.extinction();
        let medium = &self.medium;
        let opacity = |ray: &Ray| {
            let span = medium.bounds.intersect(ray);
            span.map_or(0.0, |span| extinction.opacity(ray, span, Rgb::ONE))
        };
        let free_path = 1.0 / extinction.sigma_t;
        let emission =
            Emission::new(&self.lights, medium, opacity, free_path, self.kind, self.count, seed);
        let settings =
            TraceSettings { max_order: MAX_ORDER, min_stored_order: 0, max_stored: usize::MAX };
        let frame = MapFrame::of(medium, self.lights[0].position());
        let traced = trace_photons(&emission, medium, &extinction, frame, settings, |_| ());
        let mut photons = traced.photons;
        let power = 1.0 / self.count as f64;
        photons.retain(|photon| self.kept.contains(&frame.to_world(photon.position).length()));
        if let Some(photon) = photons.iter().find(|photon| !has_power(photon, power as f32)) {
            let share = f64::from(photon.power[0]) / power;
            return Err(LabError::UnequalPowers { share });
        }
        PhotonMap::build(&photons, frame, Columns::default())
            .map_err(|error| LabError::Map(error.to_string()))
    }
}

fn has_power(photon: &Photon, power: f32) -> bool {
    photon.power.iter().all(|&channel| (channel / power - 1.0).abs() <= EQUAL_POWER)
}
