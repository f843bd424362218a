//! Single scattering: light that scattered once on its way to the camera, computed without photons.
//!
//! Along a ray, L = integral of T(t) sigma_s(t) p(cos) E(t) T_light(t) dt per light, with E the light's irradiance.
//! Distances come from the ray's transmittance and, for lights that are near, half of them from equi-angular sampling, combined
//! by the balance heuristic (Veach and Guibas 1995): the inverse-square peak is sampled away, and optically thick
//! media are not left to it.

use crate::light::{Environment, Illumination, Light, Shadows, transmittance_to};
use crate::math::{DVec2, DVec3, Random, Ray, Rgb, Span, exp, uniform};
use crate::medium::{Extinction, Medium, RayProfile, Scattering};
use crate::render::distances::{ByTransmittance, EquiAngular, even_quantile, mirrored_quantile};

/// Opacity up to which a uniform medium's transmittance counts as smooth: an optical depth of 4.
const SMOOTH_OPACITY: f64 = 0.98;

/// Mean cosine beyond which a phase function is narrow.
const PEAKED_COSINE: f64 = 0.5;

/// One ray of which the single scattering is asked.
pub struct ScatteringRay<'a, E> {
    /// The medium.
    pub medium: &'a Medium,
    /// Its extinction.
    pub extinction: &'a E,
    /// What is known of shadows in it.
    pub shadows: Option<&'a Shadows>,
    /// The ray.
    pub ray: &'a Ray,
    /// Its part inside the medium.
    pub span: Span,
    /// Its optical depth.
    pub profile: &'a RayProfile,
}

