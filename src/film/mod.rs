//! The film: layers of an image, and their files.

use crate::math::Rgb;

/// The layers of one image, one value a pixel, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// \[pixels\]
    pub width: usize,
    /// \[pixels\]
    pub height: usize,
    /// Row-major pixels.
    pub pixels: Vec<Pixel>,
}

/// All layers of one pixel. Radiance is their sum: single + multiple scattering + emission.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Light scattered once \[W/(m^2 sr)\].
    pub single_scatter: Rgb,
    /// Light scattered twice or more.
    pub multiple_scatter: Rgb,
    /// Light that comes unscattered: background, area lights and the medium's own, through the medium.
    pub emission: Rgb,
    /// Share of background light that passes the medium.
    pub transmittance: Rgb,
    /// Mean number of photons found a query.
    pub photon_count: f64,
    /// Mean kernel radius of the queries \[m\].
    pub kernel_radius: f64,
}
