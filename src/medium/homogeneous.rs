//! Homogeneous media: analytic free flights and transmittance.
//!
//! One sigma_t for all channels needs no weights. With one a channel, a flight is drawn from the mixture
//! p(t) = sum_c q_c sigma_c exp(-sigma_c t), q_c the channel's share of the photon's power, and each
//! channel is weighted by its own density over the mixture's: the balance heuristic over channels, which is
//! unbiased and never weighs by more than 1 / q_c.

use crate::math::{DVec3, Random, Ray, Rgb, Span, exp, uniform};
use crate::medium::{
    BoostedFlight, BoostedQuantile, Extinction, Flight, Medium, Phase, RayProfile,
};

/// The same sigma_t everywhere and in every channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformExtinction {
    /// \[1/m\]
    pub sigma_t: f64,
}

impl Extinction for UniformExtinction {
    type Scattering = Phase;

    const IS_UNIFORM: bool = true;

    #[inline]
    fn sigma_t(&self, _position: DVec3) -> Rgb {
        Rgb::splat(self.sigma_t)
    }

    #[inline]
    fn scattering_at(&self, medium: &Medium, _position: DVec3) -> Phase {
        medium.phase
    }

    #[inline]
    fn optical_depth(&self, _ray: &Ray, span: Span) -> Rgb {
        Rgb::splat(uniform_depth(self.sigma_t, span.length()))
    }

    /// The same in every channel, whatever the power.
    #[inline]
    fn opacity(&self, _ray: &Ray, span: Span, _power: Rgb) -> f64 {
        -(-uniform_depth(self.sigma_t, span.length())).exp_m1()
    }

    #[inline]
    fn sample_flight(&self, ray: &Ray, span: Span, power: Rgb, random: &mut Random) -> Flight {
        self.invert_flight(ray, span, power, uniform(random))
    }

    #[inline]
    fn invert_flight(&self, _ray: &Ray, span: Span, _power: Rgb, u: f64) -> Flight {
        // sigma_t = 0 divides to infinity (or 0/0 at u = 0, which is not below the end either).
        let distance = span.start - (-u).ln_1p() / self.sigma_t;
        if distance < span.end {
            Flight::Collision { distance, weight: Rgb::ONE }
        } else {
            Flight::Escape { weight: Rgb::ONE }
        }
    }

    fn profile(&self, _ray: &Ray, span: Span, profile: &mut RayProfile) {
        profile.set_uniform(span, Rgb::splat(self.sigma_t));
    }
}

/// The same sigma_t everywhere, one a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChromaticExtinction {
    /// \[1/m\] per channel.
    pub sigma_t: Rgb,
}

impl Extinction for ChromaticExtinction {
    type Scattering = Phase;

    const IS_UNIFORM: bool = true;
    const IS_CHROMATIC: bool = true;

    fn sigma_t(&self, _position: DVec3) -> Rgb {
        self.sigma_t
    }

    #[inline]
    fn scattering_at(&self, medium: &Medium, _position: DVec3) -> Phase {
        medium.phase
    }

    fn optical_depth(&self, _ray: &Ray, span: Span) -> Rgb {
        let length = span.length();
        let depth = |sigma_t| uniform_depth(sigma_t, length);
        Rgb::new(depth(self.sigma_t.x), depth(self.sigma_t.y), depth(self.sigma_t.z))
    }

    fn sample_flight(&self, ray: &Ray, span: Span, power: Rgb, random: &mut Random) -> Flight {
        self.invert_flight(ray, span, power, uniform(random))
    }

    fn flying_weight(&self, length: f64, power: Rgb) -> Rgb {
        let total = power.element_sum();
        let share = if total > 0.0 { power / total } else { Rgb::splat(1.0 / 3.0) };
        // Of the channels' depths the least is taken out: none but the others may underflow.
        let thinnest = self.sigma_t.min_element();
        let transmittance = exp(-(self.sigma_t - Rgb::splat(thinnest)) * length);
        let surviving = share.dot(transmittance);
        if surviving > 0.0 { transmittance / surviving } else { Rgb::ONE }
    }

    fn invert_flight(&self, _ray: &Ray, span: Span, power: Rgb, u: f64) -> Flight {
        let total = power.element_sum();
        let share = if total > 0.0 { power / total } else { Rgb::splat(1.0 / 3.0) };
        let length = span.length();
        let transmittance = exp(-self.optical_depth(&Ray::new(DVec3::ZERO, DVec3::X), span));
        let survival = 1.0 - u;
        if survival <= share.dot(transmittance) {
            let weight = transmittance / share.dot(transmittance);
            return Flight::Escape { weight };
        }
        let distance = self.invert_survival(share, survival, length);
        let density = self.sigma_t * exp(-self.sigma_t * distance);
        let weight = density / share.dot(density);
        Flight::Collision { distance: span.start + distance, weight }
    }

    /// What escapes has the colour that the medium leaves it, whether the photon collides besides or not.
    fn boosted_flight(
        &self,
        ray: &Ray,
        span: Span,
        power: Rgb,
        boosted: BoostedQuantile,
        _profile: &mut RayProfile,
        _is_known: bool,
    ) -> BoostedFlight {
        let opacity = self.opacity(ray, span, power);
        let transmittance = exp(-self.optical_depth(ray, span));
        let natural = boosted.flight(opacity, |u| self.invert_flight(ray, span, power, u));
        let escape_weight = if opacity < 1.0 { transmittance / (1.0 - opacity) } else { Rgb::ONE };
        let flight = match natural.flight {
            Flight::Escape { .. } => Flight::Escape { weight: escape_weight },
            collision => collision,
        };
        BoostedFlight { flight, escape_weight, ..natural }
    }

