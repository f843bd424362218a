//! The regression filter: multiple scattering of a pixel as its neighbours predict it.
//!
//! In a window of (2 r + 1)^2 pixels multiple scattering y is fitted by least squares as a linear function of features that are known
//! better than it is, y = a + b . (x, y, single scattering, opacity), and the fit is read at the middle (local linear regression: Fan,
//! *Design-adaptive nonparametric regression*, JASA 1992; with features of rendering: Moon, Carr and Yoon, *Adaptive rendering based on weighted
//! local regression*, TOG 2014). What is linear in the features stays as it is.
//!
//! The price is bias. It is measured: of two independent halves A and B of the passes and their filtered images F_A and F_B, the mean over
//! pixels of (F_A - A) (F_B - B) is the mean square of the bias, as all else in the two factors is independent. The radius is
//! the one whose noise and bias are least together, so that it shrinks to none as passes are added.

use rayon::prelude::*;

use crate::film::{Film, Pixel};
use crate::math::{Rgb, mean_channel};
use crate::render::error_estimate::ErrorEstimate;

/// Radii tried \[pixels\]; 0 is no filter.
const RADII: [usize; 7] = [0, 1, 2, 3, 4, 6, MAX_FILTER_RADIUS];

/// The largest of them.
pub const MAX_FILTER_RADIUS: usize = 8;

/// Share of a feature's variance by which its slope is damped.
const DAMPING: f64 = 1e-3;

/// Edge of the blocks of pixels whose means count as independent \[pixels\].
const BLOCK: usize = 16;

/// Features but the constant: dx, dy, single scattering, opacity.
const FEATURES: usize = 4;

/// Two independent halves of an image's passes, and how much each counts.
#[derive(Clone, Copy)]
pub struct Halves<'a> {
    /// The mean of all passes, for its features.
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
    /// Radius of the window \[pixels\]; 0 where the filter does not pay.
    pub radius: usize,
    /// Noise, and bias of the filter alone, as shares of the image's mean.
    pub error: ErrorEstimate,
    /// Multiple scattering of every pixel; empty where the radius is 0.
    pub multiple: Vec<Rgb>,
}

