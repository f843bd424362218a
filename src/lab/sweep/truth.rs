//! What images are held against, and how well it is known itself.

use super::error::SweepError;
use crate::film::{Film, FilmError, RgbImage};

/// An image, and the square of each pixel's standard error where it is known.
#[derive(Clone, Debug)]
pub struct KnownImage {
    /// Radiance \[W/(m^2 sr)\].
    pub image: RgbImage,
    /// Square of its standard error, of the same size.
    pub variance: Option<RgbImage>,
}

/// A reference as figures need it.
#[derive(Debug)]
pub(super) struct Truth {
    /// Red, green and blue, pixel by pixel.
    pub(super) channels: Vec<f64>,
    /// Mean of all.
    pub(super) mean: f64,
    /// Mean variance of a channel; 0 where it is not known.
    pub(super) variance: f64,
    /// Variance of the mean of all channels.
    pub(super) mean_variance: f64,
    /// Variance of the mean of squared errors, where these are normal.
    pub(super) square_variance: f64,
}

impl From<&Film> for KnownImage {
    /// The radiance of a film that knows its variance.
    fn from(film: &Film) -> Self {
        let variance = film.pixels.iter().map(|pixel| pixel.variance.as_vec3().to_array());
        let variance =
            RgbImage { width: film.width, height: film.height, pixels: variance.collect() };
        Self { image: film.into(), variance: Some(variance) }
    }
}

impl Truth {
    /// The reference of images of that width and height.
    ///
    /// # Errors
    /// It has another size, or no light.
    pub(super) fn new(known: &KnownImage, size: [usize; 2]) -> Result<Self, SweepError> {
        for image in [Some(&known.image), known.variance.as_ref()].into_iter().flatten() {
            let reference = [image.width, image.height];
            if reference != size {
                return Err(FilmError::SizeMismatch { image: size, reference }.into());
            }
        }
        let channels: Vec<f64> =
            known.image.pixels.iter().flatten().map(|&value| f64::from(value)).collect();
        let mean = channels.iter().sum::<f64>() / channels.len().max(1) as f64;
        if !mean.is_finite() || mean <= 0.0 {
            return Err(SweepError::BlackReference);
        }
        let pixels = known.image.pixels.len() as f64;
        let (mut variance, mut mean_variance, mut square_variance) = (0.0, 0.0, 0.0);
        for pixel in known.variance.iter().flat_map(|image| &image.pixels) {
            let pixel = pixel.map(|value| f64::from(value).max(0.0));
            let of_pixel = pixel.iter().sum::<f64>() / 3.0;
            variance += of_pixel / pixels;
            // The channels of a pixel come from the same paths: they err together.
            let deviation = pixel.iter().map(|value| value.sqrt()).sum::<f64>() / 3.0;
            mean_variance += (deviation / pixels).powi(2);
            square_variance += 2.0 * (of_pixel / pixels).powi(2);
        }
        Ok(Self { channels, mean, variance, mean_variance, square_variance })
    }
}
