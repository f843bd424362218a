//! The constant c of the estimator c / u_(k).

use super::model::Law;

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
}

impl Constant {
    /// Every constant.
    pub const ALL: [Constant; 4] = [Self::K, Self::KMinusHalf, Self::KMinus1, Self::Unbiased];

    /// As on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::K => "k",
            Self::KMinusHalf => "k-1/2",
            Self::KMinus1 => "k-1",
            Self::Unbiased => "unbiased",
        }
    }

    /// The constant of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|constant| constant.name() == name)
    }

    /// How much less than k it is, where that is the same for every model.
    fn reduction(self) -> Option<f64> {
        match self {
            Self::K => Some(0.0),
            Self::KMinusHalf => Some(0.5),
            Self::KMinus1 => Some(1.0),
            Self::Unbiased => None,
        }
    }

    /// c; none where it depends on a law that is not known.
    pub fn value(self, k: u64, law: Option<&Law>) -> Option<f64> {
        match self.reduction() {
            Some(reduction) => Some(k as f64 - reduction),
            None => law.map(Law::unbiased_constant),
        }
    }

    /// The exact bias, c E\[1/u_(k)\] - 1; infinite where the mean is.
    pub fn bias(self, law: &Law) -> f64 {
        match self.reduction() {
            Some(reduction) => law.bias(reduction),
            None => 0.0,
        }
    }

    /// The exact variance, c^2 Var\[1/u_(k)\]; infinite where it does not exist.
    pub fn variance(self, k: u64, law: &Law) -> f64 {
        let variance = law.variance();
        match self.value(k, Some(law)) {
            // Nothing times infinity: k = 1 with the divisor k - 1 is always 0.
            Some(0.0) => 0.0,
            Some(c) => (c / k as f64).powi(2) * variance,
            None => variance,
        }
    }
}
