//! Images of a scene by each way of emission, against a reference.

use super::error::SceneComparisonError;
use super::points::prepare;
use super::request::SceneComparison;
use crate::emission::EmissionKind;
use crate::film::RgbImage;
use crate::lab::experiment::Moments;
use crate::math::Stream;
use crate::render::{RenderOptions, Unobserved, render};
use crate::scene::Scene;

/// Most channels of all pixels of all runs of a way of emission: 4 bytes each.
const MOST_CHANNELS: u128 = 250_000_000;

/// Renders of the reference are fewer than runs by this factor, with more photons each.
const REFERENCE_SHARE: u64 = 4;

/// Pixels darker than this share of the mean count as if they had that light: their errors hardly show.
const DARK: f64 = 0.1;

/// Images of one scene and size, whose mean is known or sought.
pub(super) struct ImageSample {
    images: Vec<Vec<f32>>,
    mean: Vec<f64>,
}

/// What images are held against.
pub(super) struct ReferenceImage {
    channels: Vec<f64>,
    /// 1 / the light of each channel's pixel.
    scales: Vec<f64>,
    /// The same for every channel: 1 / mean of all.
    mean_scales: Vec<f64>,
    /// Mean of all channels.
    mean: f64,
    /// Renders it is the mean of; 0 of a given image, whose errors are not known.
    pub(super) runs: u64,
    /// Standard error of its mean, relative.
    pub(super) std_error: f64,
    /// Variance of its pixels, relative to their light squared.
    variance: f64,
    /// The same relative to its mean squared.
    mean_variance: f64,
}

/// What the runs of one way of emission say.
#[derive(Clone, Copy, Debug)]
pub(super) struct ImageFigures {
    /// Mean of all pixels over that of the reference - 1, over runs.
    pub(super) bias: Moments,
    /// Variance of a pixel relative to its light, a figure a run.
    pub(super) variance: Moments,
    /// Mean squared difference of a pixel from the reference, relative to its light.
    pub(super) squared_error: f64,
    /// The same relative to the light of all pixels.
    pub(super) mean_squared_error: f64,
    /// Mean squared difference of the mean image from the reference, relative to each pixel's light.
    pub(super) local_bias_squared: f64,
}

/// What all renders say.
pub(super) struct PixelSamples {
    pub(super) reference: ReferenceImage,
    /// Of each way of emission.
    pub(super) figures: Vec<ImageFigures>,
    /// Processor time of a render, of each way \[s\].
    pub(super) seconds: Vec<Option<f64>>,
}

/// Fails where the images of one way of emission would not fit into memory.
pub(super) fn check(
    request: &SceneComparison,
    size: [usize; 2],
) -> Result<(), SceneComparisonError> {
    let channels = 3 * size[0] as u128 * size[1] as u128;
    let values = channels * u128::from(request.runs);
    if values > MOST_CHANNELS {
        return Err(SceneComparisonError::TooMuch {
            what: "pixels",
            values,
            limit: MOST_CHANNELS,
            flags: "--pixels or --runs",
        });
    }
    Ok(())
}

/// The mean of renders with more photons.
pub(super) fn make_reference(
    request: &SceneComparison,
    scene: &mut Scene,
    advanced: &mut impl FnMut(),
) -> Result<ReferenceImage, SceneComparisonError> {
    scene.photons.count = request.reference_photons;
    let (kind, runs) = (EmissionKind::Stratified, request.reference_runs());
    let seed = Stream::Experiment.hash(request.seed, 100);
    ReferenceImage::mean_of(&ImageSample::render(scene, kind, seed, runs, advanced)?)
}

/// Renders `runs` images of each way of emission and holds them against the reference.
pub(super) fn measure(
    request: &SceneComparison,
    scene: &mut Scene,
    reference: ReferenceImage,
    processor_seconds: &impl Fn() -> Option<f64>,
    advanced: &mut impl FnMut(),
) -> Result<PixelSamples, SceneComparisonError> {
    scene.photons.count = request.n;
    let (mut figures, mut seconds) = (Vec::new(), Vec::new());
    for &kind in &request.emissions {
        let started = processor_seconds();
        let seed = Stream::Experiment.hash(request.seed, 101 + kind as u64);
        let images = ImageSample::render(scene, kind, seed, request.runs, advanced)?;
        let spent = started.zip(processor_seconds()).map(|(start, end)| end - start);
        seconds.push(spent.map(|spent| spent / request.runs as f64));
        figures.push(images.against(&reference));
    }
    Ok(PixelSamples { reference, figures, seconds })
}

