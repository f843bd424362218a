//! The film: layers of an image, and their files.
//!
//! A [`Film`] holds what a render measures: per pixel the radiance by origin, the transmittance, and how
//! the estimate was made. [`write_exr`] stores it in linear 32-bit floats with the settings that repeat
//! the render, [`write_preview_png`] makes a tone-mapped picture for a quick look, [`read_rgb`] reads
//! any ordinary EXR back, and [`compare`] measures two images against each other.

mod average;
mod beside;
mod compare;
mod error;
mod exr_description;
mod exr_limits;
mod exr_read;
mod exr_write;
mod layer_array;
mod layers;
mod metadata;
mod pixel_depths;
mod preview;
mod rgb_image;

pub use beside::{check_writable, write_beside};
pub use compare::{ImageError, compare};
pub use error::FilmError;
pub use exr_description::{ExrDescription, ExrPart, describe_exr};
pub use exr_limits::MAX_PIXEL_COUNT;
pub use exr_read::{read_rgb, read_variance};
pub use exr_write::write_exr;
pub use layer_array::{LayerArray, layer_arrays};
pub use layers::ExrOptions;
pub use metadata::RenderMetadata;
pub use pixel_depths::PixelDepths;
pub use preview::{tone_mapped, write_preview_png};
pub use rgb_image::RgbImage;

use crate::math::{Rgb, mean_channel};

/// The layers of one image, one value a pixel, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// \[pixels\]
    pub width: usize,
    /// \[pixels\]
    pub height: usize,
    /// Row-major pixels.
    pub pixels: Vec<Pixel>,
    /// How deep each of them looks, where it is asked for.
    pub depths: Option<Vec<PixelDepths>>,
    /// The image of each light, where it is asked for: their sum is the radiance of the pixels.
    pub lights: Vec<LightLayer>,
}

/// The image of one light, or of several of one name.
#[derive(Clone, Debug, PartialEq)]
pub struct LightLayer {
    /// Letters, digits, `_` and `-`.
    pub name: String,
    /// Light of it, scattered or not, a pixel \[W/(m^2 sr)\].
    pub radiance: Vec<Rgb>,
}

impl Film {
    /// A black film of `width` x `height` pixels.
    pub fn new(width: usize, height: usize) -> Self {
        let pixels = vec![Pixel::default(); width * height];
        Self { width, height, pixels, depths: None, lights: Vec::new() }
    }

    /// The same with depths.
    pub fn with_depths(mut self) -> Self {
        self.depths = Some(vec![PixelDepths::default(); self.pixels.len()]);
        self
    }

    /// The same with a layer for each light of those names.
    pub fn with_lights(mut self, names: &[String]) -> Self {
        let layer = |name: &String| LightLayer {
            name: name.clone(),
            radiance: vec![Rgb::ZERO; self.pixels.len()],
        };
        self.lights = names.iter().map(layer).collect();
        self
    }

    /// Makes the film black.
    pub fn clear(&mut self) {
        self.pixels.fill(Pixel::default());
        self.depths.iter_mut().for_each(|depths| depths.fill(PixelDepths::default()));
        self.lights.iter_mut().for_each(|light| light.radiance.fill(Rgb::ZERO));
    }
}

/// All layers of one pixel. Radiance is their sum: single + multiple scattering + emission.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Light of lights, scattered once \[W/(m^2 sr)\].
    pub single_scatter: Rgb,
    /// Light scattered twice or more; of the medium's own light, all that is scattered.
    pub multiple_scatter: Rgb,
    /// Light that comes unscattered: background, area lights and the medium's own, through the medium.
    pub emission: Rgb,
    /// Share of background light that passes the medium.
    pub transmittance: Rgb,
    /// Mean number of photons found a query.
    pub photon_count: f64,
    /// Mean kernel radius of the queries \[m\].
    pub kernel_radius: f64,
    /// Square of the radiance's standard error, where it is known.
    pub variance: Rgb,
    /// Paths behind the pixel, where it is made of independent ones.
    pub sample_count: f64,
}

impl Pixel {
    /// All light that reaches the pixel \[W/(m^2 sr)\]: single + multiple scattering + emission.
    pub fn radiance(&self) -> Rgb {
        self.single_scatter + self.multiple_scatter + self.emission
    }

    /// Coverage by the medium: 1 - mean transmittance of the channels.
    pub fn alpha(&self) -> f64 {
        1.0 - mean_channel(self.transmittance)
    }
}