    fn profile(&self, _ray: &Ray, span: Span, profile: &mut RayProfile) {
        profile.set_uniform(span, self.sigma_t);
    }
}

impl ChromaticExtinction {
    /// The distance below `length` at which sum_c share_c exp(-sigma_c t) = `survival`: Newton on a convex
    /// decreasing function, kept within a shrinking bracket.
    fn invert_survival(&self, share: Rgb, survival: f64, length: f64) -> f64 {
        let log_survival = survival.ln();
        let (mut low, mut high) = (0.0, length.min(-log_survival / self.smallest_sampled(share)));
        let mut distance = (-log_survival / share.dot(self.sigma_t)).min(high);
        for _ in 0..100 {
            let channels = share * exp(-self.sigma_t * distance);
            let value = channels.element_sum() - survival;
            if value > 0.0 {
                low = distance;
            } else {
                high = distance;
            }
            let step = value / channels.dot(self.sigma_t);
            let newton = distance + step;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - distance).abs() <= 1e-15 * distance {
                return next;
            }
            distance = next;
        }
        distance
    }

    /// The smallest sigma_t among the channels that the photon's power takes part in.
    fn smallest_sampled(&self, share: Rgb) -> f64 {
        let mut smallest = f64::INFINITY;
        for channel in 0..3 {
            if share[channel] > 0.0 {
                smallest = smallest.min(self.sigma_t[channel]);
            }
        }
        smallest
    }
}

/// sigma_t times length, with 0 times infinity = 0.
fn uniform_depth(sigma_t: f64, length: f64) -> f64 {
    if sigma_t == 0.0 { 0.0 } else { sigma_t * length }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Stream;

    const RAY: Ray = Ray { origin: DVec3::ZERO, direction: DVec3::X };

    #[test]
    fn flights_invert_the_exponential_and_vanishing_sigma_escapes() {
        let medium = UniformExtinction { sigma_t: 2.0 };
        let span = Span::new(1.0, 9.0);
        let flight = medium.invert_flight(&RAY, span, Rgb::ONE, 0.5);
        let expected = 1.0 + 0.5 * std::f64::consts::LN_2;
        assert!(
            matches!(flight, Flight::Collision { distance, .. } if (distance - expected).abs() < 1e-15)
        );
        for sigma_t in [0.0, 1e-300] {
            let empty = UniformExtinction { sigma_t };
            for u in [0.0, 0.5, 1.0 - f64::EPSILON] {
                let flight = empty.invert_flight(&RAY, Span::new(0.0, f64::INFINITY), Rgb::ONE, u);
                let span_finite = empty.invert_flight(&RAY, span, Rgb::ONE, u);
                assert!(sigma_t > 0.0 || matches!(flight, Flight::Escape { .. }), "{flight:?}");
                assert!(
                    u == 0.0 || matches!(span_finite, Flight::Escape { .. }),
                    "{span_finite:?}"
                );
            }
        }
    }

    /// Chromatic flights: each channel's weighted collision density and escape must be its own, for every
    /// power. Checked by exact quadrature over u of weight * indicator.
    #[test]
    fn chromatic_flights_are_unbiased_in_every_channel() {
        let medium = ChromaticExtinction { sigma_t: Rgb::new(0.5, 2.0, 8.0) };
        for power in [Rgb::ONE, Rgb::new(1.0, 0.0, 0.0), Rgb::new(0.1, 1.0, 0.3)] {
            let span = Span::new(0.0, 1.2);
            let (mut near, mut escaped) = (Rgb::ZERO, Rgb::ZERO);
            let steps = 200_000;
            for i in 0..steps {
                let u = (i as f64 + 0.5) / steps as f64;
                match medium.invert_flight(&RAY, span, power, u) {
                    Flight::Collision { distance, weight } if distance < 0.4 => near += weight,
                    Flight::Collision { .. } => {}
                    Flight::Escape { weight } => escaped += weight,
                }
            }
            for channel in 0..3 {
                if power[channel] == 0.0 {
                    continue;
                }
                let sigma = medium.sigma_t[channel];
                let exact_near = 1.0 - (-sigma * 0.4).exp();
                let exact_escape = (-sigma * 1.2).exp();
                assert!((near[channel] / steps as f64 - exact_near).abs() < 2e-5);
                assert!((escaped[channel] / steps as f64 - exact_escape).abs() < 2e-5);
            }
        }
    }

    #[test]
    fn channels_without_extinction_pass() {
        let medium = ChromaticExtinction { sigma_t: Rgb::new(0.0, 0.0, 3.0) };
        let mut random = Stream::Experiment.random(1, 0);
        for _ in 0..1000 {
            let flight = medium.sample_flight(
                &RAY,
                Span::new(0.0, 50.0),
                Rgb::new(1.0, 1.0, 0.0),
                &mut random,
            );
            assert!(matches!(flight, Flight::Escape { weight } if weight.x == 1.0));
        }
    }
}
