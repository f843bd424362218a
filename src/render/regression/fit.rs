//! Least squares over cells of pixels: light as a linear function of place, single scattering and opacity.
//!
//! Sums over a cell are made once; a window adds those of its cells, moved to a common origin: with x' = x + d, sum x' f = sum x f + d sum f.

/// What is fitted: three channels.
pub const LIGHTS: usize = 3;

/// Features but the constant: x, y, single scattering, opacity.
const FEATURES: usize = 4;

/// Share of a feature's variance by which its slope is damped.
const DAMPING: f64 = 1e-3;

/// Light of a pixel: red, green and blue.
pub type PixelLight = [f64; LIGHTS];

/// Features of a pixel, and its multiple scattering.
pub struct FeaturePixel {
    /// All but multiple scattering, mean channel.
    pub single: f64,
    /// 1 - transmittance.
    pub opacity: f64,
    /// What is fitted.
    pub light: PixelLight,
}

/// Sums over pixels of 1, of features, of their products with each other, and of all these with light.
#[derive(Clone, Copy, Default)]
pub struct Moments {
    count: f64,
    features: [f64; FEATURES],
    /// Products of features.
    products: [[f64; FEATURES]; FEATURES],
    light: PixelLight,
    /// Products of each feature with light.
    with_light: [PixelLight; FEATURES],
}

impl Moments {
    /// Adds a pixel at (x, y) from the origin \[pixels\].
    pub fn add_pixel(&mut self, x: f64, y: f64, pixel: &FeaturePixel) {
        let features = [x, y, pixel.single, pixel.opacity];
        self.count += 1.0;
        add_scaled(&mut self.light, &pixel.light, 1.0);
        for i in 0..FEATURES {
            self.features[i] += features[i];
            for j in i..FEATURES {
                self.products[i][j] += features[i] * features[j];
            }
            add_scaled(&mut self.with_light[i], &pixel.light, features[i]);
        }
    }

    /// Adds sums whose origin lies `distance` farther along axis 0 or 1 \[pixels\].
    pub fn add_moved(&mut self, other: &Self, axis: usize, distance: f64) {
        self.count += other.count;
        add_scaled(&mut self.light, &other.light, 1.0);
        for i in 0..FEATURES {
            self.features[i] += other.features[i];
            add_scaled(&mut self.products[i], &other.products[i], 1.0);
            add_scaled(&mut self.with_light[i], &other.with_light[i], 1.0);
        }
        for i in 0..FEATURES {
            let (low, high) = (axis.min(i), axis.max(i));
            self.products[low][high] += distance * other.features[i];
        }
        self.products[axis][axis] += distance * (other.features[axis] + distance * other.count);
        self.features[axis] += distance * other.count;
        add_scaled(&mut self.with_light[axis], &other.light, distance);
    }

    /// The fit of least squares.
    pub fn fit(&self) -> LightFit {
        let count = self.count;
        let means = self.features.map(|sum| sum / count);
        let light_means = self.light.map(|sum| sum / count);
        let mut covariance = [[0.0; FEATURES]; FEATURES];
        let mut slopes = [[0.0; LIGHTS]; FEATURES];
        for i in 0..FEATURES {
            for j in i..FEATURES {
                covariance[i][j] = self.products[i][j] / count - means[i] * means[j];
                covariance[j][i] = covariance[i][j];
            }
            // A feature that does not vary but by rounding says nothing.
            let floor = 1e-12 * self.products[i][i] / count;
            let damped = covariance[i][i] * (1.0 + DAMPING);
            covariance[i][i] = if covariance[i][i] > floor { damped } else { f64::INFINITY };
            for (light, slope) in slopes[i].iter_mut().enumerate() {
                *slope = self.with_light[i][light] / count - light_means[light] * means[i];
            }
        }
        solve(covariance, &mut slopes);
        let mut constant = light_means;
        for (slope, mean) in slopes.iter().zip(means) {
            add_scaled(&mut constant, slope, -mean);
        }
        LightFit { constant, slopes }
    }
}

/// Light as a linear function of (x, y) from the origin, single scattering and opacity.
#[derive(Clone, Copy, Default)]
pub struct LightFit {
    constant: PixelLight,
    slopes: [PixelLight; FEATURES],
}

impl LightFit {
    /// What is left of (1 - t) a + t b at heights of y = `heights` from either's origin: a function of x, single scattering and opacity.
    pub fn blended(a: &Self, b: &Self, t: f64, heights: [f64; 2]) -> Self {
        let mut fit = Self::default();
        for ((of, share), height) in [(a, 1.0 - t), (b, t)].into_iter().zip(heights) {
            add_scaled(&mut fit.constant, &of.constant, share);
            add_scaled(&mut fit.constant, &of.slopes[1], share * height);
            for i in [0, 2, 3] {
                add_scaled(&mut fit.slopes[i], &of.slopes[i], share);
            }
        }
        fit
    }

