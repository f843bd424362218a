//! A lobe of scattered light.
//!
//! Henyey and Greenstein (1941): p(cos) = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)). Draine (2003), *Scattering by
//! Interstellar Dust Grains I*: the same times (1 + alpha cos^2) / (1 + alpha (1 + 2 g^2) / 3), with alpha = 0 Henyey and Greenstein's,
//! and with alpha = 1, g = 0 Rayleigh's. As <cos^2> = (1 + 2 g^2) / 3 and <cos^3> = g (3 + 2 g^2) / 5 of the former, its mean cosine is
//! g (1 + alpha (3 + 2 g^2) / 5) / (1 + alpha (1 + 2 g^2) / 3).
//!
//! It is sampled by rejection from Henyey and Greenstein's: a cosine is kept with the probability (1 + alpha cos^2) /
//! (1 + alpha), at worst (g = 0, large alpha) one in three. The inverse in closed form is the root of a quartic, whose terms cancel at small g
//! and small alpha; this has no such places.

use rand::Rng;

use super::ISOTROPIC;
use crate::math::uniform;

/// Draine's phase function; with `alpha` = 0 Henyey and Greenstein's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// In (-1, 1); above 0 is forward.
    pub g: f64,
    /// Weight of cos^2, from 0 on.
    pub alpha: f64,
}

impl Lobe {
    /// Henyey and Greenstein's of mean cosine `g`.
    pub fn henyey_greenstein(g: f64) -> Self {
        Self { g, alpha: 0.0 }
    }

    /// Whether all directions are alike.
    pub fn is_isotropic(self) -> bool {
        self.g == 0.0 && self.alpha == 0.0
    }

    /// The mean cosine of the scattering angle.
    pub fn mean_cosine(self) -> f64 {
        let Self { g, alpha } = self;
        g * (1.0 + alpha * (3.0 + 2.0 * g * g) / 5.0) / self.mean_weight()
    }

    /// \[1/sr\]; 0 where all light goes one way.
    #[inline]
    pub fn density(self, cosine: f64) -> f64 {
        let weight = (1.0 + self.alpha * cosine * cosine) / self.mean_weight();
        henyey_greenstein(self.g, cosine) * weight
    }

    /// A cosine with the lobe's density.
    #[inline]
    pub fn sample_cosine(self, random: &mut impl Rng) -> f64 {
        loop {
            let cosine = henyey_greenstein_cosine(self.g, 2.0 * uniform(random) - 1.0);
            let weight = 1.0 + self.alpha * cosine * cosine;
            if self.alpha == 0.0 || uniform(random) * (1.0 + self.alpha) < weight {
                return cosine;
            }
        }
    }

    /// The mean of 1 + alpha cos^2 over Henyey and Greenstein's.
    fn mean_weight(self) -> f64 {
        1.0 + self.alpha * (1.0 + 2.0 * self.g * self.g) / 3.0
    }
}

/// Henyey and Greenstein's density \[1/sr\]; 0 where all light goes one way.
#[inline]
pub(super) fn henyey_greenstein(g: f64, cosine: f64) -> f64 {
    // (1 - g)^2 + 2 g (1 - cos) is 1 + g^2 - 2 g cos without its cancellation at g -> 1.
    let base = if g >= 0.0 {
        (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cosine)
    } else {
        (1.0 + g) * (1.0 + g) - 2.0 * g * (1.0 + cosine)
    };
    let width = (1.0 - g) * (1.0 + g);
    if width > 0.0 { ISOTROPIC * width / (base * base.sqrt()) } else { 0.0 }
}

/// Inverts the Henyey-Greenstein distribution at t = 2u - 1.
///
/// Near g = 0 the textbook form divides by g; the rational form has no such pole but cancels for
/// large |g|, so each serves its half.
pub(super) fn henyey_greenstein_cosine(g: f64, t: f64) -> f64 {
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
}
