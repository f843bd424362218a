//! How the number of photons in a ball varies in each model: what the calibrated constant is made of.
//!
//! Shells and parts of a line vary with the ball's size in waves, V = x f (1 - f) where the ball covers a share f of a
//! shell of x photons. Balls of about a size, as a calibration takes them, see the mean, x / 6.

use super::Model;
use crate::estimate::CountLaw;
use crate::lab::jitter::JitterLaw;

impl Model {
    /// The law of counts about k photons; none where no photons are counted or k is 1, whose mean is infinite.
    pub fn count_law(self, k: u64) -> Option<CountLaw> {
        let count = k as f64;
        let law = |variance, exponent| Some(CountLaw { variance, exponent });
        match self {
            _ if k < 2 => None,
            Self::FirstApproximation | Self::FixedRadius => None,
            Self::Random(_) => law(count, 1.0),
            // Both ends of the interval cut a part.
            Self::Stratified => law(1.0 / 3.0, 0.0),
            Self::Basic(_) => law(1.0 / 6.0, 0.0),
            // The shell of the k-th photon holds about sqrt(2 k) of them.
            Self::Order(_) | Self::OrderVolume(_) => law((2.0 * count).sqrt() / 6.0, 0.5),
            Self::Jittered(dimension) => Some(JitterLaw::new(dimension).counts(count)),
        }
    }
}
