//! Phase functions: the distribution of scattered light over directions, per steradian, with integral 1.

/// A phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// 1 / (4 pi).
    Isotropic,
    /// Henyey-Greenstein (1941), mean cosine g in (-1, 1), g > 0 forward.
    HenyeyGreenstein {
        /// Mean cosine of the scattering angle.
        g: f64,
    },
}
