//! Radiance from all around: constant, or a latitude-longitude image.
//!
//! An image is read one value a pixel, so that sampling pixels by luminance times solid angle follows
//! its radiance exactly.

use std::f64::consts::PI;

use crate::math::square_maps::square_to_sphere;
use crate::math::{DVec2, DVec3, Rgb, mean_channel};

/// Radiance from all around \[W/(m^2 sr)\].
#[derive(Debug)]
pub enum Environment {
    /// The same from everywhere.
    Constant(Rgb),
    /// From a latitude-longitude image.
    Image(Box<EnvironmentImage>),
}

/// A latitude-longitude image: row 0 is straight up (+y), the middle of a row looks along -z, and
/// columns run towards +x (to the right when looking along -z with +y up).
#[derive(Debug)]
pub struct EnvironmentImage {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
    rotation: f64,
    /// Running sum over pixels, row by row, of mean channel times solid angle.
    cumulative: Vec<f64>,
}

/// A direction drawn from an environment.
#[derive(Clone, Copy, Debug)]
pub struct DirectionSample {
    /// Unit direction from the scene to the environment.
    pub direction: DVec3,
    /// Its density \[1/sr\].
    pub pdf: f64,
}

impl Environment {
    /// Radiance that arrives from a direction (from the scene outward).
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        match self {
            Self::Constant(radiance) => *radiance,
            Self::Image(image) => image.radiance(direction),
        }
    }

    /// A direction by the radiance that arrives from it.
    pub fn sample_direction(&self, u: DVec2) -> DirectionSample {
        match self {
            Self::Constant(_) => DirectionSample { direction: square_to_sphere(u), pdf: 0.25 / PI },
            Self::Image(image) => image.sample_direction(u),
        }
    }

    /// Density of [`Environment::sample_direction`] \[1/sr\].
    pub fn pdf_direction(&self, direction: DVec3) -> f64 {
        match self {
            Self::Constant(_) => 0.25 / PI,
            Self::Image(image) => image.pdf_direction(direction),
        }
    }

    /// Mean over all directions of the radiance's mean channel.
    pub fn mean_radiance(&self) -> f64 {
        match self {
            Self::Constant(radiance) => mean_channel(*radiance),
            Self::Image(image) => image.total() / (4.0 * PI),
        }
    }
}

impl EnvironmentImage {
    /// Prepares an image for evaluation and sampling. `pixels` holds `width * height` finite, non-negative
    /// values, row-major and already scaled; `rotation` turns the image about +y, counter-clockwise seen
    /// from above \[rad\].
    pub fn new(width: usize, height: usize, pixels: Vec<[f32; 3]>, rotation: f64) -> Self {
        let mut sum = 0.0;
        let cumulative = pixels
            .iter()
            .enumerate()
            .map(|(index, pixel)| {
                let value = mean_channel(pixel_rgb(*pixel));
                sum += value * pixel_solid_angle(width, height, index / width.max(1));
                sum
            })
            .collect();
        Self { width, height, pixels, rotation, cumulative }
    }

