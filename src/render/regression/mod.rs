//! The regression filter: multiple scattering of a pixel as its neighbours predict it.
//!
//! Around every cell of s x s pixels multiple scattering y is fitted by least squares, over a window of 5 x 5 cells (3 x 3 for the least), as a linear function of features
//! that are known better than it is, y = a + b . (x, y, single scattering, opacity); a pixel blends the fits of the four cells nearest to it (local linear regression: Fan,
//! *Design-adaptive nonparametric regression*, JASA 1992; with features of rendering: Moon, Carr and Yoon, *Adaptive rendering based on weighted
//! local regression*, TOG 2014). What is linear in the features stays as it is. Cells make the price of a pixel independent of the window.
//!
//! The other price is bias. It is measured: of two independent halves A and B of the passes and their filtered images F_A and F_B, the mean over
//! pixels of (F_A - A) (F_B - B) is the mean square of the bias, as all else in the two factors is independent: either half goes by its own
//! single scattering, whose noise would else be in both. The radius is
//! the one whose noise and bias are least together, so that it shrinks to none as passes are added.

mod cells;
mod fit;

use std::ops::Range;

use rayon::prelude::*;

use crate::film::{Film, Pixel};
use crate::math::{Rgb, mean_channel};
use crate::render::error_estimate::ErrorEstimate;
use cells::{CellImage, FineCells, cells};
use fit::FeaturePixel;

/// Radii of windows tried \[pixels\]; 0 is no filter. Cells of all but the least are made of finer ones.
const RADII: [usize; 11] = [0, 1, 2, 5, 7, 10, 20, 30, 40, 60, MAX_FILTER_RADIUS];

/// The largest of them.
pub const MAX_FILTER_RADIUS: usize = 80;

/// Rows of cells that one task filters: whole blocks.
const TASK_ROWS: usize = 32;

/// Edge of the blocks of pixels whose means count as independent \[pixels\].
const BLOCK: usize = 16;

/// Pixels by which an image's noise and bias are known well: of a larger one some rows are looked at.
const ENOUGH_PIXELS: usize = 1 << 17;

/// Pixels along an image for each of the radius that is tried first.
const PIXELS_A_FIRST_RADIUS: usize = 64;

/// The radius that is tried first in an image of that size \[pixels\].
pub fn first_radius(width: usize, height: usize) -> usize {
    let most = width.max(height) / PIXELS_A_FIRST_RADIUS;
    RADII.into_iter().rfind(|radius| *radius <= most).unwrap_or(0).max(1)
}

/// Two independent halves of an image's passes, and how much each counts.
#[derive(Clone, Copy)]
pub struct Halves<'a> {
    /// The mean of all passes, for its opacity.
    pub film: &'a Film,
    /// Mean radiance a pixel of each half.
    pub radiance: [&'a [Rgb]; 2],
    /// Mean multiple scattering a pixel of each half.
    pub multiple: [&'a [Rgb]; 2],
    /// Passes of each half: none 0.
    pub counts: [u32; 2],
}

/// How wide to filter, and what comes of it.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// Radius of the windows \[pixels\]; 0 where the filter does not pay.
    pub radius: usize,
    /// Noise, and bias of the filter alone, as shares of the image's mean.
    pub error: ErrorEstimate,
}

/// A filtered image.
#[derive(Clone, Debug)]
pub struct Filtered {
    /// Noise, and bias of the filter alone, as shares of the image's mean.
    pub error: ErrorEstimate,
    /// Multiple scattering of every pixel.
    pub multiple: Vec<Rgb>,
}