/// Renders of the reference of so many runs.
pub(super) fn reference_runs(runs: u64) -> u64 {
    runs.div_ceil(REFERENCE_SHARE).max(2)
}

impl ImageSample {
    fn render(
        scene: &mut Scene,
        kind: EmissionKind,
        seed: u64,
        runs: u64,
        advanced: &mut impl FnMut(),
    ) -> Result<Self, SceneComparisonError> {
        let mut images = Vec::new();
        for run in 0..runs {
            prepare(scene, kind, Stream::Experiment.hash(seed, run));
            let rendering = render(scene, &RenderOptions::passes(1), &Unobserved)?;
            images.push(RgbImage::from(&rendering.film).pixels.into_flattened());
            advanced();
        }
        Ok(Self::of(images))
    }

    fn of(images: Vec<Vec<f32>>) -> Self {
        let mut mean = vec![0.0; images.first().map_or(0, Vec::len)];
        for image in &images {
            let share = 1.0 / images.len() as f64;
            mean.iter_mut().zip(image).for_each(|(sum, &value)| *sum += share * f64::from(value));
        }
        Self { images, mean }
    }

    /// Mean of an image, run by run.
    fn over_runs(&self, figure: impl Fn(&[f32]) -> f64) -> Moments {
        let mut moments = Moments::default();
        self.images.iter().for_each(|image| moments.add(figure(image)));
        moments
    }

    fn against(&self, reference: &ReferenceImage) -> ImageFigures {
        let ReferenceImage { channels, scales, mean_scales, mean, .. } = reference;
        let runs = self.images.len() as f64;
        let bias = self.over_runs(|image| mean_f32(image) / mean - 1.0);
        let variance = self.variance(scales);
        let squared_error = |scales: &[f64]| {
            self.over_runs(|image| mean_square(differences(image, channels), scales)).bias()
        };
        let local = self.mean.iter().zip(channels).map(|(a, b)| a - b);
        let local = mean_square(local, scales);
        // What chance adds to all of them is known and taken off.
        let noise = reference.noise();
        let mean_noise = reference.share_of_runs(reference.mean_variance);
        ImageFigures {
            bias,
            variance,
            squared_error: (squared_error(scales) - noise).max(0.0),
            mean_squared_error: (squared_error(mean_scales) - mean_noise).max(0.0),
            local_bias_squared: (local - variance.bias() / runs - noise).max(0.0),
        }
    }

    /// Variance of a pixel over runs, a figure a run whose mean has no bias.
    fn variance(&self, scales: &[f64]) -> Moments {
        let runs = self.images.len() as f64;
        let correction = runs / (runs - 1.0);
        self.over_runs(|image| correction * mean_square(differences(image, &self.mean), scales))
    }
}

impl ReferenceImage {
    /// A given image of the size rendered, or of a multiple of it, whose pixels are averaged.
    ///
    /// # Errors
    /// It is no multiple, or black.
    pub(super) fn given(image: &RgbImage, size: [usize; 2]) -> Result<Self, SceneComparisonError> {
        let [width, height] = size;
        let step = image.width / width.max(1);
        if [width * step, height * step] != [image.width, image.height] || width * step == 0 {
            let reference = [image.width, image.height];
            return Err(SceneComparisonError::ReferenceSize { reference, image: size });
        }
        let mut channels = vec![0.0; 3 * width * height];
        let share = 1.0 / (step * step) as f64;
        for (index, pixel) in image.pixels.iter().enumerate() {
            let (x, y) = (index % image.width / step, index / image.width / step);
            let sums = &mut channels[3 * (y * width + x)..][..3];
            sums.iter_mut().zip(pixel).for_each(|(sum, &value)| *sum += share * f64::from(value));
        }
        Self::of(channels)
    }

