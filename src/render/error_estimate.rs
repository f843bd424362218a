//! How far an image is from the truth, as its passes tell.
//!
//! Noise is how the means of even and of odd passes differ, which place their rays independently of each other: within a half, rays of
//! one pass lie between those of the last, and the spread of single passes would overrate the noise of their mean. Bias is that of interpolation in a lattice: it grows as the square of the
//! cells, so that light read from cells twice as long differs by three times the bias. The difference is taken, pass by pass, in
//! one pixel of sixteen; its mean square over pixels, less what its own noise adds, gives the bias.

use serde::Serialize;

use crate::film::Film;
use crate::math::{Rgb, mean_channel};
use crate::render::regression::Halves;

/// Pixels whose coordinates are both this modulo [`PROBE_STEP`] are probed.
const PROBE_OFFSET: usize = 1;

/// Pixels between two that are probed, along both axes.
const PROBE_STEP: usize = 4;

/// Passes from which the error is believed in: of small images, and of those with more than [`MANY_PIXELS`].
const FEWEST_PASSES: [u32; 2] = [4, 2];

/// Pixels whose mean square is as good as known from one pass in each half.
const MANY_PIXELS: usize = 1 << 17;

/// Passes from which the error of an image of so many pixels is believed in.
pub fn fewest_passes(pixels: usize) -> u32 {
    FEWEST_PASSES[usize::from(pixels >= MANY_PIXELS)]
}

/// Whether a pixel is probed for bias.
pub fn is_probed(x: usize, y: usize) -> bool {
    x % PROBE_STEP == PROBE_OFFSET && y % PROBE_STEP == PROBE_OFFSET
}

/// How many pixels of an image are probed.
pub fn probed_count(width: usize, height: usize) -> usize {
    let along = |size: usize| (size + PROBE_STEP - 1 - PROBE_OFFSET) / PROBE_STEP;
    along(width) * along(height)
}

/// The error of an image, as shares of its mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
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

/// The means of even and of odd passes, and what coarse cells would add in probed pixels.
#[derive(Clone, Debug)]
pub struct ErrorProbes {
    /// Mean radiance a pixel of the even and of the odd passes.
    pub halves: [Vec<Rgb>; 2],
    /// The multiple scattering in it.
    pub multiples: [Vec<Rgb>; 2],
    /// Passes of each.
    pub counts: [u32; 2],
    /// Sum and sum of squares over passes, a probed pixel.
    pub differences: Vec<[f64; 2]>,
}

impl ErrorProbes {
    /// No pass yet of a film of that size.
    pub fn new(width: usize, height: usize) -> Self {
        let black = vec![Rgb::ZERO; width * height];
        let halves = [black.clone(), black];
        Self { multiples: halves.clone(), halves, counts: [0; 2], differences: Vec::new() }
    }

    /// Adds a pass: its image, and what coarse cells would add to each probed pixel's mean channel.
    pub fn add(&mut self, half: usize, film: &Film, differences: &[f64]) {
        self.counts[half] += 1;
        let share = 1.0 / f64::from(self.counts[half]);
        let means = self.halves[half].iter_mut().zip(&mut self.multiples[half]);
        for ((radiance, multiple), pixel) in means.zip(&film.pixels) {
            *radiance += (pixel.radiance() - *radiance) * share;
            *multiple += (pixel.multiple_scatter - *multiple) * share;
        }
        self.differences.resize(differences.len(), [0.0; 2]);
        for (sum, difference) in self.differences.iter_mut().zip(differences) {
            sum[0] += difference;
            sum[1] += difference * difference;
        }
    }

    /// The error of the mean of all passes; `None` until both halves have one.
    pub fn error(&self) -> Option<ErrorEstimate> {
        if self.counts.contains(&0) {
            return None;
        }
        let mean = self.mean();
        if mean <= 0.0 {
            return Some(ErrorEstimate::default());
        }
        Some(ErrorEstimate { noise: self.noise() / mean, bias: self.bias() / mean })
    }

