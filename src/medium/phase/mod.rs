//! Phase functions: the distribution of scattered light over directions, per steradian, with integral 1.
//!
//! All but the isotropic one are made of lobes ([`Lobe`]): Henyey and Greenstein's, Draine's, or two of them mixed, such as the one of
//! water droplets ([`droplets`](self)). cos is the cosine between the directions of travel before and after.

mod droplets;
mod lobe;

pub use droplets::{LARGEST_DROPLET, SMALLEST_DROPLET};
pub use lobe::Lobe;

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
    /// Draine's: Henyey-Greenstein times 1 + alpha cos^2.
    Draine(Lobe),
    /// A mixture of two lobes.
    TwoLobes {
        /// The first lobe.
        first: Lobe,
        /// The second.
        second: Lobe,
        /// Share of the light that the first scatters, in \[0, 1\].
        share: f64,
    },
}

impl Phase {
    /// Draine's phase function, for g in (-1, 1) and alpha from 0 on; in its simplest form.
    pub fn draine(g: f64, alpha: f64) -> Self {
        match (g, alpha) {
            (0.0, 0.0) => Self::Isotropic,
            (_, 0.0) => Self::HenyeyGreenstein { g },
            _ => Self::Draine(Lobe { g, alpha }),
        }
    }

    /// The mixture of two lobes of which the first scatters a share in \[0, 1\]; in its simplest form.
    pub fn two_lobes(first: Lobe, second: Lobe, share: f64) -> Self {
        match share {
            0.0 => Self::draine(second.g, second.alpha),
            1.0 => Self::draine(first.g, first.alpha),
            _ if first == second => Self::draine(first.g, first.alpha),
            _ => Self::TwoLobes { first, second, share },
        }
    }

    /// Whether all directions are alike, so that photons need not keep theirs.
    pub fn is_isotropic(self) -> bool {
        match self {
            Self::Isotropic => true,
            Self::HenyeyGreenstein { g } => g == 0.0,
            Self::Draine(lobe) => lobe.is_isotropic(),
            Self::TwoLobes { first, second, .. } => first.is_isotropic() && second.is_isotropic(),
        }
    }

    /// The mean cosine of the scattering angle.
    pub fn mean_cosine(self) -> f64 {
        match self {
            Self::Isotropic => 0.0,
            Self::HenyeyGreenstein { g } => g,
            Self::Draine(lobe) => lobe.mean_cosine(),
            Self::TwoLobes { first, second, share } => {
                share * first.mean_cosine() + (1.0 - share) * second.mean_cosine()
            }
        }
    }

    /// The density of scattering by an angle of the given cosine \[1/sr\]; 0 where all light goes one way.
    #[inline]
    pub fn density(self, cosine: f64) -> f64 {
        match self {
            Self::Isotropic => ISOTROPIC,
            Self::HenyeyGreenstein { g } => lobe::henyey_greenstein(g, cosine),
            lobes => lobes.density_of_lobes(cosine),
        }
    }

    /// Apart, so that the phase functions above, asked in every cell that a photon crosses, compile as if there were no others.
    #[inline(never)]
    fn density_of_lobes(self, cosine: f64) -> f64 {
        match self {
            Self::Draine(lobe) => lobe.density(cosine),
            Self::TwoLobes { first, second, share } => {
                share * first.density(cosine) + (1.0 - share) * second.density(cosine)
            }
            Self::Isotropic => ISOTROPIC,
            Self::HenyeyGreenstein { g } => lobe::henyey_greenstein(g, cosine),
        }
    }

