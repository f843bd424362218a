//! The numerator of the k-nearest estimate.
//!
//! The k-th photon lies on the ball, not in it, because it defines the ball. Counting it makes the estimate too
//! high: by 1 / (k - 1) of the truth among photons placed at random, where E\[1 / V_k\] = n / (k - 1).

use std::num::NonZeroUsize;

/// How much of the k-th photon counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Divisor {
    /// All of it: too high by 1/(k-1) in a random map.
    K,
    /// None of it: unbiased in a random map.
    KMinus1,
    /// Half of it: closest where photons are stratified by depth.
    KMinusHalf,
}

impl Divisor {
    /// The share of the k-th photon's power that counts. With k = 1 that photon is all there is, and dropping it
    /// would read 0 everywhere: it counts in full.
    pub fn last_share(self, k: NonZeroUsize) -> f64 {
        match self {
            Self::K => 1.0,
            _ if k.get() == 1 => 1.0,
            Self::KMinus1 => 0.0,
            Self::KMinusHalf => 0.5,
        }
    }

    /// As in scene files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::K => "k",
            Self::KMinus1 => "k-1",
            Self::KMinusHalf => "k-1/2",
        }
    }
}
