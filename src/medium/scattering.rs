//! Where the light goes that is scattered at a place: one phase function, or, where volumes overlap, a mixture.
//!
//! Of volumes with sigma_s,i and phase functions p_i the mixture is p = sum sigma_s,i p_i / sum sigma_s,i, per channel.

use rand::Rng;

use super::Phase;
use crate::math::{DVec3, Random, Rgb, mean_channel, uniform};

/// The distribution of light scattered at one place.
pub trait Scattering {
    /// `light` times `weight` times the density of scattering by an angle of the given cosine \[1/sr\].
    fn scatter(&self, light: Rgb, weight: f64, cosine: f64) -> Rgb;

    /// Density of [`Self::sample_direction`] \[1/sr\]: that of scattering, averaged over channels.
    fn pdf(&self, cosine: f64) -> f64;

    /// Draws the direction after scattering from that before.
    fn sample_direction(&self, direction: DVec3, random: &mut Random) -> DVec3;
}

impl Scattering for Phase {
    #[inline]
    fn scatter(&self, light: Rgb, weight: f64, cosine: f64) -> Rgb {
        light * (weight * self.density(cosine))
    }

    #[inline]
    fn pdf(&self, cosine: f64) -> f64 {
        self.density(cosine)
    }

    #[inline]
    fn sample_direction(&self, direction: DVec3, random: &mut Random) -> DVec3 {
        Phase::sample_direction(*self, direction, random)
    }
}

/// The phase functions of the volumes about a place, each with its share of sigma_s.
#[derive(Clone, Debug, PartialEq)]
pub enum PhaseMixture {
    /// All scatter alike.
    Same(Phase),
    /// One for each volume that scatters there.
    Different(Vec<PhaseShare>),
}

/// A phase function and its share of all scattering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseShare {
    /// The phase function.
    pub phase: Phase,
    /// Its share of sigma_s per channel.
    pub share: Rgb,
}

impl PhaseMixture {
    /// Of phase functions with their sigma_s; none that scatters leaves `otherwise`.
    pub fn new(parts: impl Iterator<Item = (Phase, Rgb)>, otherwise: Phase) -> Self {
        let mut shares: Vec<PhaseShare> = parts
            .filter(|(_, sigma_s)| *sigma_s != Rgb::ZERO)
            .map(|(phase, sigma_s)| PhaseShare { phase, share: sigma_s })
            .collect();
        match shares.as_slice() {
            [] => Self::Same(otherwise),
            [only] => Self::Same(only.phase),
            _ => {
                let total: Rgb = shares.iter().map(|part| part.share).sum();
                // A channel that nothing scatters has no light to share out.
                let inverse = total.map(|total| if total > 0.0 { 1.0 / total } else { 0.0 });
                shares.iter_mut().for_each(|part| part.share *= inverse);
                Self::Different(shares)
            }
        }
    }
}

impl Scattering for PhaseMixture {
    fn scatter(&self, light: Rgb, weight: f64, cosine: f64) -> Rgb {
        match self {
            Self::Same(phase) => phase.scatter(light, weight, cosine),
            Self::Different(parts) => {
                let density = |part: &PhaseShare| part.share * part.phase.density(cosine);
                light * parts.iter().map(density).sum::<Rgb>() * weight
            }
        }
    }

    fn pdf(&self, cosine: f64) -> f64 {
        match self {
            Self::Same(phase) => phase.density(cosine),
            Self::Different(parts) => {
                let total: f64 = parts.iter().map(|part| mean_channel(part.share)).sum();
                let density = |part: &PhaseShare| {
                    mean_channel(part.share) / total * part.phase.density(cosine)
                };
                parts.iter().map(density).sum()
            }
        }
    }

    fn sample_direction(&self, direction: DVec3, random: &mut Random) -> DVec3 {
        let phase = match self {
            Self::Same(phase) => *phase,
            Self::Different(parts) => pick(parts, random),
        };
        phase.sample_direction(direction, random)
    }
}

/// A phase function with the probability of its mean share.
fn pick(parts: &[PhaseShare], random: &mut impl Rng) -> Phase {
    let total: f64 = parts.iter().map(|part| mean_channel(part.share)).sum();
    let mut left = uniform(random) * total;
    for part in parts {
        left -= mean_channel(part.share);
        if left < 0.0 {
            return part.phase;
        }
    }
    parts.last().map_or(Phase::Isotropic, |part| part.phase)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Stream;

    /// Weighted samples integrate the mixture to 1 and to its mean cosine in every channel.
    #[test]
    fn samples_over_their_density_are_the_mixture() {
        let forward = Phase::HenyeyGreenstein { g: 0.7 };
        let parts = [
            (forward, Rgb::new(1.0, 0.5, 0.0)),
            (Phase::Isotropic, Rgb::new(1.0, 1.5, 2.0)),
            (Phase::HenyeyGreenstein { g: -0.5 }, Rgb::ZERO),
        ];
        let mixture = PhaseMixture::new(parts.into_iter(), Phase::Isotropic);
        let axis = DVec3::new(0.48, -0.6, 0.64);
        let mut random = Stream::Experiment.random(31, 0);
        let (mut total, mut mean) = (Rgb::ZERO, Rgb::ZERO);
        let count = 400_000;
        for _ in 0..count {
            let cosine = mixture.sample_direction(axis, &mut random).dot(axis);
            let weight = mixture.scatter(Rgb::ONE, 1.0 / mixture.pdf(cosine), cosine);
            total += weight / f64::from(count);
            mean += weight * cosine / f64::from(count);
        }
        assert!((total - Rgb::ONE).abs().max_element() < 5e-3, "{total}");
        let exact = Rgb::new(0.5, 0.25, 0.0) * 0.7;
        assert!((mean - exact).abs().max_element() < 5e-3, "{mean} {exact}");
        let one = PhaseMixture::new(parts[..1].iter().copied(), Phase::Isotropic);
        assert_eq!(one, PhaseMixture::Same(forward));
        assert_eq!(PhaseMixture::new([].into_iter(), forward), PhaseMixture::Same(forward));
    }
}
