//! Phase functions: the distribution of scattered light over directions, per steradian, with integral 1.
//!
//! Henyey and Greenstein (1941): p(cos) = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)), where cos is the
//! cosine between the directions of travel before and after.

use std::f64::consts::PI;

use rand::Rng;

use crate::math::{DVec3, Frame, uniform};

/// 1 / (4 pi): the isotropic phase function.
pub const ISOTROPIC: f64 = 0.25 / PI;

/// A phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// 1 / (4 pi).
    Isotropic,
    /// Henyey-Greenstein, mean cosine g in (-1, 1), g > 0 forward. At -1 and 1, which scene files refuse, light goes straight
    /// back or on: it can be sampled, but has no density.
    HenyeyGreenstein {
        /// Mean cosine of the scattering angle.
        g: f64,
    },
}

impl Phase {
    /// Whether all directions are alike, so that photons need not keep theirs.
    pub fn is_isotropic(self) -> bool {
        match self {
            Self::Isotropic => true,
            Self::HenyeyGreenstein { g } => g == 0.0,
        }
    }

    /// Mean cosine of the scattering angle: what is kept of a direction.
    pub fn mean_cosine(self) -> f64 {
        match self {
            Self::Isotropic => 0.0,
            Self::HenyeyGreenstein { g } => g,
        }
    }

    /// The density of scattering by an angle of the given cosine \[1/sr\]; 0 where all light goes one way.
    #[inline]
    pub fn density(self, cosine: f64) -> f64 {
        match self {
            Self::Isotropic => ISOTROPIC,
            Self::HenyeyGreenstein { g } => {
                // (1 - g)^2 + 2 g (1 - cos) is 1 + g^2 - 2 g cos without its cancellation at g -> 1.
                let base = if g >= 0.0 {
                    (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cosine)
                } else {
                    (1.0 + g) * (1.0 + g) - 2.0 * g * (1.0 + cosine)
                };
                let width = (1.0 - g) * (1.0 + g);
                if width > 0.0 { ISOTROPIC * width / (base * base.sqrt()) } else { 0.0 }
            }
        }
    }

    /// Draws the direction after scattering, with density [`Phase::density`]; `direction` is the
    /// direction of travel before.
    #[inline]
    pub fn sample_direction(self, direction: DVec3, random: &mut impl Rng) -> DVec3 {
        let t = 2.0 * uniform(random) - 1.0;
        let phi = 2.0 * PI * uniform(random);
        match self {
            Self::Isotropic => {
                let sin_theta = (1.0 - t * t).max(0.0).sqrt();
                let (sin_phi, cos_phi) = phi.sin_cos();
                DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, t)
            }
            Self::HenyeyGreenstein { g } => {
                let cosine = henyey_greenstein_cosine(g, t);
                let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
                // Renormalised, so that a thousand scatterings do not add up their roundings.
                Frame::about(direction).polar(cosine, sine, phi).normalize()
            }
        }
    }
}

/// Inverts the Henyey-Greenstein distribution at t = 2u - 1.
///
/// Near g = 0 the textbook form divides by g; the rational form has no such pole but cancels for
/// large |g|, so each serves its half.
fn henyey_greenstein_cosine(g: f64, t: f64) -> f64 {
    if g.abs() >= 1.0 {
        return g.signum();
    }
    let cosine = if g.abs() < 0.3 {
        let tt = t * t;
        let numerator = 2.0 * t + g * (tt + 3.0) + 2.0 * g * g * t + g * g * g * (tt - 1.0);
        let root = 1.0 + g * t;
        numerator / (2.0 * root * root)
    } else {
        let root = (1.0 - g * g) / (1.0 + g * t);
        (1.0 + g * g - root * root) / (2.0 * g)
    };
    cosine.clamp(-1.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Stream;

    #[test]
    fn density_integrates_to_one_with_mean_cosine_g() {
        for g in [-0.9, -0.5, -1e-5, 0.0, 1e-8, 0.3, 0.85, 0.99] {
            let phase = Phase::HenyeyGreenstein { g };
            // Substituting the sampled quantile makes the integrand smooth for every g.
            let steps = 4000;
            let (mut total, mut mean) = (0.0, 0.0);
            for i in 0..steps {
                let edge =
                    |j: usize| henyey_greenstein_cosine(g, 2.0 * j as f64 / steps as f64 - 1.0);
                let (low, high) = (edge(i), edge(i + 1));
                let middle = 0.5 * (low + high);
                let simpson = |f: &dyn Fn(f64) -> f64| {
                    (high - low) / 6.0 * (f(low) + 4.0 * f(middle) + f(high))
                };
                total += 2.0 * PI * simpson(&|c| phase.density(c));
                mean += 2.0 * PI * simpson(&|c| c * phase.density(c));
            }
            assert!((total - 1.0).abs() < 1e-6, "g {g}: integral {total}");
            assert!((mean - g).abs() < 1e-6, "g {g}: mean cosine {mean}");
        }
    }

    #[test]
    fn inversion_forms_agree_where_they_meet_and_keep_tiny_g() {
        for t in [-1.0, -0.7, 0.0, 0.4, 1.0] {
            let below = henyey_greenstein_cosine(0.3 - 1e-12, t);
            let above = henyey_greenstein_cosine(0.3, t);
            assert!((below - above).abs() < 1e-10, "t {t}");
            for g in [1e-4, 1e-8, -1e-6] {
                let expansion = t + 1.5 * g * (1.0 - t * t);
                assert!((henyey_greenstein_cosine(g, t) - expansion).abs() < 10.0 * g * g);
            }
        }
        assert_eq!(henyey_greenstein_cosine(0.99, 1.0), 1.0);
        assert_eq!(henyey_greenstein_cosine(-0.99, -1.0), -1.0);
    }

    /// <P_l> = g^l for l = 1, 2, 3 (VALIDATION identity E14), by z-scores over 64 batches.
    #[test]
    fn legendre_moments_of_samples_are_powers_of_g() {
        for (case, g) in [-0.7, -0.2, 1e-6, 0.25, 0.5, 0.95].into_iter().enumerate() {
            let phase = Phase::HenyeyGreenstein { g };
            let axis = DVec3::new(0.48, -0.6, 0.64);
            let batches: Vec<[f64; 3]> = (0..64)
                .map(|batch| {
                    let mut random = Stream::Experiment.random(case as u64, batch);
                    let mut sums = [0.0; 3];
                    for _ in 0..4000 {
                        let c = phase.sample_direction(axis, &mut random).dot(axis);
                        sums[0] += c;
                        sums[1] += 0.5 * (3.0 * c * c - 1.0);
                        sums[2] += 0.5 * (5.0 * c * c * c - 3.0 * c);
                    }
                    sums.map(|s| s / 4000.0)
                })
                .collect();
            for l in 0..3 {
                let mean = batches.iter().map(|b| b[l]).sum::<f64>() / 64.0;
                let spread = batches.iter().map(|b| (b[l] - mean).powi(2)).sum::<f64>();
                let z = (mean - g.powi(l as i32 + 1)) / (spread / 63.0 / 64.0).sqrt();
                assert!(z.abs() < 4.5, "g {g}, l {}: z = {z}", l + 1);
            }
        }
    }
}
