//! Radiance from all around: constant, or a latitude-longitude image.

use crate::math::Rgb;

/// Radiance from all around \[W/(m^2 sr)\].
#[derive(Debug)]
pub enum Environment {
    /// The same from everywhere.
    Constant(Rgb),
    /// From a latitude-longitude image.
    Image(Box<EnvironmentImage>),
}

/// A latitude-longitude image: row 0 is straight up (+y), the middle of a row looks along -z, and
/// columns run towards +x (to the right when looking along -z with +y up).
#[derive(Debug)]
pub struct EnvironmentImage {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row-major linear RGB radiance, already scaled.
    pub pixels: Vec<[f32; 3]>,
    /// Turns the image about +y, counter-clockwise seen from above \[rad\].
    pub rotation: f64,
}

impl EnvironmentImage {
    /// Prepares an image for evaluation and sampling. `pixels` holds `width * height` finite, non-negative values.
    pub fn new(width: usize, height: usize, pixels: Vec<[f32; 3]>, rotation: f64) -> Self {
        Self { width, height, pixels, rotation }
    }
}
