//! Light that reaches a place unscattered.

use crate::light::{Environment, Illumination, Light, transmittance_to};
use crate::math::{DVec2, DVec3, Rgb, Stream, uniform};
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
                self.arriving(place, light.sample_illumination(place, DVec2::ZERO))
            }
            Light::Quad(_) | Light::Sphere(_) => self.mean(number, voxel, |u| {
                self.arriving(voxel.middle, light.sample_illumination(voxel.middle, u))
            }),
            Light::Environment(environment) => self.mean(number, voxel, |u| {
                self.arriving(voxel.middle, Some(from_environment(environment, u)))
            }),
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

    /// What is left of light on its way to a place.
    fn arriving(&self, place: DVec3, light: Option<Illumination>) -> Rgb {
        light.map_or(Rgb::ZERO, |Illumination { direction, distance, irradiance }| {
            let medium = &self.scene.medium;
            irradiance * transmittance_to(medium, self.extinction, place, direction, distance)
        })
    }

    /// The mean over a lattice of the unit square, shifted by chance from voxel to voxel.
    fn mean(&self, light: usize, voxel: Voxel, of: impl Fn(DVec2) -> Rgb) -> Rgb {
        let seed = Stream::Bake.hash(self.scene.photons.seed, light as u64);
        let mut random = Stream::Bake.random(seed, voxel.number);
        let shift = DVec2::new(uniform(&mut random), uniform(&mut random));
        let count = self.samples as f64;
        let point = |sample: usize| {
            let step = sample as f64;
            let across = (shift.y + step * GOLDEN_STEP).fract();
            of(DVec2::new((step + shift.x) / count, across))
        };
        (0..self.samples).map(point).sum::<Rgb>() / count
    }
}

/// Light from a direction drawn by what arrives from it.
fn from_environment(environment: &Environment, u: DVec2) -> Illumination {
    let sample = environment.sample_direction(u);
    let irradiance = environment.radiance(sample.direction) / sample.pdf;
    Illumination { direction: sample.direction, distance: f64::INFINITY, irradiance }
}