    /// Draws the direction after scattering, with density [`Phase::density`]; `direction` is the
    /// direction of travel before.
    #[inline]
    pub fn sample_direction(self, direction: DVec3, random: &mut (impl Rng + Clone)) -> DVec3 {
        let cosine = match self {
            Self::Isotropic => {
                let t = 2.0 * uniform(random) - 1.0;
                let sin_theta = (1.0 - t * t).max(0.0).sqrt();
                let (sin_phi, cos_phi) = (2.0 * PI * uniform(random)).sin_cos();
                return DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, t);
            }
            Self::HenyeyGreenstein { g } => {
                lobe::henyey_greenstein_cosine(g, 2.0 * uniform(random) - 1.0)
            }
            lobes => {
                // A copy: what is called apart needs its generator in memory, the others may keep theirs in registers.
                let mut copy = random.clone();
                let cosine = lobes.sample_cosine_of_lobes(&mut copy);
                *random = copy;
                cosine
            }
        };
        let phi = 2.0 * PI * uniform(random);
        let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
        // Renormalised, so that a thousand scatterings do not add up their roundings.
        Frame::about(direction).polar(cosine, sine, phi).normalize()
    }

    /// Apart as [`Self::density_of_lobes`] is.
    #[inline(never)]
    fn sample_cosine_of_lobes(self, random: &mut impl Rng) -> f64 {
        let lobe = match self {
            Self::Isotropic => Lobe::henyey_greenstein(0.0),
            Self::HenyeyGreenstein { g } => Lobe::henyey_greenstein(g),
            Self::Draine(lobe) => lobe,
            Self::TwoLobes { first, second, share } => {
                if uniform(random) < share {
                    first
                } else {
                    second
                }
            }
        };
        lobe.sample_cosine(random)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Stream;

    fn lobe(g: f64, alpha: f64) -> Lobe {
        Lobe { g, alpha }
    }

    /// One of each kind, peaked and not, at the ends of what scenes may ask for.
    fn cases() -> Vec<Phase> {
        let hg = |g| lobe(g, 0.0);
        let mut cases = vec![Phase::Isotropic];
        for g in [-0.99, -0.9, -1e-5, 0.0, 1e-8, 0.3, 0.85, 0.99] {
            cases.push(Phase::HenyeyGreenstein { g });
            for alpha in [1e-9, 0.3, 1.0, 30.0, 1e6] {
                cases.push(Phase::draine(g, alpha));
            }
            cases.push(Phase::two_lobes(hg(g), hg(-0.4), 0.8));
            cases.push(Phase::two_lobes(hg(g), lobe(0.5, 20.0), 1e-3));
        }
        cases.extend([5.0, 10.0, 20.0, 50.0].map(Phase::droplets));
        cases
    }

    /// Integral of f over cosines, with nodes ever denser towards both ends.
    fn integral(f: impl Fn(f64) -> f64) -> f64 {
        let steps = 4000;
        // 1 - |cos| at a node.
        let rest = |i: f64| (1.0 - (i / f64::from(steps)).abs()).powi(6);
        let cosine = |i: f64| i.signum() * (1.0 - rest(i));
        (-steps..steps)
            .map(|i| {
                let (low, high) = (f64::from(i), f64::from(i + 1));
                let width = if i < 0 { rest(high) - rest(low) } else { rest(low) - rest(high) };
                let middle = 0.5 * (cosine(low) + cosine(high));
                width / 6.0 * (f(cosine(low)) + 4.0 * f(middle) + f(cosine(high)))
            })
            .sum()
    }

    #[test]
    fn densities_integrate_to_one_with_the_mean_cosine_stated() {
        for phase in cases() {
            let total = 2.0 * PI * integral(|c| phase.density(c));
            let mean = 2.0 * PI * integral(|c| c * phase.density(c));
            assert!((total - 1.0).abs() < 1e-8, "{phase:?}: integral {total}");
            assert!((mean - phase.mean_cosine()).abs() < 1e-8, "{phase:?}: mean cosine {mean}");
        }
    }

    #[test]
    fn the_simplest_form_is_chosen() {
        let (hg, draine) = (lobe(0.4, 0.0), lobe(-0.2, 3.0));
        let plain = Phase::HenyeyGreenstein { g: 0.4 };
        assert_eq!(Phase::draine(0.0, 0.0), Phase::Isotropic);
        assert_eq!(Phase::draine(0.4, 0.0), plain);
        assert_eq!(Phase::two_lobes(hg, draine, 1.0), plain);
        assert_eq!(Phase::two_lobes(hg, draine, 0.0), Phase::Draine(draine));
        assert_eq!(Phase::two_lobes(hg, hg, 0.3), plain);
        assert!(Phase::two_lobes(lobe(0.0, 0.0), lobe(0.0, 0.0), 0.3).is_isotropic());
        // Draine's with g = 0 and alpha = 1 is Rayleigh's: 3 (1 + cos^2) / (16 pi), not isotropic.
        let rayleigh = Phase::draine(0.0, 1.0);
        assert!(!rayleigh.is_isotropic());
        for cosine in [-1.0, -0.3, 0.0, 0.8] {
            let exact = 3.0 / (16.0 * PI) * (1.0 + cosine * cosine);
            assert!((rayleigh.density(cosine) - exact).abs() < 1e-16);
        }
    }

    /// Means of P_1, P_2 and P_3 over samples against those over the density, by z-scores over 64 batches.
    #[test]
    fn legendre_moments_of_samples_are_those_of_the_density() {
        let legendre = |c: f64| [c, 0.5 * (3.0 * c * c - 1.0), 0.5 * (5.0 * c * c * c - 3.0 * c)];
        let axis = DVec3::new(0.48, -0.6, 0.64);
        for (case, phase) in cases().into_iter().enumerate() {
            let batches: Vec<[f64; 3]> = (0..64)
                .map(|batch| {
                    let mut random = Stream::Experiment.random(100 + case as u64, batch);
                    let mut sums = [0.0; 3];
                    for _ in 0..1000 {
                        let c = phase.sample_direction(axis, &mut random).dot(axis);
                        let values = legendre(c);
                        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
                    }
                    sums.map(|s| s / 1000.0)
                })
                .collect();
            for l in 0..3 {
                let exact = 2.0 * PI * integral(|c| legendre(c)[l] * phase.density(c));
                let mean = batches.iter().map(|b| b[l]).sum::<f64>() / 64.0;
                let spread = batches.iter().map(|b| (b[l] - mean).powi(2)).sum::<f64>();
                let z = (mean - exact) / (spread / 63.0 / 64.0).sqrt();
                assert!(z.abs() < 4.5, "{phase:?}, l {}: z = {z}", l + 1);
            }
        }
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