impl<E: Extinction> ScatteringRay<'_, E> {
    /// Radiance of one light, the scene's number `index`, scattered once, from `samples` distances: one in each stratum, at `phase` of it.
    pub fn single_scatter(
        &self,
        (index, light): (usize, &Light),
        samples: usize,
        phase: f64,
        random: &mut Random,
    ) -> Rgb {
        let Some(span) = light.lit_span(self.ray, self.span) else { return Rgb::ZERO };
        let Some(by_transmittance) = ByTransmittance::new(self.profile, span) else {
            return Rgb::ZERO;
        };
        match (light, light.center()) {
            (_, Some(center)) => {
                let equi_angular = EquiAngular::new(self.ray, span, center);
                self.by_both(
                    (index, light),
                    &equi_angular,
                    &by_transmittance,
                    samples,
                    phase,
                    random,
                )
            }
            (Light::Environment(environment), _) => {
                self.strata(&by_transmittance, samples, phase, random, |place, random| {
                    self.environment_light(environment, place, random)
                })
            }
            _ => self.strata(&by_transmittance, samples, phase, random, |place, random| {
                self.light_towards_camera((index, light), place, random)
            }),
        }
    }

    /// Distances by transmittance alone, one a stratum.
    fn strata(
        &self,
        by_transmittance: &ByTransmittance,
        samples: usize,
        phase: f64,
        random: &mut Random,
        mut scattered: impl FnMut(DVec3, &mut Random) -> Rgb,
    ) -> Rgb {
        let count = samples as f64;
        let mut sum = Rgb::ZERO;
        for stratum in 0..samples {
            let u = mirrored_quantile(stratum, phase, samples);
            let distance = by_transmittance.sample_distance(u, uniform(random));
            let place = self.ray.at(distance);
            let sigma_t = if E::IS_UNIFORM { self.extinction.sigma_t(place) } else { Rgb::ONE };
            let weight = by_transmittance.scattering_weight(distance, sigma_t, count);
            let albedo = self.extinction.albedo_at(self.medium, place);
            sum += weight * scattered(place, random) * albedo;
        }
        sum
    }

    /// Distances by both densities.
    fn by_both(
        &self,
        light: (usize, &Light),
        equi_angular: &EquiAngular,
        by_transmittance: &ByTransmittance,
        samples: usize,
        phase: f64,
        random: &mut Random,
    ) -> Rgb {
        // Seen from the light, what is left of the integrand in thin even media is smooth: strata of the angle do best alone.
        let even = E::IS_UNIFORM && by_transmittance.opacity() <= SMOOTH_OPACITY;
        let far = if even { 0 } else { samples / 2 };
        let near_light = samples - far;
        // A cone or a narrow phase function makes a peak between ends that are alike.
        let is_peaked = matches!(light.1, Light::Spot(_))
            || self.medium.phase.mean_cosine().abs() > PEAKED_COSINE;
        let quantile = if is_peaked { even_quantile } else { mirrored_quantile };
        let mut sum = Rgb::ZERO;
        for sample in 0..samples {
            let distance = if sample < near_light {
                let u = quantile(sample, phase, near_light);
                equi_angular.sample_distance(u)
            } else {
                let u = quantile(sample - near_light, phase, far);
                by_transmittance.sample_distance(u, uniform(random))
            };
            let place = self.ray.at(distance);
            let sigma_t = self.extinction.sigma_t(place);
            let transmittance = exp(-self.profile.optical_depth(distance));
            let density = near_light as f64 * equi_angular.pdf_distance(distance)
                + far as f64 * by_transmittance.pdf_distance(transmittance, sigma_t);
            if density > 0.0 && sigma_t != Rgb::ZERO {
                let light = self.light_towards_camera(light, place, random);
                let albedo = self.extinction.albedo_at(self.medium, place);
                sum += transmittance * sigma_t * light * albedo / density;
            }
        }
        sum
    }

    /// Phase-weighted light from one sampled direction of a light, attenuated on its way.
    fn light_towards_camera(
        &self,
        (index, light): (usize, &Light),
        place: DVec3,
        random: &mut Random,
    ) -> Rgb {
        let u = match light {
            Light::Quad(_) | Light::Sphere(_) => DVec2::new(uniform(random), uniform(random)),
            _ => DVec2::ZERO,
        };
        let Some(sample) = light.sample_illumination(place, u) else { return Rgb::ZERO };
        // Travel: from the light (-direction) to the camera (-ray.direction).
        let cosine = sample.direction.dot(self.ray.direction);
        let scattering = self.extinction.scattering_at(self.medium, place);
        let known = self.shadows.and_then(|shadows| shadows.transmittance(index, place));
        let arriving = known.unwrap_or_else(|| {
            let Illumination { direction, distance, .. } = sample;
            transmittance_to(self.medium, self.extinction, place, direction, distance)
        });
        scattering.scatter(sample.irradiance * arriving, 1.0, cosine)
    }

    /// The same of an environment: a constant one by the phase function, an image by the phase function or its
    /// radiance in turn, combined by the balance heuristic.
    fn environment_light(
        &self,
        environment: &Environment,
        place: DVec3,
        random: &mut Random,
    ) -> Rgb {
        let scattering = self.extinction.scattering_at(self.medium, place);
        let by_image = matches!(environment, Environment::Image(_)) && uniform(random) < 0.5;
        let towards = if by_image {
            environment.sample_direction(DVec2::new(uniform(random), uniform(random))).direction
        } else {
            // The path is reversible: scatter the camera's ray to find where light comes from.
            scattering.sample_direction(self.ray.direction, random)
        };
        let cosine = towards.dot(self.ray.direction);
        let density = scattering.pdf(cosine);
        let pdf = match environment {
            Environment::Constant(_) => density,
            Environment::Image(_) => 0.5 * (density + environment.pdf_direction(towards)),
        };
        // The direction is random already: an estimate costs a fraction of the exact walk.
        let out = Ray::new(place, towards);
        let inside = self.medium.bounds.intersect(&out);
        let arriving = inside
            .map_or(Rgb::ONE, |span| self.extinction.estimate_transmittance(&out, span, random));
        scattering.scatter(environment.radiance(towards) * arriving, 1.0 / pdf, cosine)
    }
}
