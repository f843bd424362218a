//! Homogeneous media: analytic free flights and transmittance.

use crate::math::Rgb;

/// The same sigma_t everywhere and in every channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformExtinction {
    /// \[1/m\]
    pub sigma_t: f64,
}

/// The same sigma_t everywhere, one a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChromaticExtinction {
    /// \[1/m\] per channel.
    pub sigma_t: Rgb,
}