impl Halves<'_> {
    /// The image filtered with the radius of least error, looked for from `first` on; `unfiltered` is the error without.
    pub fn filtered(&self, unfiltered: ErrorEstimate, first: usize, mean: f64) -> Filtered {
        let none = || Filtered { radius: 0, error: unfiltered, multiple: Vec::new() };
        let tried = |index: usize| match RADII[index] {
            0 => none(),
            radius => self.with_radius(radius, mean),
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
        let Film { width, height, .. } = *self.film;
        let pixels = self.pixels();
        let rows: Vec<Vec<[Rgb; 2]>> = (0..height)
            .into_par_iter()
            .map(|row| filter_row(&pixels, [width, height], row, radius))
            .collect();
        let filtered: Vec<[Rgb; 2]> = rows.into_iter().flatten().collect();
        let [a, b] = self.shares();
        let multiple =
            filtered.iter().map(|[even, odd]| (*even * a + *odd * b).max(Rgb::ZERO)).collect();
        Filtered { radius, error: self.error(&filtered, mean), multiple }
    }

    /// Shares of the halves in the image.
    fn shares(&self) -> [f64; 2] {
        let [even, odd] = self.counts.map(f64::from);
        [even / (even + odd), odd / (even + odd)]
    }

    /// What the filter sees of each pixel.
    fn pixels(&self) -> Vec<FeaturePixel> {
        let [even, odd] = self.multiple;
        let pixel = |(index, pixel): (usize, &Pixel)| FeaturePixel {
            single: mean_channel(pixel.single_scatter),
            opacity: pixel.alpha(),
            halves: [even[index], odd[index]],
        };
        self.film.pixels.iter().enumerate().map(pixel).collect()
    }

    /// Noise and bias of filtered halves, as shares of `mean`.
    fn error(&self, filtered: &[[Rgb; 2]], mean: f64) -> ErrorEstimate {
        let [a, b] = self.shares();
        let Film { width, height, .. } = *self.film;
        let columns = width.div_ceil(BLOCK);
        let mut blocks = vec![0.0; columns * height.div_ceil(BLOCK)];
        let mut noise = 0.0;
        for (index, [smooth_even, smooth_odd]) in filtered.iter().enumerate() {
            let [even, odd] = self.multiple.map(|half| half[index]);
            let unfiltered = self.radiance[0][index] - self.radiance[1][index];
            let difference = unfiltered - (even - odd) + *smooth_even - *smooth_odd;
            noise += mean_channel(difference * difference);
            let residual = (*smooth_even - even) * (*smooth_odd - odd);
            blocks[index / width / BLOCK * columns + index % width / BLOCK] +=
                mean_channel(residual);
        }
        let count = filtered.len().max(1) as f64;
        let sum: f64 = blocks.iter().sum();
        // Of so many blocks the sum has that standard error. Part of it counts: the radius of least error is chosen by this very sum.
        let spread = 0.5 * blocks.iter().map(|block| block * block).sum::<f64>().sqrt();
        ErrorEstimate {
            noise: (noise * a * b / count).sqrt() / mean,
            bias: ((sum + spread).max(0.0) / count).sqrt() / mean,
        }
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

/// Features of a pixel, and multiple scattering of both halves.
struct FeaturePixel {
    single: f64,
    opacity: f64,
    halves: [Rgb; 2],
}

/// Moments of a window or of a column of it: of (1, dy, single, opacity), and of these with what is fitted.
#[derive(Clone, Copy, Default)]
struct Moments {
    /// Upper triangle of the products of (1, dy, single, opacity).
    products: [f64; 10],
    /// Products of each of them with both halves' light.
    fitted: [[Rgb; 2]; 4],
}

impl Moments {
    fn add_pixel(&mut self, dy: f64, pixel: &FeaturePixel) {
        let features = [1.0, dy, pixel.single, pixel.opacity];
        let mut index = 0;
        for i in 0..4 {
            for j in i..4 {
                self.products[index] += features[i] * features[j];
                index += 1;
            }
            for (sum, light) in self.fitted[i].iter_mut().zip(pixel.halves) {
                *sum += light * features[i];
            }
        }
    }

    fn add(&mut self, other: &Self) {
        self.products.iter_mut().zip(other.products).for_each(|(sum, product)| *sum += product);
        for (sums, others) in self.fitted.iter_mut().zip(other.fitted) {
            sums.iter_mut().zip(others).for_each(|(sum, other)| *sum += other);
        }
    }
}

/// The moments of a window with those of dx.
#[derive(Default)]
struct Window {
    moments: Moments,
    /// Sum of dx^2.
    squares: f64,
    /// Of dx with (1, dy, single, opacity).
    products: [f64; 4],
    /// Of dx with both halves' light.
    fitted: [Rgb; 2],
}

impl Window {
    fn add_column(&mut self, dx: f64, column: &Moments) {
        self.moments.add(column);
        self.squares += dx * dx * column.products[0];
        for (sum, product) in self.products.iter_mut().zip(&column.products[..4]) {
            *sum += dx * product;
        }
        for (sum, light) in self.fitted.iter_mut().zip(column.fitted[0]) {
            *sum += light * dx;
        }
    }

    /// The fit at dx = dy = 0 and the features of the pixel in the middle.
    fn fit(&self, middle: &FeaturePixel) -> [Rgb; 2] {
        let Moments { products: p, fitted } = &self.moments;
        let count = p[0];
        // dx, dy, single, opacity.
        let means = [self.products[0], p[1], p[2], p[3]].map(|sum| sum / count);
        let raw = [
            [self.squares, self.products[1], self.products[2], self.products[3]],
            [0.0, p[4], p[5], p[6]],
            [0.0, 0.0, p[7], p[8]],
            [0.0, 0.0, 0.0, p[9]],
        ];
        let light_means = fitted[0].map(|sum| sum / count);
        let with_light = [self.fitted, fitted[1], fitted[2], fitted[3]];
        let mut covariance = [[0.0; FEATURES]; FEATURES];
        for i in 0..FEATURES {
            for j in i..FEATURES {
                covariance[i][j] = raw[i][j] / count - means[i] * means[j];
                covariance[j][i] = covariance[i][j];
            }
            // A feature that does not vary but by rounding says nothing.
            let floor = 1e-12 * raw[i][i] / count;
            let damped = covariance[i][i] * (1.0 + DAMPING);
            covariance[i][i] = if covariance[i][i] > floor { damped } else { f64::INFINITY };
        }
        let middle = [0.0, 0.0, middle.single, middle.opacity];
        let offset: [f64; FEATURES] = std::array::from_fn(|i| middle[i] - means[i]);
        let slopes = solve(covariance, offset);
        std::array::from_fn(|half| {
            let terms = (0..FEATURES).map(|i| {
                let covariance = with_light[i][half] / count - light_means[half] * means[i];
                covariance * slopes[i]
            });
            light_means[half] + terms.sum::<Rgb>()
        })
    }
}

/// Solves A x = b for a symmetric positive definite A by Cholesky decomposition; where a diagonal is infinite or rounding leaves nothing of it,
/// that x is 0.
fn solve(mut a: [[f64; FEATURES]; FEATURES], mut x: [f64; FEATURES]) -> [f64; FEATURES] {
    let mut known = [false; FEATURES];
    for i in 0..FEATURES {
        let own = a[i][i];
        let mut pivot = own;
        for k in (0..i).filter(|&k| known[k]) {
            pivot -= a[i][k] * a[i][k];
        }
        known[i] = own.is_finite() && pivot > 1e-9 * own;
        if !known[i] {
            continue;
        }
        let root = pivot.sqrt();
        a[i][i] = root;
        for j in i + 1..FEATURES {
            let taken: f64 = (0..i).filter(|&k| known[k]).map(|k| a[i][k] * a[j][k]).sum();
            a[j][i] = (a[j][i] - taken) / root;
        }
        let taken: f64 = (0..i).filter(|&k| known[k]).map(|k| a[i][k] * x[k]).sum();
        x[i] = (x[i] - taken) / root;
    }
    for i in (0..FEATURES).rev() {
        if !known[i] {
            x[i] = 0.0;
            continue;
        }
        let taken: f64 = (i + 1..FEATURES).filter(|&k| known[k]).map(|k| a[k][i] * x[k]).sum();
        x[i] = (x[i] - taken) / a[i][i];
    }
    x
}

/// Fits of the pixels of a row, both halves.
fn filter_row(
    pixels: &[FeaturePixel],
    [width, height]: [usize; 2],
    row: usize,
    radius: usize,
) -> Vec<[Rgb; 2]> {
    let rows = row.saturating_sub(radius)..(row + radius + 1).min(height);
    let mut columns = vec![Moments::default(); width];
    for y in rows {
        let dy = y as f64 - row as f64;
        for (column, pixel) in columns.iter_mut().zip(&pixels[y * width..(y + 1) * width]) {
            column.add_pixel(dy, pixel);
        }
    }
    let fit = |x: usize| {
        let mut window = Window::default();
        let near = x.saturating_sub(radius)..(x + radius + 1).min(width);
        for (column, moments) in near.clone().zip(&columns[near]) {
            window.add_column(column as f64 - x as f64, moments);
        }
        window.fit(&pixels[row * width + x])
    };
    (0..width).map(fit).collect()
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
        for radius in [2, 4] {
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
            // Two of three channels are noisy; the mean of (2 r + 1)^2 pixels leaves so much, slopes of features somewhat more.
            let raw = 0.5 * (2.0f64 / 3.0).sqrt() / 2f64.sqrt();
            let least = raw / (2 * radius + 1) as f64;
            assert!(error > least && error < 5f64.sqrt() * least, "{radius}: {error} {least}");
            let found = filtered.error;
            assert!((found.noise / error - 1.0).abs() < 0.1, "{found:?} {error}");
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
        for (noise, largest) in [(1.0, 4), (0.2, 2), (0.01, 0)] {
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
                for radius in [1, 2, 3, 4] {
                    let other = true_error(&halves.with_radius(radius, 1.0));
                    assert!(error < 1.25 * other, "{noise}: {} {radius}", chosen.radius);
                }
                assert!(error < raw, "{noise}: {error} {raw}");
            }
        }
    }

    #[test]
    fn features_that_repeat_or_do_not_vary_are_left_out() {
        let b = [1.0, 2.0, 3.0, 4.0];
        let identity = |i: usize, j: usize| if i == j { 2.0 } else { 0.0 };
        let a = std::array::from_fn(|i| std::array::from_fn(|j| identity(i, j)));
        let near = |found: [f64; 4], exact: [f64; 4]| {
            assert!(found.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
        };
        near(solve(a, b), [0.5, 1.0, 1.5, 2.0]);
        let mut singular = a;
        (singular[0][1], singular[1][0]) = (2.0, 2.0);
        singular[3][3] = f64::INFINITY;
        near(solve(singular, b), [0.5, 0.0, 1.5, 0.0]);
    }
}
