//! A scene's photon map for a host renderer: built once, read from many threads.

use crate::estimate::{Estimate, Estimator};
use crate::map::PhotonMap;
use crate::math::{DVec3, Random, Ray, Rgb};
use crate::medium::{
    ChromaticExtinction, Extinction, GridExtinction, MediumExtinction, UniformExtinction, Volumes,
};
use crate::render::{LitMedium, Observer, RayRadiance, Reader, RenderError, RenderReport};
use crate::scene::Scene;

/// A scene with its photon map, whatever its medium. Shared by all threads; each takes a reader of its own.
#[derive(Debug)]
pub struct LitScene<'a> {
    lit: Lit<'a>,
    report: RenderReport,
}

#[derive(Debug)]
enum Lit<'a> {
    Uniform(LitMedium<'a, UniformExtinction>),
    Chromatic(LitMedium<'a, ChromaticExtinction>),
    Grid(LitMedium<'a, GridExtinction>),
    Several(LitMedium<'a, Volumes>),
}

/// Reads a lit scene, from one thread.
pub trait LightReader {
    /// Light that travels back along a ray from up to `max_distance` \[m\] ahead, and the transmittance of that
    /// segment.
    fn radiance(&mut self, ray: &Ray, max_distance: f64, random: &mut Random) -> RayRadiance;

    /// Transmittance alone of a segment, as a host's shadow rays ask for it.
    fn transmittance(&self, ray: &Ray, max_distance: f64) -> Rgb;

    /// Fluence at a place \[W/m^2\], of the photons in the map: scattered light, unless the scene asks for
    /// everything from photons.
    fn fluence(&mut self, place: DVec3) -> Estimate;

    /// Power density at a place \[W/m^3\], of the photons in the map.
    fn power_density(&mut self, place: DVec3) -> Estimate;
}

impl<'a> LitScene<'a> {
    /// Emits and traces the scene's photons and builds their map.
    ///
    /// # Errors
    /// More photons than memory allows.
    pub fn prepare(scene: &'a Scene, observer: &dyn Observer) -> Result<Self, RenderError> {
        let mut report = RenderReport::default();
        let seed = scene.photons.seed;
        let lit = match &scene.medium.extinction {
            MediumExtinction::Uniform(uniform) => {
                Lit::Uniform(LitMedium::prepare(scene, uniform, seed, observer, &mut report)?)
            }
            MediumExtinction::Chromatic(chromatic) => {
                Lit::Chromatic(LitMedium::prepare(scene, chromatic, seed, observer, &mut report)?)
            }
            MediumExtinction::Grid(grid) => {
                Lit::Grid(LitMedium::prepare(scene, &**grid, seed, observer, &mut report)?)
            }
            MediumExtinction::Several(volumes) => {
                Lit::Several(LitMedium::prepare(scene, &**volumes, seed, observer, &mut report)?)
            }
        };
        Ok(Self { lit, report })
    }

    /// A reader for one thread.
    pub fn reader(&self) -> Box<dyn LightReader + '_> {
        match &self.lit {
            Lit::Uniform(lit) => Box::new(lit.reader()),
            Lit::Chromatic(lit) => Box::new(lit.reader()),
            Lit::Grid(lit) => Box::new(lit.reader()),
            Lit::Several(lit) => Box::new(lit.reader()),
        }
    }

    /// The photon map, what k photons of it count as, and how it was made.
    pub(super) fn into_map(self) -> (PhotonMap, f64, RenderReport) {
        let (map, constant) = match self.lit {
            Lit::Uniform(lit) => lit.into_map(),
            Lit::Chromatic(lit) => lit.into_map(),
            Lit::Grid(lit) => lit.into_map(),
            Lit::Several(lit) => lit.into_map(),
        };
        (map, constant, self.report)
    }

    /// The photon map.
    pub fn map(&self) -> &PhotonMap {
        match &self.lit {
            Lit::Uniform(lit) => lit.map(),
            Lit::Chromatic(lit) => lit.map(),
            Lit::Grid(lit) => lit.map(),
            Lit::Several(lit) => lit.map(),
        }
    }

    /// How the map was made: photons, powers, seconds.
    pub fn report(&self) -> &RenderReport {
        &self.report
    }
}

impl<'a, E: Extinction> LightReader for Reader<'a, E, Estimator<'a, E>> {
    fn radiance(&mut self, ray: &Ray, max_distance: f64, random: &mut Random) -> RayRadiance {
        self.light_along(ray, max_distance, random)
    }

    fn transmittance(&self, ray: &Ray, max_distance: f64) -> Rgb {
        self.transmittance_along(ray, max_distance)
    }

    fn fluence(&mut self, place: DVec3) -> Estimate {
        self.estimator().fluence(place)
    }

    fn power_density(&mut self, place: DVec3) -> Estimate {
        self.estimator().power_density(place)
    }
}
