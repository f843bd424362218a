//! How far an image is from its reference.

use super::{FilmError, RgbImage};

/// Edge of the blocks of [`ImageError::block_rel_rms`] \[pixels\].
const BLOCK_SIZE: usize = 16;

/// The difference of an image from its reference, over all pixels and the channels R, G and B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageError {
    /// Mean of the image / mean of the reference: 1 if there is no overall bias.
    pub mean_ratio: f64,
    /// Root of the mean squared difference / mean of the reference.
    pub rel_rmse: f64,
    /// The same after both images are averaged over blocks of 16 x 16 pixels: noise averages out, blur
    /// and local bias remain.
    pub block_rel_rms: f64,
}

/// Measures `image` against `reference`. Against a black reference the figures are 1, 0 and 0 for a
/// black image and infinite otherwise.
///
/// # Errors
/// [`FilmError::SizeMismatch`].
pub fn compare(image: &RgbImage, reference: &RgbImage) -> Result<ImageError, FilmError> {
    let sizes = [[image.width, image.height], [reference.width, reference.height]];
    if sizes[0] != sizes[1] {
        return Err(FilmError::SizeMismatch { image: sizes[0], reference: sizes[1] });
    }
    let blocks = [block_means(image), block_means(reference)];
    let reference_mean = mean(&reference.pixels);
    Ok(ImageError {
        mean_ratio: relative(mean(&image.pixels), reference_mean, 1.0),
        rel_rmse: relative(rms_difference(&image.pixels, &reference.pixels), reference_mean, 0.0),
        block_rel_rms: relative(rms_difference(&blocks[0], &blocks[1]), reference_mean, 0.0),
    })
}

/// `value / base`, where 0 / 0 is `if_both_zero`.
fn relative(value: f64, base: f64, if_both_zero: f64) -> f64 {
    if value == 0.0 && base == 0.0 { if_both_zero } else { value / base }
}

fn mean<T: Copy + Into<f64>>(pixels: &[[T; 3]]) -> f64 {
    let sum: f64 = pixels.iter().flatten().map(|&value| value.into()).sum();
    sum / (3 * pixels.len()).max(1) as f64
}

fn rms_difference<T: Copy + Into<f64>>(image: &[[T; 3]], reference: &[[T; 3]]) -> f64 {
    let squares = image.iter().flatten().zip(reference.iter().flatten()).map(|(&a, &b)| {
        let difference: f64 = a.into() - b.into();
        difference * difference
    });
    (squares.sum::<f64>() / (3 * image.len()).max(1) as f64).sqrt()
}

/// Mean colour of each block; blocks at the right and lower edge may be smaller.
fn block_means(image: &RgbImage) -> Vec<[f64; 3]> {
    let columns = image.width.div_ceil(BLOCK_SIZE);
    let rows = image.height.div_ceil(BLOCK_SIZE);
    let mut sums = vec![([0.0; 3], 0.0); columns * rows];
    for (index, pixel) in image.pixels.iter().enumerate() {
        let (row, column) = (index / image.width, index % image.width);
        let (sum, count) = &mut sums[row / BLOCK_SIZE * columns + column / BLOCK_SIZE];
        for (channel, &value) in sum.iter_mut().zip(pixel) {
            *channel += f64::from(value);
        }
        *count += 1.0;
    }
    sums.iter().map(|(sum, count)| sum.map(|channel| channel / count)).collect()
}
