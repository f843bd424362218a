//! The constant c of the estimator c / u_(k).

use super::model::Law;
use crate::estimate::CountLaw;

/// What the k nearest photons count as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Constant {
    /// k: all of them.
    K,
    /// k - 1/2: half of the last one.
    KMinusHalf,
    /// k - 1: the last one left out.
    KMinus1,
    /// 1 / E\[1/u_(k)\], which removes the bias of the model at hand.
    Unbiased,
    /// What the variance of photon counts says, as the renderer calibrates itself.
    Calibrated,
}

impl Constant {
    /// Every constant.
    pub const ALL: [Constant; 5] =
        [Self::K, Self::KMinusHalf, Self::KMinus1, Self::Unbiased, Self::Calibrated];

    /// As on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::K => "k",
            Self::KMinusHalf => "k-1/2",
            Self::KMinus1 => "k-1",
            Self::Unbiased => "unbiased",
            Self::Calibrated => "calibrated",
        }
    }

    /// The constant of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|constant| constant.name() == name)
    }

    /// How much less than k it is; none where that depends on the law of u_(k), or on a law of counts that is not known.
    fn reduction(self, k: u64, counts: Option<CountLaw>) -> Option<f64> {
        match self {
            Self::K => Some(0.0),
            Self::KMinusHalf => Some(0.5),
            Self::KMinus1 => Some(1.0),
            Self::Unbiased => None,
            Self::Calibrated => counts.map(|counts| k as f64 - counts.constant(k as f64)),
        }
    }

    /// c; none where it depends on a law that is not known.
    pub fn value(self, k: u64, law: Option<&Law>, counts: Option<CountLaw>) -> Option<f64> {
        match self {
            Self::Unbiased => law.map(Law::unbiased_constant),
            _ => self.reduction(k, counts).map(|reduction| k as f64 - reduction),
        }
    }

    /// The exact bias, c E\[1/u_(k)\] - 1; infinite where the mean is, none where c is not known.
    pub fn bias(self, k: u64, law: &Law, counts: Option<CountLaw>) -> Option<f64> {
        match self {
            Self::Unbiased => Some(0.0),
            _ => self.reduction(k, counts).map(|reduction| law.bias(reduction)),
        }
    }

    /// The exact variance, c^2 Var\[1/u_(k)\]; infinite where it does not exist, none where c is not known.
    pub fn variance(self, k: u64, law: &Law, counts: Option<CountLaw>) -> Option<f64> {
        let variance = law.variance();
        self.value(k, Some(law), counts).map(|c| match c {
            // Nothing times infinity: k = 1 with the divisor k - 1 is always 0.
            0.0 => 0.0,
            c => (c / k as f64).powi(2) * variance,
        })
    }
}
