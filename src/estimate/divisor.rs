//! The numerator of the k-nearest estimate.
//!
//! The k-th photon lies on the ball, not in it, because it defines the ball. Counting it makes the estimate too
//! high: by 1 / (k - 1) of the truth among photons placed at random, where E\[1 / V_k\] = n / (k - 1).

use std::num::NonZeroUsize;

/// What the k nearest photons count as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Divisor {
    /// k: too high by 1/(k-1) in a random map.
    K,
    /// k - 1, the last one left out: unbiased in a random map.
    KMinus1,
    /// k - 1/2, half of the last one: closest where photons are stratified by depth.
    KMinusHalf,
    /// What makes the map at hand unbiased, as measured from the photons themselves ([`CountLaw`](super::CountLaw)).
    Calibrated,
}

impl Divisor {
    /// The numerator for equal photons; `None` where it must be measured. With k = 1 that photon is all there is, and
    /// dropping it would read 0 everywhere: it counts in full.
    pub fn constant(self, k: NonZeroUsize) -> Option<f64> {
        let count = k.get() as f64;
        match self {
            Self::Calibrated => None,
            _ if k.get() == 1 => Some(1.0),
            Self::K => Some(count),
            Self::KMinusHalf => Some(count - 0.5),
            Self::KMinus1 => Some(count - 1.0),
        }
    }

    /// As in scene files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::K => "k",
            Self::KMinus1 => "k-1",
            Self::KMinusHalf => "k-1/2",
            Self::Calibrated => "calibrated",
        }
    }
}

/// How much of each photon counts, so that k equal ones count as c.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shares {
    /// Of the k - 1 inside the ball.
    pub(super) inner: f64,
    /// Of the one on it.
    pub(super) last: f64,
}

impl Shares {
    /// All there are.
    pub(super) const FULL: Self = Self { inner: 1.0, last: 1.0 };

    /// Less than k is taken off the last photon first, and off the others where that does not suffice.
    pub(super) fn of(constant: f64, k: NonZeroUsize) -> Self {
        let inside = (k.get() - 1) as f64;
        if constant >= inside {
            Self { inner: 1.0, last: constant - inside }
        } else {
            Self { inner: constant / inside, last: 0.0 }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_photons_count_as_the_constant() {
        for k in [1, 2, 7, 1000] {
            let k = NonZeroUsize::new(k).unwrap();
            for c in [0.4, 0.9, 1.0, 5.5, 6.25, 998.9, 999.5] {
                let Shares { inner, last } = Shares::of(c, k);
                let sum = inner * (k.get() - 1) as f64 + last;
                assert!((sum - c).abs() < 1e-12 * c, "{k} {c}: {sum}");
                assert!(last >= 0.0 && inner <= 1.0);
            }
            for divisor in [Divisor::K, Divisor::KMinusHalf, Divisor::KMinus1] {
                let c = divisor.constant(k).unwrap();
                assert!(Shares::of(c, k).last <= 1.0 && c > 0.0);
            }
        }
    }
}
