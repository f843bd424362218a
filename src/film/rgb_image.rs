//! A plain image: linear RGB in 32-bit floats.

use super::Film;

/// Linear RGB pixels, row-major, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct RgbImage {
    /// \[pixels\]
    pub width: usize,
    /// \[pixels\]
    pub height: usize,
    /// `width * height` pixels.
    pub pixels: Vec<[f32; 3]>,
}

impl From<&Film> for RgbImage {
    /// The radiance of the film, as the channels R, G and B of its EXR hold it.
    fn from(film: &Film) -> Self {
        let pixels = film.pixels.iter().map(|pixel| pixel.radiance().as_vec3().to_array());
        Self { width: film.width, height: film.height, pixels: pixels.collect() }
    }
}
