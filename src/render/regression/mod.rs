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

mod fit;

use std::ops::Range;

use rayon::prelude::*;

use crate::film::{Film, Pixel};
use crate::math::{Rgb, mean_channel};
use crate::render::error_estimate::ErrorEstimate;
use fit::{FeaturePixel, LIGHTS, LightFit, Moments, PixelLight};

/// Radii of windows tried \[pixels\]; 0 is no filter.
const RADII: [usize; 12] = [0, 1, 2, 5, 7, 10, 15, 20, 30, 40, 60, MAX_FILTER_RADIUS];

/// The largest of them.
pub const MAX_FILTER_RADIUS: usize = 80;

/// Rows of cells that one task filters: whole blocks.
const TASK_ROWS: usize = 32;

/// Edge of the blocks of pixels whose means count as independent \[pixels\].
const BLOCK: usize = 16;

/// Pixels along an image for each of the radius that is tried first.
const PIXELS_A_FIRST_RADIUS: usize = 64;

/// The radius that is tried first in an image of that size \[pixels\].
pub fn first_radius(width: usize, height: usize) -> usize {
    let most = width.max(height) / PIXELS_A_FIRST_RADIUS;
    RADII.into_iter().rfind(|radius| *radius <= most).unwrap_or(0).max(1)
}