    /// An image without errors.
    fn of(channels: Vec<f64>) -> Result<Self, SceneComparisonError> {
        let mean = channels.iter().sum::<f64>() / channels.len() as f64;
        if !mean.is_finite() || mean <= 0.0 {
            return Err(SceneComparisonError::BlackReference);
        }
        let light = |pixel: &[f64]| pixel.iter().sum::<f64>() / pixel.len() as f64;
        let scale = |pixel: &[f64]| 1.0 / light(pixel).max(DARK * mean);
        let scales = channels.chunks(3).flat_map(|pixel| [scale(pixel); 3]).collect();
        let mean_scales = vec![1.0 / mean; channels.len()];
        let (variance, mean_variance) = (0.0, 0.0);
        Ok(Self {
            channels,
            scales,
            mean_scales,
            mean,
            runs: 0,
            std_error: 0.0,
            variance,
            mean_variance,
        })
    }

    fn mean_of(images: &ImageSample) -> Result<Self, SceneComparisonError> {
        let mut reference = Self::of(images.mean.clone())?;
        let mean = reference.mean;
        reference.runs = images.images.len() as u64;
        reference.std_error = images.over_runs(|image| mean_f32(image) / mean - 1.0).std_error();
        reference.variance = images.variance(&reference.scales).bias();
        reference.mean_variance = images.variance(&reference.mean_scales).bias();
        Ok(reference)
    }

    /// Variance of its pixels as a mean of runs, relative to their light.
    pub(super) fn noise(&self) -> f64 {
        self.share_of_runs(self.variance)
    }

    fn share_of_runs(&self, variance: f64) -> f64 {
        if self.runs == 0 { 0.0 } else { variance / self.runs as f64 }
    }
}

fn mean_f32(image: &[f32]) -> f64 {
    image.iter().map(|&value| f64::from(value)).sum::<f64>() / image.len() as f64
}

fn differences(image: &[f32], from: &[f64]) -> impl Iterator<Item = f64> {
    image.iter().zip(from).map(|(&a, b)| f64::from(a) - b)
}

/// Mean of the squares of values times their scales.
fn mean_square(values: impl Iterator<Item = f64>, scales: &[f64]) -> f64 {
    let squares = values.zip(scales).map(|(value, scale)| (value * scale).powi(2));
    squares.sum::<f64>() / scales.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_are_averaged_to_the_size_compared() {
        let pixels = (0..8).map(|i| [i as f32, 0.0, 1.0]).collect();
        let image = RgbImage { width: 4, height: 2, pixels };
        let reference = ReferenceImage::given(&image, [2, 1]).unwrap();
        assert_eq!(reference.channels, [2.5, 0.0, 1.0, 4.5, 0.0, 1.0]);
        assert_eq!(reference.mean, 1.5);
        for size in [[2, 2], [3, 1], [8, 4], [0, 0]] {
            assert!(ReferenceImage::given(&image, size).is_err(), "{size:?}");
        }
    }

    /// Two runs of two pixels, by hand.
    #[test]
    fn figures_are_bias_variance_and_squared_error() {
        let runs = vec![vec![1.0, 1.0, 1.0, 3.0, 3.0, 3.0], vec![3.0, 3.0, 3.0, 3.0, 3.0, 3.0]];
        let images = ImageSample::of(runs);
        let pixels = vec![[2.0; 3], [2.0; 3]];
        let image = RgbImage { width: 2, height: 1, pixels };
        let reference = ReferenceImage::given(&image, [2, 1]).unwrap();
        let figures = images.against(&reference);
        assert_eq!(figures.bias.bias(), 0.25);
        // Pixel 0: variance 2, pixel 1: 0; over 2^2.
        assert_eq!(figures.variance.bias(), 0.25);
        assert_eq!(figures.squared_error, 0.25);
        // Squared and over 2^2, pixel 1 is off by 1/4 and pixel 0 by 0: 1/8 in the mean, which chance explains, 1/4 over 2 runs.
        assert_eq!(figures.local_bias_squared, 0.0);
    }
}
