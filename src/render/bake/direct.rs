//! Light that reaches a place unscattered.

use crate::light::{Environment, Illumination, Light, transmittance_to};
use crate::math::{DVec2, DVec3, Random, Ray, Rgb, Span, Stream, uniform};
use crate::medium::Extinction;
use crate::render::bake::voxels::Voxel;
use crate::scene::Scene;

/// Step of the second coordinate of a lattice of directions: the golden ratio's.
const GOLDEN_STEP: f64 = 0.618_033_988_749_894_8;

/// Unscattered light at voxels: exact at the middle for lights without extent, the mean over directions in strata for others.
pub struct DirectLight<'a, E> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its extinction.
    pub extinction: &'a E,
    /// Directions towards a light that has extent: at least 1.
    pub samples: usize,
    /// How near a place may come to a point light \[m\]. With r / sqrt(3) it is lit there as the mean over a ball of radius r
    /// about the light, 3 / r^2: the light in its own voxel stays finite, and its sum over voxels right.
    pub near: f64,
}

impl<E: Extinction> DirectLight<'_, E> {
    /// Fluence of all lights \[W/m^2\]; none where all light is taken from photons.
    pub fn fluence(&self, voxel: Voxel) -> Rgb {
        if self.scene.render.photons_only {
            return Rgb::ZERO;
        }
        let lights = self.scene.lights.iter().enumerate();
        lights.map(|(number, light)| self.of_light(number, light, voxel)).sum()
    }

    fn of_light(&self, number: usize, light: &Light, voxel: Voxel) -> Rgb {
        match light {
            Light::Point(_) | Light::Spot(_) | Light::Directional(_) => {
                let place = self.at_distance(light, voxel.middle);
                let arriving = light.sample_illumination(place, DVec2::ZERO);
                arriving.map_or(Rgb::ZERO, |Illumination { direction, distance, irradiance }| {
                    let (medium, extinction) = (&self.scene.medium, self.extinction);
                    irradiance * transmittance_to(medium, extinction, place, direction, distance)
                })
            }
            Light::Quad(_) | Light::Sphere(_) => {
                self.mean(number, voxel, |u| light.sample_illumination(voxel.middle, u))
            }
            Light::Environment(environment) => {
                self.mean(number, voxel, |u| Some(from_environment(environment, u)))
            }
        }
    }

    /// A place, moved away from a light that it is too near to.
    fn at_distance(&self, light: &Light, place: DVec3) -> DVec3 {
        let Some(position) = light.position() else { return place };
        let away = place - position;
        if away.length_squared() >= self.near * self.near {
            return place;
        }
        let ahead = if let Light::Spot(spot) = light { spot.axis } else { DVec3::X };
        position + away.try_normalize().unwrap_or(ahead) * self.near
    }

    /// What is left of light on its way to a place, by an estimate: its direction is random already.
    fn arriving(&self, place: DVec3, light: Illumination, random: &mut Random) -> Rgb {
        let Illumination { direction, distance, irradiance } = light;
        let ray = Ray::new(place, direction);
        let inside = self.scene.medium.bounds.intersect(&ray);
        let way = inside.and_then(|span| span.intersect(Span::new(0.0, distance)));
        irradiance
            * way.map_or(Rgb::ONE, |way| self.extinction.estimate_transmittance(&ray, way, random))
    }

    /// The mean over a lattice of the unit square, shifted by chance from voxel to voxel.
    fn mean(
        &self,
        light: usize,
        voxel: Voxel,
        towards: impl Fn(DVec2) -> Option<Illumination>,
    ) -> Rgb {
        let seed = Stream::Bake.hash(self.scene.photons.seed, light as u64);
        let mut random = Stream::Bake.random(seed, voxel.number);
        let shift = DVec2::new(uniform(&mut random), uniform(&mut random));
        let count = self.samples as f64;
        let mut sum = Rgb::ZERO;
        for sample in 0..self.samples {
            let step = sample as f64;
            let across = (shift.y + step * GOLDEN_STEP).fract();
            if let Some(light) = towards(DVec2::new((step + shift.x) / count, across)) {
                sum += self.arriving(voxel.middle, light, &mut random);
            }
        }
        sum / count
    }
}

/// Light from a direction drawn by what arrives from it.
fn from_environment(environment: &Environment, u: DVec2) -> Illumination {
    let sample = environment.sample_direction(u);
    let irradiance = environment.radiance(sample.direction) / sample.pdf;
    Illumination { direction: sample.direction, distance: f64::INFINITY, irradiance }
}
