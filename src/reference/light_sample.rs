//! One direction towards a light, and the density with which it was drawn.

use crate::light::{Environment, Illumination, Light};
use crate::math::{DVec2, DVec3, Random, Rgb, uniform};

/// Light that arrives at a place from one direction, before the medium attenuates it.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightSample {
    /// Where it comes from; its irradiance is radiance / density.
    pub(super) from: Illumination,
    /// Density of the direction \[1/sr\]; `None` for lights without extent, which no ray can hit.
    pub(super) pdf: Option<f64>,
}

/// Draws a direction towards a light; `None` where it does not shine.
pub(super) fn sample_light(
    light: &Light,
    place: DVec3,
    random: &mut Random,
) -> Option<LightSample> {
    let mut square = || DVec2::new(uniform(random), uniform(random));
    match light {
        Light::Point(_) | Light::Spot(_) | Light::Directional(_) => {
            let from = light.sample_illumination(place, DVec2::ZERO)?;
            Some(LightSample { from, pdf: None })
        }
        Light::Quad(quad) => extended(quad.sample_illumination(place, square())?, quad.radiance),
        Light::Sphere(sphere) => {
            extended(sphere.sample_illumination(place, square())?, sphere.radiance)
        }
        Light::Environment(environment) => sample_environment(environment, square()),
    }
}

/// Density with which [`sample_light`] draws a direction in which the light is seen \[1/sr\]; 0 if it cannot.
pub(super) fn pdf_light(light: &Light, place: DVec3, direction: DVec3) -> f64 {
    let middle = DVec2::splat(0.5);
    let sample = match light {
        Light::Point(_) | Light::Spot(_) | Light::Directional(_) => None,
        Light::Environment(environment) => return environment.pdf_direction(direction),
        Light::Quad(quad) => {
            quad.sample_illumination(place, middle).and_then(|from| extended(from, quad.radiance))
        }
        Light::Sphere(sphere) => sphere
            .sample_illumination(place, middle)
            .and_then(|from| extended(from, sphere.radiance)),
    };
    sample.and_then(|sample| sample.pdf).unwrap_or(0.0)
}

/// Directions are uniform in the solid angle that the light fills, which is its irradiance over its radiance.
fn extended(from: Illumination, radiance: Rgb) -> Option<LightSample> {
    let solid_angle = from.irradiance.max_element() / radiance.max_element();
    (solid_angle > 0.0).then_some(LightSample { from, pdf: Some(1.0 / solid_angle) })
}

fn sample_environment(environment: &Environment, u: DVec2) -> Option<LightSample> {
    let drawn = environment.sample_direction(u);
    let irradiance = environment.radiance(drawn.direction) / drawn.pdf;
    let from = Illumination { direction: drawn.direction, distance: f64::INFINITY, irradiance };
    (drawn.pdf > 0.0).then_some(LightSample { from, pdf: Some(drawn.pdf) })
}
