//! The photon maps of one way of emission, traced as for a render.
//!
//! All photons are traced, and those kept that a query can reach. The map of these answers queries as the map of all
//! photons would.

use super::analytic::AnalyticScene;
use crate::emission::{Emission, EmissionKind};
use crate::lab::error::LabError;
use crate::light::Light;
use crate::map::{Columns, PhotonMap};
use crate::math::{Ray, Rgb};
use crate::medium::{Extinction, Medium};
use crate::trace::{MapFrame, TraceSettings, trace_photons};

/// Scatterings followed: with an albedo of 0.9 the chance of one more is 10^-45, and furnaces are left long before.
const MAX_ORDER: u32 = 1000;

/// What photon maps are made of.
pub(super) struct PhotonMaps {
    scene: AnalyticScene,
    medium: Medium,
    lights: [Light; 1],
    kind: EmissionKind,
    count: u64,
    /// How far queries look \[m\].
    reach: f64,
}

/// A map to ask.
pub(super) struct AskedMap {
    pub(super) photons: PhotonMap,
    /// Mean power of a photon \[W\].
    pub(super) mean_power: f64,
}

impl PhotonMaps {
    pub(super) fn new(scene: AnalyticScene, kind: EmissionKind, count: u64, reach: f64) -> Self {
        Self { scene, medium: scene.medium(), lights: [scene.light()], kind, count, reach }
    }

    /// The map of a seed.
    ///
    /// # Errors
    /// The map cannot be built.
    pub(super) fn map(&self, seed: u64) -> Result<AskedMap, LabError> {
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
        let is_kept = |position| self.scene.is_within_reach(frame.to_world(position), self.reach);
        photons.retain(|photon| is_kept(photon.position));
        let power: f64 = photons.iter().map(|photon| f64::from(photon.power[0])).sum();
        let mean_power = power / photons.len() as f64;
        let photons = PhotonMap::build(&photons, frame, Columns::default())
            .map_err(|error| LabError::Map(error.to_string()))?;
        Ok(AskedMap { photons, mean_power })
    }
}
