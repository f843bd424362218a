//! Pixels that hold a point light, and those near it.
//!
//! Single scattering near the image of a point light grows as the inverse of the distance rho from it on the image: finite over
//! a pixel, but of infinite variance under uniform samples. Polar samples about the light's image have density
//! 1 / rho and take the peak away; in a pixel near the light's they fill the angle that it is seen under from there.

use std::f64::consts::PI;

use crate::math::DVec2;

/// A sub-pixel position with its weight: the inverse of its density over the unit pixel.
#[derive(Clone, Copy, Debug)]
pub struct WeightedPlace {
    /// In pixels from the image's top left corner.
    pub position: DVec2,
    /// Mean 1 over samples.
    pub weight: f64,
}

/// A pixel seen from the image of a light.
#[derive(Clone, Copy, Debug)]
pub struct PolarPixel {
    center: DVec2,
    corner: DVec2,
    /// The angles at which the pixel begins, and that it fills.
    first: f64,
    angle: f64,
}

impl PolarPixel {
    /// The pixel whose top left corner is `corner`, from `center`.
    pub fn new(center: DVec2, corner: DVec2) -> Self {
        let inward = corner + DVec2::splat(0.5) - center;
        if holds(center, corner) {
            return Self { center, corner, first: 0.0, angle: 2.0 * PI };
        }
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        let (low, high) = corners.iter().fold((0.0f64, 0.0f64), |(low, high), offset| {
            let angle = inward.angle_to(corner + *offset - center);
            (low.min(angle), high.max(angle))
        });
        Self { center, corner, first: inward.to_angle() + low, angle: high - low }
    }

    /// The place at a point of the unit square: an angle, and a distance along it.
    pub fn sample(&self, u: DVec2) -> WeightedPlace {
        let direction = DVec2::from_angle(self.first + self.angle * u.x);
        let [near, far] = chord(self.center - self.corner, direction);
        let rho = near + (far - near) * u.y;
        let position = self.center + direction * rho;
        WeightedPlace { position, weight: self.angle * rho * (far - near) }
    }
}

/// Whether a place lies in the pixel whose top left corner is `corner`.
pub fn holds(place: DVec2, corner: DVec2) -> bool {
    (place - corner).cmpge(DVec2::ZERO).all() && (place - corner).cmplt(DVec2::ONE).all()
}

/// Where a ray enters and leaves the unit square; twice the same where it misses.
fn chord(origin: DVec2, direction: DVec2) -> [f64; 2] {
    let (mut near, mut far) = (0.0f64, f64::INFINITY);
    for axis in 0..2 {
        let inverse = 1.0 / direction[axis];
        if inverse.is_finite() {
            let (a, b) = (-origin[axis] * inverse, (1.0 - origin[axis]) * inverse);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
    }
    [near, far.max(near)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights integrate 1, x and 1 / rho to the error of a lattice rule, from within and from without.
    #[test]
    fn polar_samples_cover_the_pixel() {
        let corner = DVec2::new(4.0, 7.0);
        for center in [
            DVec2::new(4.2, 7.9),
            DVec2::new(3.999, 7.3),
            DVec2::new(6.0, 9.5),
            DVec2::new(4.5, 3.0),
        ] {
            let pixel = PolarPixel::new(center, corner);
            let count = 200_000;
            let (mut area, mut mean_x, mut peak) = (0.0, 0.0, 0.0);
            for index in 0..count {
                let u = (f64::from(index) + 0.5) / f64::from(count);
                let v = (f64::from(index) * 0.618_033_988_749_894_9).fract();
                let sample = pixel.sample(DVec2::new(u, v));
                let within = sample.position - corner;
                assert!(within.cmpge(DVec2::splat(-1e-9)).all(), "{within}");
                assert!(within.cmple(DVec2::splat(1.0 + 1e-9)).all(), "{within}");
                let share = sample.weight / f64::from(count);
                area += share;
                mean_x += share * within.x;
                peak += share / (sample.position - center).length().max(1e-300);
            }
            assert!((area - 1.0).abs() < 1e-4, "{center}: {area}");
            assert!((mean_x - 0.5).abs() < 1e-4, "{center}: {mean_x}");
            // int 1 / rho over a rectangle with one corner at the light: a asinh(b / a) + b asinh(a / b).
            let quarter = |x: f64, y: f64| {
                let (a, b) = (x.abs(), y.abs());
                let integral = a * (b / a).asinh() + b * (a / b).asinh();
                x.signum() * y.signum() * integral
            };
            let (low, high) = (corner - center, corner + DVec2::ONE - center);
            let exact = quarter(high.x, high.y) - quarter(low.x, high.y) - quarter(high.x, low.y)
                + quarter(low.x, low.y);
            assert!((peak / exact - 1.0).abs() < 1e-4, "{center}: {peak} {exact}");
        }
    }
}
