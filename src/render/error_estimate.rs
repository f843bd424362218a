//! How far an image is from the truth, as its passes tell.
//!
//! Noise is the spread of the passes. Bias is that of interpolation in a lattice: it grows as the square of the
//! cells, so that light read from cells twice as long differs by three times the bias. The difference is taken, pass by pass, in
//! one pixel of sixteen; its mean square over pixels, less what its own noise adds, gives the bias.

use crate::film::Film;
use crate::math::mean_channel;

/// Pixels whose coordinates are both this modulo [`PROBE_STEP`] are probed.
const PROBE_OFFSET: usize = 1;

/// Pixels between two that are probed, along both axes.
const PROBE_STEP: usize = 4;

/// Whether a pixel is probed for bias.
pub fn is_probed(x: usize, y: usize) -> bool {
    x % PROBE_STEP == PROBE_OFFSET && y % PROBE_STEP == PROBE_OFFSET
}

/// The error of an image, as shares of its mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorEstimate {
    /// Root mean square of the noise: of all channels of all pixels.
    pub noise: f64,
    /// Root mean square of the bias, where it is known; else 0.
    pub bias: f64,
}

impl ErrorEstimate {
    /// Root mean square of both.
    pub fn total(&self) -> f64 {
        self.noise.hypot(self.bias)
    }
}

/// Differences between light from coarse and from fine cells, over passes.
#[derive(Clone, Debug, Default)]
pub struct BiasProbes {
    passes: f64,
    /// Sum and sum of squares a probed pixel.
    sums: Vec<[f64; 2]>,
}

impl BiasProbes {
    /// Adds a pass: what coarse cells add to each probed pixel's mean channel.
    pub fn add(&mut self, differences: &[f64]) {
        self.sums.resize(differences.len(), [0.0; 2]);
        for (sum, difference) in self.sums.iter_mut().zip(differences) {
            sum[0] += difference;
            sum[1] += difference * difference;
        }
        self.passes += 1.0;
    }

    /// Mean square of the bias of fine cells; `None` from fewer than two passes.
    fn mean_square(&self) -> Option<f64> {
        if self.passes < 2.0 || self.sums.is_empty() {
            return None;
        }
        let pixel = |&[sum, squares]: &[f64; 2]| {
            let mean = sum / self.passes;
            let variance = (squares / self.passes - mean * mean) / (self.passes - 1.0);
            mean * mean - variance
        };
        let difference = self.sums.iter().map(pixel).sum::<f64>() / self.sums.len() as f64;
        Some(difference.max(0.0) / 9.0)
    }

    /// The error of the mean of the passes; `None` from fewer than two.
    pub fn error(&self, film: &Film) -> Option<ErrorEstimate> {
        if self.passes < 2.0 {
            return None;
        }
        let count = film.pixels.len().max(1) as f64;
        let sum =
            |value: fn(&crate::film::Pixel) -> f64| film.pixels.iter().map(value).sum::<f64>();
        let mean = sum(|pixel| mean_channel(pixel.radiance())) / count;
        if mean <= 0.0 {
            return Some(ErrorEstimate::default());
        }
        let variance = sum(|pixel| mean_channel(pixel.variance)) / count;
        let bias = self.mean_square().unwrap_or(0.0);
        Some(ErrorEstimate { noise: variance.sqrt() / mean, bias: bias.sqrt() / mean })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Rgb, Stream, uniform};

    /// Passes of known noise and known differences: the estimate finds both.
    #[test]
    fn noise_and_bias_are_told_apart() {
        let (width, height, passes) = (64, 64, 8);
        let mut random = Stream::Experiment.random(11, 0);
        let (mut film, mut probes) = (Film::new(width, height), BiasProbes::default());
        for pass in 0..passes {
            let mut one = Film::new(width, height);
            for pixel in &mut one.pixels {
                pixel.multiple_scatter = Rgb::splat(2.0 + 0.4 * (uniform(&mut random) - 0.5));
            }
            film.average_in(&one, pass);
            // Coarse cells are off by 0.3 up or down, so fine ones by a third of that; with noise.
            let differences: Vec<f64> = (0..256)
                .map(|index| {
                    let sign = if index % 2 == 0 { 0.3 } else { -0.3 };
                    sign + 2.0 * (uniform(&mut random) - 0.5)
                })
                .collect();
            probes.add(&differences);
        }
        let error = probes.error(&film).unwrap();
        let noise = 0.4 / 12f64.sqrt() / 8f64.sqrt() / 2.0;
        assert!((error.noise / noise - 1.0).abs() < 0.03, "{error:?} {noise}");
        assert!((error.bias / 0.05 - 1.0).abs() < 0.15, "{error:?}");
        assert!((error.total() - error.noise.hypot(error.bias)).abs() < 1e-15);
    }

    #[test]
    fn one_pass_knows_nothing_and_black_has_no_error() {
        let mut probes = BiasProbes::default();
        let film = Film::new(4, 4);
        assert_eq!(probes.error(&film), None);
        probes.add(&[]);
        assert_eq!(probes.error(&film), None);
        probes.add(&[]);
        assert_eq!(probes.error(&film), Some(ErrorEstimate::default()));
    }
}