impl Halves<'_> {
    /// The radius of least error, looked for from `first` on; `unfiltered` is the error without.
    pub fn best_radius(&self, unfiltered: ErrorEstimate, first: usize, mean: f64) -> Choice {
        let pixels = [0, 1].map(|half| self.pixels(half));
        let fine = self.images(&pixels, None, RADII[1]).map(FineCells::of);
        let step = (self.film.pixels.len() / ENOUGH_PIXELS).max(1);
        let tried = |index: usize| match RADII[index] {
            0 => Choice { radius: 0, error: unfiltered },
            radius => {
                let images = self.images(&pixels, Some(&fine), radius);
                let rows = |rows: Range<usize>| self.filter_rows(&images, rows, step).cost;
                Choice { radius, error: self.error(&self.by_tasks(&images[0], rows), mean) }
            }
        };
        let first = RADII.iter().position(|radius| *radius == first).unwrap_or(0);
        let mut best = tried(first);
        if !improve(&mut best, (first + 1..RADII.len()).map(tried)) {
            improve(&mut best, (0..first).rev().map(tried));
        }
        best
    }

    /// The image filtered with that radius.
    pub fn filtered(&self, radius: usize, mean: f64) -> Filtered {
        let pixels = [0, 1].map(|half| self.pixels(half));
        let images = self.images(&pixels, None, radius);
        let rows = self.by_tasks(&images[0], |rows| self.filter_rows(&images, rows, 1));
        let (costs, multiple): (Vec<Cost>, Vec<Vec<Rgb>>) =
            rows.into_iter().map(|rows| (rows.cost, rows.multiple)).unzip();
        Filtered { error: self.error(&costs, mean), multiple: multiple.concat() }
    }

    /// Both halves in the cells of windows of that radius.
    fn images<'a>(
        &self,
        pixels: &'a [Vec<FeaturePixel>; 2],
        fine: Option<&'a [FineCells; 2]>,
        radius: usize,
    ) -> [CellImage<'a>; 2] {
        let Film { width, height, .. } = *self.film;
        let (cell, reach) = cells(radius);
        [0, 1].map(|half| CellImage {
            pixels: &pixels[half],
            fine: fine.map(|fine| &fine[half]),
            width,
            height,
            cell,
            reach,
        })
    }

    /// What comes of the rows of every task, in their order.
    fn by_tasks<T: Send>(
        &self,
        image: &CellImage,
        of_rows: impl Fn(Range<usize>) -> T + Sync,
    ) -> Vec<T> {
        let (height, task) = (self.film.height, TASK_ROWS * image.cell);
        let tasks = (0..height.div_ceil(task)).into_par_iter();
        tasks.map(|part| of_rows(part * task..((part + 1) * task).min(height))).collect()
    }

    /// The error that rows tell.
    fn error(&self, costs: &[Cost], mean: f64) -> ErrorEstimate {
        let [mut noise, mut bias, mut spread, mut count] = [0.0; 4];
        for cost in costs {
            noise += cost.noise;
            bias += cost.blocks.iter().sum::<f64>();
            spread += cost.blocks.iter().map(|block| block * block).sum::<f64>();
            count += cost.pixel_count as f64;
        }
        let [a, b] = self.shares();
        // Of so many blocks the sum has that standard error. It counts: the radius of least error is chosen by this very sum, and a bias that noise hides is not known to be
        // none.
        let bias = (bias + spread.sqrt()).max(0.0);
        let count = count.max(1.0);
        let noise = (noise * a * b / count).sqrt() / mean;
        ErrorEstimate { noise, bias: (bias / count).sqrt() / mean }
    }

    /// Filters every `step`th of some rows of pixels.
    fn filter_rows(
        &self,
        images: &[CellImage; 2],
        rows: Range<usize>,
        step: usize,
    ) -> FilteredRows {
        let [even, odd] = images.each_ref().map(|image| image.filter_rows(rows.clone(), step));
        let width = self.film.width;
        let columns = width.div_ceil(BLOCK);
        let mut cost = Cost {
            blocks: vec![0.0; columns * rows.len().div_ceil(BLOCK)],
            noise: 0.0,
            pixel_count: even.len(),
        };
        let mut multiple = Vec::with_capacity(even.len());
        let [a, b] = self.shares();
        for (index, (even, odd)) in even.into_iter().zip(odd).enumerate() {
            let smooth = [even, odd].map(Rgb::from_array);
            let (x, y) = (index % width, rows.start + index / width * step);
            let halves = self.multiple.map(|half| half[y * width + x]);
            let [radiance_even, radiance_odd] = self.radiance.map(|half| half[y * width + x]);
            let [residual_even, residual_odd] = [0, 1].map(|half| smooth[half] - halves[half]);
            let difference = radiance_even - radiance_odd + residual_even - residual_odd;
            cost.noise += mean_channel(difference * difference);
            cost.blocks[(y - rows.start) / BLOCK * columns + x / BLOCK] +=
                mean_channel(residual_even * residual_odd);
            multiple.push((smooth[0] * a + smooth[1] * b).max(Rgb::ZERO));
        }
        FilteredRows { cost, multiple }
    }

    /// Shares of the halves in the image.
    fn shares(&self) -> [f64; 2] {
        let [even, odd] = self.counts.map(f64::from);
        [even / (even + odd), odd / (even + odd)]
    }

    /// What the filter sees of each pixel of a half.
    fn pixels(&self, half: usize) -> Vec<FeaturePixel> {
        let lit = self.radiance[half].par_iter().zip(self.multiple[half]);
        let pixel = |(pixel, (radiance, multiple)): (&Pixel, (&Rgb, &Rgb))| FeaturePixel {
            single: mean_channel(*radiance - *multiple),
            opacity: pixel.alpha(),
            light: multiple.to_array(),
        };
        self.film.pixels.par_iter().zip(lit).map(pixel).collect()
    }
}

/// Takes the next choice as long as its error is less; whether any was.
fn improve(best: &mut Choice, others: impl Iterator<Item = Choice>) -> bool {
    let mut improved = false;
    for other in others {
        if other.error.total() >= best.error.total() {
            break;
        }
        (*best, improved) = (other, true);
    }
    improved
}

/// What filtering some rows of pixels costs.
struct Cost {
    /// Sum of squared differences of the halves, mean channel.
    noise: f64,
    /// Sum over each block of what both halves were changed by, multiplied.
    blocks: Vec<f64>,
    /// Pixels looked at.
    pixel_count: usize,
}