    /// Adds `share` of a pixel's light, x from the origin, to `light`.
    pub fn add_light(&self, light: &mut PixelLight, share: f64, x: f64, pixel: &FeaturePixel) {
        let Self { constant, slopes: [along, _, single, opacity] } = self;
        for (index, sum) in light.iter_mut().enumerate() {
            let sloped = single[index] * pixel.single + opacity[index] * pixel.opacity;
            *sum += share * (constant[index] + along[index] * x + sloped);
        }
    }
}

/// a += b s.
fn add_scaled<const N: usize>(a: &mut [f64; N], b: &[f64; N], s: f64) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += b * s;
    }
}

/// Solves A x = b for a symmetric positive definite A and several b at once by Cholesky decomposition; where a diagonal is infinite or rounding
/// leaves nothing of it, that x is 0.
fn solve<const N: usize>(mut a: [[f64; FEATURES]; FEATURES], x: &mut [[f64; N]; FEATURES]) {
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
        for k in (0..i).filter(|&k| known[k]) {
            let found = x[k];
            add_scaled(&mut x[i], &found, -a[i][k]);
        }
        x[i] = x[i].map(|x| x / root);
    }
    for i in (0..FEATURES).rev() {
        if !known[i] {
            x[i] = [0.0; N];
            continue;
        }
        for k in (i + 1..FEATURES).filter(|&k| known[k]) {
            let found = x[k];
            add_scaled(&mut x[i], &found, -a[k][i]);
        }
        x[i] = x[i].map(|x| x / a[i][i]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Stream, uniform};

    #[test]
    fn features_that_repeat_or_do_not_vary_are_left_out() {
        let b = [[1.0], [2.0], [3.0], [4.0]];
        let identity = |i: usize, j: usize| if i == j { 2.0 } else { 0.0 };
        let a = std::array::from_fn(|i| std::array::from_fn(|j| identity(i, j)));
        let near = |a: [[f64; 4]; 4], exact: [f64; 4]| {
            let mut found = b;
            solve(a, &mut found);
            assert!(found.iter().zip(exact).all(|(a, b)| (a[0] - b).abs() < 1e-14), "{found:?}");
        };
        near(a, [0.5, 1.0, 1.5, 2.0]);
        let mut singular = a;
        (singular[0][1], singular[1][0]) = (2.0, 2.0);
        singular[3][3] = f64::INFINITY;
        near(singular, [0.5, 0.0, 1.5, 0.0]);
    }

    /// Sums moved from four origins to one are those taken from there, and a linear function is found again.
    #[test]
    fn moved_sums_are_those_from_the_common_origin() {
        let mut random = Stream::Experiment.random(5, 0);
        let (mut parts, mut whole) = ([Moments::default(); 4], Moments::default());
        let linear = |x: f64, y: f64, single: f64, opacity: f64| {
            std::array::from_fn(|i| i as f64 + 0.3 * x - 0.2 * y + 2.0 * single - 5.0 * opacity)
        };
        for index in 0..200 {
            let [x, y, single, opacity] = std::array::from_fn(|_| 4.0 * uniform(&mut random));
            let (right, down) = (index % 2, index / 2 % 2);
            let (dx, dy) = (7.0 * right as f64, -3.0 * down as f64);
            let light = linear(x + dx, y + dy, single, opacity);
            let pixel = FeaturePixel { single, opacity, light };
            parts[2 * right + down].add_pixel(x, y, &pixel);
            whole.add_pixel(x + dx, y + dy, &pixel);
        }
        let mut moved = Moments::default();
        for right in 0..2 {
            let mut column = Moments::default();
            for down in 0..2 {
                column.add_moved(&parts[2 * right + down], 1, -3.0 * down as f64);
            }
            moved.add_moved(&column, 0, 7.0 * right as f64);
        }
        let close = |a: f64, b: f64, within: f64| assert!((a - b).abs() < within, "{a} {b}");
        for (a, b) in moved.products.as_flattened().iter().zip(whole.products.as_flattened()) {
            close(*a, *b, 1e-9);
        }
        for (a, b) in moved.with_light.as_flattened().iter().zip(whole.with_light.as_flattened()) {
            close(*a, *b, 1e-9);
        }
        let mut found = [0.0; LIGHTS];
        let pixel = FeaturePixel { single: 2.0, opacity: 1.0, light: [0.0; LIGHTS] };
        let fit = moved.fit();
        LightFit::blended(&fit, &fit, 0.25, [1.5, 1.5]).add_light(&mut found, 1.0, 3.0, &pixel);
        for (a, b) in found.iter().zip(linear(3.0, 1.5, 2.0, 1.0)) {
            // The damping takes a thousandth of the slopes.
            close(*a, b, 0.02);
        }
    }
}
