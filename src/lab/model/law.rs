//! The exact law of each model: mean and variance of c / u_(k) for any c.

use super::jittered_line::inverse_moments;
use super::{Model, Shell, ShellLaw};
use crate::lab::error::LabError;

/// The law of u_(k), as far as estimates depend on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// n Beta(k, n - k + 1).
    Random {
        /// Photons; may be infinite.
        n: f64,
        /// Which one defines the ball.
        k: u64,
    },
    /// A constant, u = k - offset: the first approximation.
    Constant {
        /// Which photon defines the ball.
        k: u64,
        /// How much less than k it is expected to enclose.
        offset: f64,
    },
    /// Photons stratified by shells.
    Shell(u64, ShellLaw),
    /// One photon in each cell of a line.
    JitteredLine {
        /// Which photon defines the ball.
        k: u64,
    },
    /// A ball of fixed radius, expected to hold k photons: the estimate is their number over k.
    FixedRadius {
        /// Photons expected.
        k: u64,
        /// Variance of their number.
        variance: f64,
    },
}

/// The law of the k-th of n photons; none of jittered grids, of which no closed form is known.
///
/// # Errors
/// The model has no k-th of n photons.
pub fn law(model: Model, n: u64, k: u64) -> Result<Option<Law>, LabError> {
    model.check(n, k)?;
    let same_parity = n.is_multiple_of(2) == k.is_multiple_of(2);
    let shell = Shell::of(k);
    Ok(Some(match model {
        Model::Random(_) => Law::Random { n: n as f64, k },
        Model::FirstApproximation => {
            Law::Constant { k, offset: if same_parity { 2.0 / 3.0 } else { 1.0 / 3.0 } }
        }
        // Mirrored at the query, the parts lie in pairs, but for a half part of one photon in the middle of an
        // odd number.
        Model::Stratified if k == 1 && !n.is_multiple_of(2) => {
            Law::Shell(k, ShellLaw::uniform_in_volume(1, 1, 1))
        }
        Model::Stratified if same_parity => Law::Shell(k, ShellLaw::uniform_in_volume(k, 2, 2)),
        Model::Stratified => Law::Shell(k, ShellLaw::uniform_in_volume(k + 1, 2, 1)),
        Model::Basic(_) => Law::Shell(k, ShellLaw::uniform_in_volume(k, 1, 1)),
        Model::Order(dimension) => {
            Law::Shell(k, ShellLaw::uniform_in_radius(shell.end, shell.x, shell.place, dimension))
        }
        Model::OrderVolume(_) => {
            Law::Shell(k, ShellLaw::uniform_in_volume(shell.end, shell.x, shell.place))
        }
        Model::Jittered(1) => Law::JitteredLine { k },
        Model::Jittered(_) => return Ok(None),
        // Of the two parts that the interval cuts in the middle, each holds its photon inside by chance 1/2.
        Model::FixedRadius => Law::FixedRadius { k, variance: if same_parity { 0.0 } else { 0.5 } },
    }))
}

impl Law {
    /// E\[(k - s) / u\] - 1. Infinite where the mean does not exist.
    pub fn bias(&self, s: f64) -> f64 {
        match *self {
            Self::Random { k: 1, .. } => f64::INFINITY,
            Self::Random { k, .. } => (1.0 - s) / (k - 1) as f64,
            Self::Constant { k, offset } => (offset - s) / (k as f64 - offset),
            Self::JitteredLine { k: 1 } => f64::INFINITY,
            Self::JitteredLine { k } => {
                let half_bias = inverse_moments(k).half_bias;
                half_bias + (0.5 - s) * (1.0 + half_bias) / (k as f64 - 0.5)
            }
            Self::FixedRadius { k, .. } => -s / k as f64,
            Self::Shell(_, shell) if !shell.has_mean() => f64::INFINITY,
            Self::Shell(k, shell) => match shell.half_bias() {
                Some(half_bias) if s == 0.5 => half_bias,
                _ => {
                    let bias = shell.bias();
                    bias - s * (1.0 + bias) / k as f64
                }
            },
        }
    }

    /// Var\[k / u\]. Infinite where 1/u^2 has no mean.
    pub fn variance(&self) -> f64 {
        match *self {
            Self::Random { k: 1 | 2, .. } => f64::INFINITY,
            Self::Random { n, k } => {
                let k = k as f64;
                let ratio = k / (k - 1.0);
                ratio * ratio * (1.0 - (k - 1.0) / n) / (k - 2.0)
            }
            Self::Constant { .. } => 0.0,
            Self::JitteredLine { k: 1 } => f64::INFINITY,
            Self::JitteredLine { k } => {
                (k as f64 / (k as f64 - 0.5)).powi(2) * inverse_moments(k).half_variance
            }
            Self::FixedRadius { k, variance } => variance / (k * k) as f64,
            Self::Shell(_, shell) => shell.variance(),
        }
    }

    /// The c for which c / u has no bias, 1 / E\[1/u\]; 0 where that mean is infinite.
    pub fn unbiased_constant(&self) -> f64 {
        match *self {
            Self::Random { k, .. } => (k - 1) as f64,
            Self::Constant { k, offset } => k as f64 - offset,
            Self::FixedRadius { k, .. } => k as f64,
            Self::Shell(k, _) | Self::JitteredLine { k } => k as f64 / (1.0 + self.bias(0.0)),
        }
    }
}
