//! One segment of a path, and with what densities the ways of sampling find a place on it.
//!
//! A place at distance t is found by the free flight of the path, with density q(t); by equi-angular sampling towards a light, e(t); and, where the
//! segment starts at a collision and the light is a point inside the medium, by equi-angular sampling on a ray aimed at it. Over the density of the
//! segment's direction by the phase function these are q, e and e a / f, with a and f the densities of the direction by aim and by phase function. The
//! balance heuristic (Veach and Guibas 1995) weighs each by its share of their sum.
//!
//! Weights may use any positive function of the path as long as all ways use the same: in grids, where transmittance is only
//! estimated, q is taken to be sigma_t. That leaves every contribution bounded by the best way's.

use crate::light::Light;
use crate::math::{DVec3, Ray, Rgb, Span, exp};
use crate::medium::{Extinction, Medium};

use super::aim::Aim;
use super::equi_angular::EquiAngular;

/// A ray from the camera or from a collision, and its part in the medium.
pub(super) struct Segment<'a, E> {
    pub(super) medium: &'a Medium,
    pub(super) extinction: &'a E,
    pub(super) ray: Ray,
    pub(super) span: Span,
    /// Throughput of the path \[1\] per channel: free flights favour the strong channels.
    pub(super) throughput: Rgb,
    /// Density of the ray's direction by the phase function \[1/sr\]; `None` if it comes from the camera.
    pub(super) phase_density: Option<f64>,
}

impl<E: Extinction> Segment<'_, E> {
    /// Density q of the path's own collisions, as weights see it \[1/m\].
    pub(super) fn flight_density(&self, distance: f64, sigma_t: Rgb) -> f64 {
        if !E::IS_UNIFORM {
            return sigma_t.max_element();
        }
        self.shares().dot(sigma_t * self.transmittance(distance))
    }

    /// What a flight known to have passed `distance` is worth per channel: the channel's transmittance over the flight's
    /// probability. 1 where all channels share one sigma_t.
    pub(super) fn flight_weight(&self, distance: f64) -> Rgb {
        if !E::IS_UNIFORM {
            return Rgb::ONE;
        }
        let transmittance = self.transmittance(distance);
        let probability = self.shares().dot(transmittance);
        if probability > 0.0 { transmittance / probability } else { Rgb::ZERO }
    }

    /// Sampling of distances towards a light that is near; `None` for others, and where it does not reach.
    pub(super) fn equi_angular(&self, light: &Light) -> Option<EquiAngular> {
        let center = light.center()?;
        let span = light.lit_span(&self.ray, self.span)?;
        Some(EquiAngular::new(&self.ray, span, center))
    }

    /// Density of all ways that find a place where the flight has density `flight` \[1/m\].
    pub(super) fn density(
        &self,
        light: &Light,
        towards: Option<&EquiAngular>,
        distance: f64,
        flight: f64,
    ) -> f64 {
        let near = towards.map_or(0.0, |towards| towards.pdf_distance(distance));
        if near > 0.0 { flight + near * (1.0 + self.aim_over_phase(light)) } else { flight }
    }

    /// Density of the ray's direction by aim at a light over that by the phase function.
    fn aim_over_phase(&self, light: &Light) -> f64 {
        let Some(phase_density) = self.phase_density else { return 0.0 };
        let aim = peak_of(light, self.medium).and_then(|peak| Aim::new(self.ray.origin, peak));
        aim.map_or(0.0, |aim| aim.pdf_direction(self.ray.direction) / phase_density)
    }

    /// From the span's start, in a uniform medium.
    fn transmittance(&self, distance: f64) -> Rgb {
        let passed = Span::new(self.span.start, distance);
        exp(-self.extinction.optical_depth(&self.ray, passed))
    }

    fn shares(&self) -> Rgb {
        self.throughput / self.throughput.element_sum()
    }
}

/// Where a light shines without bound inside the medium.
pub(super) fn peak_of(light: &Light, medium: &Medium) -> Option<DVec3> {
    light.position().filter(|position| medium.bounds.contains(*position))
}
