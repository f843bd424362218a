//! The optical depth along one ray as a function of distance.
//!
//! A renderer asks the same ray many times for its transmittance, and wants points on it that are
//! equally spaced in transmittance. Uniform media answer in closed form; grids tabulate one knot a voxel
//! cell that the ray crosses.

use crate::math::{Rgb, Span};

/// The optical depth of one ray over one span. Reused from ray to ray: it keeps its allocation.
#[derive(Debug, Default)]
pub struct RayProfile {
    span: Option<Span>,
    uniform: Rgb,
    knots: Vec<ProfileKnot>,
}

/// The end of one piece of the ray. Within the piece sigma_t is the quadratic through its three values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileKnot {
    /// Distance at which the piece ends \[m\].
    pub distance: f64,
    /// Optical depth from the span's start to `distance`.
    pub optical_depth: f64,
    /// sigma_t at the piece's start, middle and end \[1/m\].
    pub sigma_t: [f64; 3],
}

impl RayProfile {
    /// placeholder until merge
    pub fn set_uniform(&mut self, span: Span, sigma_t: Rgb) {
        self.span = Some(span);
        self.uniform = sigma_t;
        self.knots.clear();
    }
}