/// Edge of the cells of a window \[pixels\], and cells from its middle to its edge: 3 x 3 pixels for radius 1, else 5 x 5 cells.
fn cells(radius: usize) -> (usize, usize) {
    if radius == 1 { (1, 1) } else { ((2 * radius).div_ceil(5), 2) }
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

/// A filtered image.
#[derive(Clone, Debug)]
pub struct Filtered {
    /// Radius of the windows \[pixels\]; 0 where the filter does not pay.
    pub radius: usize,
    /// Noise, and bias of the filter alone, as shares of the image's mean.
    pub error: ErrorEstimate,
    /// Multiple scattering of every pixel; empty where the radius is 0.
    pub multiple: Vec<Rgb>,
}

impl Halves<'_> {
    /// The image filtered with the radius of least error, looked for from `first` on; `unfiltered` is the error without.
    pub fn filtered(&self, unfiltered: ErrorEstimate, first: usize, mean: f64) -> Filtered {
        let pixels = [0, 1].map(|half| self.pixels(half));
        let none = || Filtered { radius: 0, error: unfiltered, multiple: Vec::new() };
        let tried = |index: usize| match RADII[index] {
            0 => none(),
            radius => self.filter(&pixels, radius, mean),
        };
        let first = RADII.iter().position(|radius| *radius == first).unwrap_or(0);
        let mut best = tried(first);
        if !improve(&mut best, (first + 1..RADII.len()).map(tried)) {
            improve(&mut best, (0..first).rev().map(tried));
        }
        best
    }

    /// The image filtered with that radius, whatever comes of it.
    pub fn with_radius(&self, radius: usize, mean: f64) -> Filtered {
        self.filter(&[0, 1].map(|half| self.pixels(half)), radius, mean)
    }

    fn filter(&self, pixels: &[Vec<FeaturePixel>; 2], radius: usize, mean: f64) -> Filtered {
        let Film { width, height, .. } = *self.film;
        let (cell, reach) = cells(radius);
        let task = TASK_ROWS * cell;
        let halves =
            pixels.each_ref().map(|pixels| CellImage { pixels, width, height, cell, reach });
        let parts: Vec<FilteredRows> = (0..height.div_ceil(task))
            .into_par_iter()
            .map(|part| self.filter_rows(&halves, part * task..((part + 1) * task).min(height)))
            .collect();
        let mut multiple = Vec::with_capacity(width * height);
        let [mut noise, mut bias, mut spread] = [0.0; 3];
        for part in parts {
            noise += part.noise;
            bias += part.blocks.iter().sum::<f64>();
            spread += part.blocks.iter().map(|block| block * block).sum::<f64>();
            multiple.extend(part.multiple);
        }
        let count = (width * height).max(1) as f64;
        let [a, b] = self.shares();
        // Of so many blocks the sum has that standard error. Part of it counts: the radius of least error is chosen by this very sum.
        let bias = (bias + 0.5 * spread.sqrt()).max(0.0);
        let noise = (noise * a * b / count).sqrt() / mean;
        let error = ErrorEstimate { noise, bias: (bias / count).sqrt() / mean };
        Filtered { radius, error, multiple }
    }

    /// Filters some rows of pixels.
    fn filter_rows(&self, images: &[CellImage; 2], rows: Range<usize>) -> FilteredRows {
        let [even, odd] = images.each_ref().map(|image| image.filter_rows(rows.clone()));
        let (width, first) = (self.film.width, rows.start * self.film.width);
        let columns = width.div_ceil(BLOCK);
        let mut blocks = vec![0.0; columns * rows.len().div_ceil(BLOCK)];
        let mut noise = 0.0;
        let mut multiple = Vec::with_capacity(even.len());
        let [a, b] = self.shares();
        for (index, (even, odd)) in even.into_iter().zip(odd).enumerate() {
            let smooth = [even, odd].map(Rgb::from_array);
            let halves = self.multiple.map(|half| half[first + index]);
            let [radiance_even, radiance_odd] = self.radiance.map(|half| half[first + index]);
            let [residual_even, residual_odd] = [0, 1].map(|half| smooth[half] - halves[half]);
            let difference = radiance_even - radiance_odd + residual_even - residual_odd;
            noise += mean_channel(difference * difference);
            blocks[index / width / BLOCK * columns + index % width / BLOCK] +=
                mean_channel(residual_even * residual_odd);
            multiple.push((smooth[0] * a + smooth[1] * b).max(Rgb::ZERO));
        }
        FilteredRows { noise, blocks, multiple }
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

/// Takes the next image as long as its error is less; whether any was.
fn improve(best: &mut Filtered, others: impl Iterator<Item = Filtered>) -> bool {
    let mut improved = false;
    for other in others {
        if other.error.total() >= best.error.total() {
            break;
        }
        (*best, improved) = (other, true);
    }
    improved
}

/// Some filtered rows of pixels.
struct FilteredRows {
    /// Sum of squared differences of the halves, mean channel.
    noise: f64,
    /// Sum over each block of what both halves were changed by, multiplied.
    blocks: Vec<f64>,
    /// Multiple scattering of their pixels.
    multiple: Vec<Rgb>,
}

/// A half's image in cells of pixels, of which the last may be cut short.
struct CellImage<'a> {
    pixels: &'a [FeaturePixel],
    width: usize,
    height: usize,
    /// Edge of the cells \[pixels\].
    cell: usize,
    /// Cells from the middle of a window to its edge.
    reach: usize,
}

impl CellImage<'_> {
    /// Light of the pixels of some rows, from the fits of the cells around.
    fn filter_rows(&self, rows: Range<usize>) -> Vec<PixelLight> {
        let Self { width, height, cell, .. } = *self;
        let columns = width.div_ceil(cell);
        let cell_rows = height.div_ceil(cell);
        let first_row = (rows.start / cell).saturating_sub(1);
        let fits = self.fits(first_row..(rows.end.div_ceil(cell) + 1).min(cell_rows));
        let mut filtered = Vec::with_capacity(rows.len() * width);
        for y in rows {
            let [above, below] = self.nearest(y, cell_rows);
            let t = self.blend(y, above, below);
            let heights = [above, below].map(|row| y as f64 - self.middle(row));
            let [above, below] = [above, below].map(|row| (row - first_row) * columns);
            let blended: Vec<LightFit> = (0..columns)
                .map(|x| LightFit::blended(&fits[above + x], &fits[below + x], t, heights))
                .collect();
            for (x, pixel) in self.pixels[y * width..(y + 1) * width].iter().enumerate() {
                let nearest = self.nearest(x, columns);
                let t = self.blend(x, nearest[0], nearest[1]);
                let mut light = [0.0; LIGHTS];
                for (column, share) in nearest.into_iter().zip([1.0 - t, t]) {
                    let from_middle = x as f64 - self.middle(column);
                    blended[column].add_light(&mut light, share, from_middle, pixel);
                }
                filtered.push(light);
            }
        }
        filtered
    }

    /// The middle of a row or column of cells \[pixels\].
    fn middle(&self, cell: usize) -> f64 {
        (cell as f64 + 0.5) * self.cell as f64 - 0.5
    }

    /// The cells whose middles lie on either side of a pixel, along one axis; one twice at the ends and where it is the pixel itself.
    fn nearest(&self, pixel: usize, count: usize) -> [usize; 2] {
        let own = pixel / self.cell;
        match (pixel as f64).total_cmp(&self.middle(own)) {
            std::cmp::Ordering::Less => [own.saturating_sub(1), own],
            std::cmp::Ordering::Equal => [own; 2],
            std::cmp::Ordering::Greater => [own, (own + 1).min(count - 1)],
        }
    }

    /// How far a pixel lies from the middle of one of its nearest cells towards that of the other, as a share.
    fn blend(&self, pixel: usize, one: usize, other: usize) -> f64 {
        match one == other {
            true => 0.0,
            false => (pixel as f64 - self.middle(one)) / self.cell as f64,
        }
    }

    /// The fits of some rows of cells.
    fn fits(&self, rows: Range<usize>) -> Vec<LightFit> {
        let columns = self.width.div_ceil(self.cell);
        let cell_rows = self.height.div_ceil(self.cell);
        let edge = self.cell as f64;
        let near = |middle: usize, count: usize| {
            middle.saturating_sub(self.reach)..(middle + self.reach + 1).min(count)
        };
        let first = rows.start.saturating_sub(self.reach);
        let last = (rows.end + self.reach).min(cell_rows);
        // Sums over the cells of a window's row, from the cell in the middle of it.
        let along: Vec<Moments> = (first..last)
            .flat_map(|row| {
                let own = self.moments(row);
                (0..columns).map(move |middle| {
                    let mut sum = Moments::default();
                    for column in near(middle, columns) {
                        sum.add_moved(&own[column], 0, (column as f64 - middle as f64) * edge);
                    }
                    sum
                })
            })
            .collect();
        let fit = |row: usize, column: usize| {
            let mut sum = Moments::default();
            for other in near(row, cell_rows) {
                let moments = &along[(other - first) * columns + column];
                sum.add_moved(moments, 1, (other as f64 - row as f64) * edge);
            }
            sum.fit()
        };
        rows.flat_map(|row| (0..columns).map(move |column| (row, column)))
            .map(|(row, column)| fit(row, column))
            .collect()
    }

    /// The sums of the cells of a row, each from its middle.
    fn moments(&self, row: usize) -> Vec<Moments> {
        let Self { pixels, width, height, cell, .. } = *self;
        let mut row_moments = vec![Moments::default(); width.div_ceil(cell)];
        for y in row * cell..((row + 1) * cell).min(height) {
            let dy = y as f64 - self.middle(row);
            let cells = pixels[y * width..(y + 1) * width].chunks(cell);
            for ((column, cell), moments) in cells.enumerate().zip(&mut row_moments) {
                for (x, pixel) in cell.iter().enumerate() {
                    let dx = (column * self.cell + x) as f64 - self.middle(column);
                    moments.add_pixel(dx, dy, pixel);
                }
            }
        }
        row_moments
    }
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
            let passed = still.with_radius(radius, 2.5);
            let largest = passed.multiple.iter().zip(&exact.pixels).fold(0.0, |largest, (f, p)| {
                (*f - p.multiple_scatter).abs().max_element().max(largest)
            });
            assert!(largest < 5e-3, "{radius}: {largest}");
            let filtered = halves.with_radius(radius, 1.0);
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
            let chosen = halves.filtered(ErrorEstimate { noise: raw, bias: 0.0 }, 2, 1.0);
            assert!(chosen.radius <= largest, "{noise}: {}", chosen.radius);
            if chosen.radius > 0 {
                let error = true_error(&chosen);
                let ratio = chosen.error.total() / error;
                assert!((0.8..1.4).contains(&ratio), "{noise}: {ratio}");
                for radius in [1, 2, 5, 7] {
                    let other = true_error(&halves.with_radius(radius, 1.0));
                    assert!(error < 1.25 * other, "{noise}: {} {radius}", chosen.radius);
                }
                assert!(error < raw, "{noise}: {error} {raw}");
            }
        }
    }
}