    /// Radiance from a direction.
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        pixel_rgb(self.pixels[self.pixel_at(direction)])
    }

    /// Integral over all directions of the mean channel.
    fn total(&self) -> f64 {
        self.cumulative.last().copied().unwrap_or(0.0)
    }

    fn pixel_at(&self, direction: DVec3) -> usize {
        let azimuth = direction.x.atan2(-direction.z) + self.rotation;
        let column = (azimuth / (2.0 * PI) + 0.5).rem_euclid(1.0) * self.width as f64;
        let row = direction.y.clamp(-1.0, 1.0).acos() / PI * self.height as f64;
        let column = (column as usize).min(self.width - 1);
        let row = (row as usize).min(self.height - 1);
        row * self.width + column
    }

    fn sample_direction(&self, u: DVec2) -> DirectionSample {
        let total = self.total();
        if total <= 0.0 {
            return DirectionSample { direction: square_to_sphere(u), pdf: 0.25 / PI };
        }
        let target = u.x * total;
        let last = self.cumulative.len() - 1;
        let index = self.cumulative.partition_point(|&sum| sum <= target).min(last);
        let below = if index == 0 { 0.0 } else { self.cumulative[index - 1] };
        let weight = self.cumulative[index] - below;
        let within = if weight > 0.0 { ((target - below) / weight).min(1.0) } else { 0.5 };
        let (row, column) = (index / self.width, index % self.width);
        let (top, bottom) = row_heights(self.height, row);
        let y = top + (bottom - top) * u.y;
        let turn = (column as f64 + within) / self.width as f64 - 0.5;
        let azimuth = 2.0 * PI * turn - self.rotation;
        let ring = ((1.0 - y) * (1.0 + y)).max(0.0).sqrt();
        let direction = DVec3::new(ring * azimuth.sin(), y, -ring * azimuth.cos());
        let pdf = weight / total / pixel_solid_angle(self.width, self.height, row);
        DirectionSample { direction, pdf }
    }

    fn pdf_direction(&self, direction: DVec3) -> f64 {
        let total = self.total();
        if total <= 0.0 {
            return 0.25 / PI;
        }
        mean_channel(self.radiance(direction)) / total
    }
}

/// y of the upper and lower edge of a row.
fn row_heights(height: usize, row: usize) -> (f64, f64) {
    let edge = |r: usize| (PI * r as f64 / height as f64).cos();
    (edge(row), edge(row + 1))
}

/// Solid angle of each pixel of a row \[sr\].
fn pixel_solid_angle(width: usize, height: usize, row: usize) -> f64 {
    let (top, bottom) = row_heights(height, row);
    2.0 * PI / width as f64 * (top - bottom)
}

fn pixel_rgb(pixel: [f32; 3]) -> Rgb {
    Rgb::new(f64::from(pixel[0]), f64::from(pixel[1]), f64::from(pixel[2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image() -> Environment {
        let pixels = (0..8 * 4).map(|i| [(i % 5) as f32, (i % 3) as f32 * 0.5, 0.25]).collect();
        Environment::Image(Box::new(EnvironmentImage::new(8, 4, pixels, 0.7)))
    }

    #[test]
    fn directions_map_to_the_documented_pixels() {
        let mut pixels = vec![[0.0; 3]; 8 * 4];
        pixels[8 + 6] = [1.0, 0.0, 0.0];
        let environment = Environment::Image(Box::new(EnvironmentImage::new(8, 4, pixels, 0.0)));
        // Column 6 of 8 is a quarter turn right of the middle: +x; row 1 of 4 is above the horizon.
        let right = DVec3::new(1.0, 0.2, 0.01).normalize();
        assert_eq!(environment.radiance(right), Rgb::X);
        assert_eq!(environment.radiance(DVec3::NEG_Z), Rgb::ZERO);
    }

    /// Sampled directions give back the pdf they claim, and weighting by it integrates 1 and the radiance.
    #[test]
    fn samples_follow_the_pdf() {
        let environment = image();
        let side = 600;
        let (mut solid_angle, mut power) = (0.0, 0.0);
        let mut exact_power = 0.0;
        for i in 0..side * side {
            let u = DVec2::new((i / side) as f64 + 0.5, (i % side) as f64 + 0.5) / side as f64;
            let sample = environment.sample_direction(u);
            let claimed = environment.pdf_direction(sample.direction);
            assert!((claimed / sample.pdf - 1.0).abs() < 1e-9, "{u}");
            let weight = 1.0 / sample.pdf / (side * side) as f64;
            solid_angle += weight;
            power += mean_channel(environment.radiance(sample.direction)) * weight;
            exact_power += mean_channel(environment.radiance(square_to_sphere(u)));
        }
        exact_power *= 4.0 * PI / (side * side) as f64;
        assert!((solid_angle / (4.0 * PI) - 1.0).abs() < 1e-2, "{solid_angle}");
        assert!((power / exact_power - 1.0).abs() < 1e-2);
        assert!((power / (4.0 * PI * environment.mean_radiance()) - 1.0).abs() < 1e-9);
    }
}