    /// What the filter of `film`, the mean of all passes, goes by; `None` until both halves have a pass.
    pub fn halves<'a>(&'a self, film: &'a Film) -> Option<Halves<'a>> {
        let known = !self.counts.contains(&0);
        let [radiance, multiple] =
            [&self.halves, &self.multiples].map(|[even, odd]| [&even[..], &odd[..]]);
        known.then_some(Halves { film, radiance, multiple, counts: self.counts })
    }

    /// Mean channel of all pixels and passes.
    pub fn mean(&self) -> f64 {
        let of_half = |half: &[Rgb]| -> f64 { half.iter().copied().map(mean_channel).sum() };
        let [even, odd] = self.counts.map(f64::from);
        let sum = even * of_half(&self.halves[0]) + odd * of_half(&self.halves[1]);
        sum / ((even + odd) * self.halves[0].len().max(1) as f64)
    }

    /// Root mean square: of two means of m and n passes, the mean of all has the variance of their difference times
    /// m n / (m + n)^2.
    fn noise(&self) -> f64 {
        let [even, odd] = self.counts.map(f64::from);
        let pixels = self.halves[0].iter().zip(&self.halves[1]);
        let squares = pixels.map(|(a, b)| mean_channel((*a - *b) * (*a - *b)));
        let mean = squares.sum::<f64>() / self.halves[0].len().max(1) as f64;
        (mean * even * odd).sqrt() / (even + odd)
    }

    /// Root mean square of the bias of fine cells.
    fn bias(&self) -> f64 {
        let passes = f64::from(self.counts.iter().sum::<u32>());
        let pixel = |&[sum, squares]: &[f64; 2]| {
            let mean = sum / passes;
            let variance = (squares / passes - mean * mean) / (passes - 1.0);
            mean * mean - variance
        };
        let difference: f64 = self.differences.iter().map(pixel).sum();
        (difference.max(0.0) / self.differences.len().max(1) as f64 / 9.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Rgb, Stream, uniform};

    /// Passes of known noise and known differences: the estimate finds both, for equal and unequal halves.
    #[test]
    fn noise_and_bias_are_told_apart() {
        for passes in [8u32, 5] {
            let mut random = Stream::Experiment.random(11, 0);
            let mut probes = ErrorProbes::new(64, 64);
            for pass in 0..passes {
                let mut one = Film::new(64, 64);
                for pixel in &mut one.pixels {
                    pixel.multiple_scatter = Rgb::splat(2.0 + 0.4 * (uniform(&mut random) - 0.5));
                }
                // Coarse cells are off by 0.3 up or down, so fine ones by a third of that; with noise.
                let differences: Vec<f64> = (0..256)
                    .map(|index| {
                        let sign = if index % 2 == 0 { 0.3 } else { -0.3 };
                        sign + 2.0 * (uniform(&mut random) - 0.5)
                    })
                    .collect();
                probes.add((pass % 2) as usize, &one, &differences);
            }
            let error = probes.error().unwrap();
            let noise = 0.4 / 12f64.sqrt() / f64::from(passes).sqrt() / 2.0;
            assert!((error.noise / noise - 1.0).abs() < 0.05, "{error:?} {noise}");
            assert!((error.bias / 0.05 - 1.0).abs() < 0.2, "{error:?}");
            assert!((error.total() - error.noise.hypot(error.bias)).abs() < 1e-15);
        }
    }

    #[test]
    fn probed_pixels_are_counted() {
        for (width, height) in [(1, 9), (2, 2), (5, 6), (24, 16), (31, 33)] {
            let all = (0..width * height).map(|index| (index % width, index / width));
            assert_eq!(all.filter(|(x, y)| is_probed(*x, *y)).count(), probed_count(width, height));
        }
    }

    #[test]
    fn one_pass_knows_nothing_and_black_has_no_error() {
        let mut probes = ErrorProbes::new(4, 4);
        let film = Film::new(4, 4);
        assert_eq!(probes.error(), None);
        probes.add(0, &film, &[]);
        assert_eq!(probes.error(), None);
        probes.add(1, &film, &[]);
        assert_eq!(probes.error(), Some(ErrorEstimate::default()));
    }
}
