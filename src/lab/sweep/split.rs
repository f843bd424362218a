//! The error of images of one setting, split into bias and noise.

use super::truth::Truth;
use crate::lab::compare::student_quantile;
use crate::lab::experiment::Moments;

/// The error of one image, and its parts: error^2 = bias^2 + noise^2. Relative to the mean of the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorSplit {
    /// Root mean squared error of all pixels and channels, the reference's own noise taken off; at least the noise.
    pub error: f64,
    /// Its standard error, from how runs differ.
    pub error_std_error: f64,
    /// Root mean squared error of the mean of infinitely many runs; 0 where chance explains all there is.
    pub bias: f64,
    /// The largest bias that is credible: upper end of the two-sided interval of 95 %; `None` of fewer than 3 runs.
    pub bias_high: Option<f64>,
    /// Standard deviation of a pixel, root mean square over all.
    pub noise: f64,
    /// Mean of all pixels over that of the reference, less 1.
    pub mean_bias: f64,
    /// Its standard error, by the runs and the reference.
    pub mean_bias_std_error: f64,
}

impl ErrorSplit {
    /// Of images of the same size as the truth, at least 2.
    pub(super) fn of(images: &[Vec<f32>], truth: &Truth) -> Self {
        let count = truth.channels.len() as f64;
        let (mut means, mut squares) = (Moments::default(), Moments::default());
        for image in images {
            let differences =
                image.iter().zip(&truth.channels).map(|(&a, b)| (f64::from(a) - b) / truth.mean);
            let (sum, square) =
                differences.fold((0.0, 0.0), |(sum, square), d| (sum + d, square + d * d));
            means.add(sum / count);
            squares.add(square / count);
        }
        let scale = truth.mean * truth.mean;
        let sums = Sums::of(images, truth);
        let (bias_squared, noise_squared) = sums.bias_and_noise(None);
        // No less than the noise, which needs no reference: one too noisy itself makes nothing look perfect.
        let error = (bias_squared.max(0.0) + noise_squared).sqrt();
        Self {
            error,
            error_std_error: if error > 0.0 { squares.std_error() / (2.0 * error) } else { 0.0 },
            bias: bias_squared.max(0.0).sqrt(),
            bias_high: sums.bias_std_error().map(|std_error| {
                let quantile = student_quantile(images.len() as f64 - 1.0);
                (bias_squared.max(0.0) + quantile * std_error).sqrt()
            }),
            noise: noise_squared.sqrt(),
            mean_bias: means.bias(),
            mean_bias_std_error: means.std_error().hypot((truth.mean_variance / scale).sqrt()),
        }
    }
}

/// Sums over runs, a channel each, of what images differ from the truth.
struct Sums<'a> {
    images: &'a [Vec<f32>],
    truth: &'a Truth,
    first: Vec<f64>,
    second: Vec<f64>,
}

impl<'a> Sums<'a> {
    fn of(images: &'a [Vec<f32>], truth: &'a Truth) -> Self {
        let mut first = vec![0.0; truth.channels.len()];
        let mut second = first.clone();
        for image in images {
            let differences = image.iter().zip(&truth.channels).map(|(&a, b)| f64::from(a) - b);
            for ((sum, square), difference) in first.iter_mut().zip(&mut second).zip(differences) {
                *sum += difference;
                *square += difference * difference;
            }
        }
        Self { images, truth, first, second }
    }

    /// Squared bias, which chance may make negative, and variance, of all runs but one.
    fn bias_and_noise(&self, left_out: Option<&[f32]>) -> (f64, f64) {
        let runs = self.images.len() as f64 - if left_out.is_some() { 1.0 } else { 0.0 };
        let (mut bias, mut noise) = (0.0, 0.0);
        for (index, (&sum, &square)) in self.first.iter().zip(&self.second).enumerate() {
            let out =
                left_out.map_or(0.0, |image| f64::from(image[index]) - self.truth.channels[index]);
            let (mean, square) = ((sum - out) / runs, square - out * out);
            let variance = ((square - runs * mean * mean) / (runs - 1.0)).max(0.0);
            bias += mean * mean - variance / runs;
            noise += variance;
        }
        let count = self.first.len() as f64;
        let scale = self.truth.mean * self.truth.mean;
        ((bias / count - self.truth.variance) / scale, noise / count / scale)
    }

