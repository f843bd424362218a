//! Estimates from the photon map.

/// The numerator of the k-nearest estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Divisor {
    /// All k photons: too high by 1/(k-1) in a random map.
    K,
    /// Leaves out the k-th photon: unbiased in a random map.
    KMinus1,
    /// Half of the k-th photon.
    KMinusHalf,
}

/// The weight of a photon by its distance from the query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// The same within the ball.
    Constant,
    /// Falls as 1 - (r / r_k)^2.
    Epanechnikov,
}