/// Some filtered rows of pixels.
struct FilteredRows {
    cost: Cost,
    /// Multiple scattering of their pixels.
    multiple: Vec<Rgb>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Random, Stream, uniform};
    use crate::render::error_estimate::ErrorProbes;

    /// A film whose multiple scattering is `value` of (x, y) and its features, with noise of that standard deviation.
    fn film(random: &mut Random, noise: f64, bend: f64) -> Film {
        let mut film = Film::new(64, 48);
        for (index, pixel) in film.pixels.iter_mut().enumerate() {
            let (x, y) = ((index % 64) as f64, (index / 64) as f64);
            let edge = if x + 2.0 * y > 90.0 { 1.0 } else { 0.0 };
            let single = 0.5 + 0.3 * (0.7 * x).sin() + 0.2 * (0.9 * y).cos();
            pixel.single_scatter = Rgb::splat(single);
            pixel.transmittance = Rgb::splat(1.0 - 0.5 * edge);
            let bent = bend * (0.4 * x).cos() * (0.5 * y).cos();
            let exact = 2.0 + 0.01 * x - 0.02 * y + 0.8 * single + 0.6 * edge + bent;
            let error = noise * 12f64.sqrt() * (uniform(random) - 0.5);
            pixel.multiple_scatter = Rgb::new(exact + error, exact, exact - error);
        }
        film
    }

    fn probes(halves: [&Film; 2]) -> ErrorProbes {
        let mut probes = ErrorProbes::new(64, 48);
        halves.into_iter().enumerate().for_each(|(half, film)| probes.add(half, film, &[]));
        probes
    }

    /// What is linear in place and features is left as it is, up to the damping, at corners and edges, too; and noise falls as it must.
    #[test]
    fn linear_light_passes_and_noise_does_not() {
        let mut random = Stream::Experiment.random(21, 0);
        let exact = film(&mut random, 0.0, 0.0);
        let noisy = [film(&mut random, 0.5, 0.0), film(&mut random, 0.5, 0.0)];
        let (still, noisy) = (probes([&exact, &exact]), probes(noisy.each_ref()));
        let (still, halves) = (still.halves(&exact).unwrap(), noisy.halves(&exact).unwrap());
        for radius in [2, 5] {
            let passed = still.filtered(radius, 2.5);
            let largest = passed.multiple.iter().zip(&exact.pixels).fold(0.0, |largest, (f, p)| {
                (*f - p.multiple_scatter).abs().max_element().max(largest)
            });
            assert!(largest < 5e-3, "{radius}: {largest}");
            let filtered = halves.filtered(radius, 1.0);
            let squares = filtered.multiple.iter().zip(&exact.pixels).map(|(f, p)| {
                let error = *f - p.multiple_scatter;
                mean_channel(error * error)
            });
            let error = (squares.sum::<f64>() / 3072.0).sqrt();
            // Two of three channels are noisy; the mean of a window leaves so much, blended fits less, slopes of features somewhat more.
            let raw = 0.5 * (2.0f64 / 3.0).sqrt() / 2f64.sqrt();
            let mean = raw / (2 * radius + 1) as f64;
            assert!(error > 0.8 * mean && error < 5f64.sqrt() * mean, "{radius}: {error} {mean}");
            let found = filtered.error;
            assert!((found.noise / error - 1.0).abs() < 0.15, "{found:?} {error}");
            assert!(found.bias < 0.3 * raw, "{found:?}");
        }
    }

    /// The bias is found in the noise, and the radius is the one of least true error, or next to it.
    #[test]
    fn bias_is_measured_and_bounds_the_radius() {
        let mut random = Stream::Experiment.random(22, 0);
        let exact = film(&mut random, 0.0, 0.3);
        let true_error = |filtered: &Filtered| {
            let squares = filtered.multiple.iter().zip(&exact.pixels).map(|(f, p)| {
                let error = *f - p.multiple_scatter;
                mean_channel(error * error)
            });
            (squares.sum::<f64>() / 3072.0).sqrt()
        };
        for (noise, largest) in [(1.0, 5), (0.2, 2), (0.01, 0)] {
            let noisy = [film(&mut random, noise, 0.3), film(&mut random, noise, 0.3)];
            let probes = probes(noisy.each_ref());
            let halves = probes.halves(&exact).unwrap();
            let raw = noise * (2.0f64 / 3.0).sqrt() / 2f64.sqrt();
            let chosen = halves.best_radius(ErrorEstimate { noise: raw, bias: 0.0 }, 2, 1.0);
            assert!(chosen.radius <= largest, "{noise}: {}", chosen.radius);
            if chosen.radius > 0 {
                let error = true_error(&halves.filtered(chosen.radius, 1.0));
                let ratio = chosen.error.total() / error;
                assert!((0.8..1.4).contains(&ratio), "{noise}: {ratio}");
                for radius in [1, 2, 5, 7] {
                    let other = true_error(&halves.filtered(radius, 1.0));
                    assert!(error < 1.25 * other, "{noise}: {} {radius}", chosen.radius);
                }
                assert!(error < raw, "{noise}: {error} {raw}");
            }
        }
    }
}
