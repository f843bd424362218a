//! The weight of a photon by its distance from the query.

use crate::medium::BallIntegral;

/// The weight of a photon by its distance from the query.
///
/// The Epanechnikov kernel gives the k-th photon no weight, so every divisor reads the same with it, and the
/// estimate is unbiased in a random map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// The same within the ball.
    Constant,
    /// Falls as 1 - (r / r_k)^2 (Epanechnikov 1969).
    Epanechnikov,
}

impl Kernel {
    /// The factor on (r / r_k)^2 that the weight falls by.
    pub fn falloff(self) -> f64 {
        match self {
            Self::Constant => 0.0,
            Self::Epanechnikov => 1.0,
        }
    }

    /// The weight at a squared distance relative to the squared radius.
    #[inline]
    pub fn weight(self, relative_squared: f64) -> f64 {
        match self {
            Self::Constant => 1.0,
            Self::Epanechnikov => (1.0 - relative_squared).max(0.0),
        }
    }

    /// The kernel's integral over the part of the ball inside the medium.
    pub fn mass(self, ball: BallIntegral) -> f64 {
        match self {
            Self::Constant => ball.mass,
            Self::Epanechnikov => ball.mass - ball.second_moment,
        }
    }

    /// As in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Epanechnikov => "epanechnikov",
        }
    }
}
