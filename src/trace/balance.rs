//! Where the photons' power went.

use serde::Serialize;

use crate::math::Rgb;

/// The energy balance of a pass, in `f64`.
///
/// emitted = absorbed + escaped + truncated + resampled holds up to rounding, photon by photon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PowerBalance {
    /// Power of all photons sent into the bounds \[W\].
    pub emitted: Rgb,
    /// Power lost at collisions. A photon survives by chance with the mean of its power kept exactly (Russian
    /// roulette), so this is an estimate of the absorbed power, without bias.
    pub absorbed: Rgb,
    /// Power that left the bounds.
    pub escaped: Rgb,
    /// Power dropped at `max_order`.
    pub truncated: Rgb,
    /// Minus what the weights of chromatic flights added: 0 in the mean, and exactly 0 where sigma_t is grey.
    pub resampled: Rgb,
}

impl PowerBalance {
    /// Adds another share of the pass.
    pub fn add(&mut self, other: &Self) {
        self.emitted += other.emitted;
        self.absorbed += other.absorbed;
        self.escaped += other.escaped;
        self.truncated += other.truncated;
        self.resampled += other.resampled;
    }

    /// Makes this, the mean over `passes` passes, the mean that includes another pass.
    pub fn average_in(&mut self, pass: &Self, passes: u32) {
        let share = 1.0 / (f64::from(passes) + 1.0);
        let towards = |mean: &mut Rgb, value: Rgb| *mean += (value - *mean) * share;
        towards(&mut self.emitted, pass.emitted);
        towards(&mut self.absorbed, pass.absorbed);
        towards(&mut self.escaped, pass.escaped);
        towards(&mut self.truncated, pass.truncated);
        towards(&mut self.resampled, pass.resampled);
    }
}