    /// Standard error of the squared bias: of runs by the jackknife, and of the reference, whose errors add to it by their
    /// squares and by their product with the bias.
    fn bias_std_error(&self) -> Option<f64> {
        if self.images.len() < 3 {
            return None;
        }
        let mut without = Moments::default();
        for image in self.images {
            without.add(self.bias_and_noise(Some(image)).0);
        }
        let runs = self.images.len() as f64;
        let of_runs = (runs - 1.0).powi(2) / runs * without.variance();
        let truth = self.truth;
        let scale = truth.mean * truth.mean;
        let bias_squared = self.bias_and_noise(None).0.max(0.0);
        let pixels = self.first.len() as f64 / 3.0;
        let product = 4.0 * bias_squared * truth.variance / scale / pixels;
        Some((of_runs + truth.square_variance / (scale * scale) + product).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::RgbImage;
    use crate::lab::sweep::truth::KnownImage;
    use crate::math::{Stream, uniform};

    const SIDE: usize = 64;

    /// Standard deviation 1, bounded.
    fn noise(random: &mut crate::math::Random) -> f64 {
        12f64.sqrt() * (uniform(random) - 0.5)
    }

    fn image(pixel: impl FnMut(usize) -> f64) -> RgbImage {
        let pixels = (0..SIDE * SIDE).map(pixel).map(|value| [value as f32; 3]).collect();
        RgbImage { width: SIDE, height: SIDE, pixels }
    }

    /// A light of 2 a pixel in the mean, known to `reference`; images with a bias of `local` up and down and `mean` all over.
    fn split(runs: u64, seed: u64, [local, mean, sd, reference]: [f64; 4]) -> ErrorSplit {
        let truth = |index: usize| if index % 4 < 2 { 1.0 } else { 3.0 };
        let mut random = Stream::Experiment.random(seed, 0);
        let known = KnownImage {
            image: image(|index| truth(index) + reference * noise(&mut random)),
            variance: (reference > 0.0).then(|| image(|_| reference * reference)),
        };
        let bias = |index: usize| mean + if index.is_multiple_of(2) { local } else { -local };
        let images: Vec<Vec<f32>> = (1..=runs)
            .map(|run| {
                let mut random = Stream::Experiment.random(seed, run);
                let made = image(|index| truth(index) + bias(index) + sd * noise(&mut random));
                made.pixels.into_flattened()
            })
            .collect();
        ErrorSplit::of(&images, &Truth::new(&known, [SIDE; 2]).unwrap())
    }

    /// Of 4096 independent pixels, figures are known to about 2 %.
    #[test]
    fn bias_and_noise_are_told_apart() {
        for (runs, reference) in [(2, 0.0), (3, 0.1), (8, 0.4)] {
            let found = split(runs, 5, [0.3, 0.1, 0.4, reference]);
            // All relative to a mean of 2.
            let bias = 0.3f64.hypot(0.1) / 2.0;
            let is_near = |value: f64, truth: f64| (value / truth - 1.0).abs() < 0.05;
            assert!(is_near(found.bias, bias), "{runs} {found:?}");
            assert!(is_near(found.noise, 0.2), "{runs} {found:?}");
            assert!(is_near(found.error, bias.hypot(0.2)), "{runs} {found:?}");
            assert!((found.error - found.bias.hypot(found.noise)).abs() < 1e-6, "{found:?}");
            // The sign of the image's mean, with an error that the reference takes part in.
            let z = (found.mean_bias - 0.05) / found.mean_bias_std_error;
            assert!(z.abs() < 4.5 && found.mean_bias_std_error < 0.01, "{runs} {found:?}");
            assert_eq!(found.bias_high.is_some(), runs > 2);
            assert!(found.bias_high.is_none_or(|high| high > found.bias && high < 0.19));
        }
        assert!(split(4, 5, [0.0, -0.1, 0.4, 0.1]).mean_bias < -0.03);
    }

    /// Chance alone makes no bias: its square is 0 in the mean, and the interval covers 0.
    #[test]
    fn noise_alone_is_not_taken_for_bias() {
        let splits: Vec<_> = (0..32).map(|seed| split(3, seed, [0.0, 0.0, 0.4, 0.2])).collect();
        let zeros = splits.iter().filter(|split| split.bias == 0.0).count();
        assert!((6..=26).contains(&zeros), "{zeros}");
        for split in splits {
            // The noise of a mean of three is 0.115; of 4096 pixels a share of 1/8 is left.
            assert!(split.bias < 0.04 && split.bias_high.is_some_and(|high| high > 0.0));
            assert!((split.error / 0.2 - 1.0).abs() < 0.05, "{split:?}");
        }
    }

    #[test]
    fn exact_images_have_no_error() {
        let found = split(3, 1, [0.0; 4]);
        let none = ErrorSplit {
            error: 0.0,
            error_std_error: 0.0,
            bias: 0.0,
            bias_high: Some(0.0),
            noise: 0.0,
            mean_bias: 0.0,
            mean_bias_std_error: 0.0,
        };
        assert_eq!(found, none);
    }
}
