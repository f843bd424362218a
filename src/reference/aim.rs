//! Directions aimed at a point light inside the medium.
//!
//! The light that a ray at angle a from the light's direction scatters is I (pi - a) / (R sin a), R the distance of the light: the integral
//! of the inverse square along the ray. Over directions drawn by a phase function its variance is infinite (the integral of 1 / a diverges), so
//! that a path tracer needs directions of density p(a) = (pi - a) / (pi^3 sin a) as well: the isotropic case of Georgiev et al., *Joint
//! Importance Sampling of Low-Order Volumetric Scattering*, SIGGRAPH Asia 2013.

use std::f64::consts::PI;

use crate::math::{DVec3, Frame, Random, uniform};

/// Aimed along the unit vector `axis`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    axis: DVec3,
}

/// Sine below which a direction is the axis.
const SMALLEST_SINE: f64 = 1e-12;

impl Aim {
    /// From a place at another; `None` if they are the same.
    pub(super) fn new(from: DVec3, at: DVec3) -> Option<Self> {
        (at - from).try_normalize().map(|axis| Self { axis })
    }

    pub(super) fn sample_direction(&self, random: &mut Random) -> DVec3 {
        let angle = PI * (1.0 - (1.0 - uniform(random)).sqrt());
        let (sin, cos) = angle.sin_cos();
        Frame::about(self.axis).polar(cos, sin, 2.0 * PI * uniform(random)).normalize()
    }

    /// Density of [`Self::sample_direction`] \[1/sr\].
    pub(super) fn pdf_direction(&self, direction: DVec3) -> f64 {
        let sine = self.axis.cross(direction).length();
        let angle = sine.atan2(self.axis.dot(direction));
        (PI - angle) / (PI * PI * PI * sine.max(SMALLEST_SINE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Stream;
    use crate::math::square_maps::square_to_sphere;

    /// 1 / pdf has mean 4 pi, and the share within a cone is its exact probability.
    #[test]
    fn directions_follow_their_density() {
        let aim = Aim::new(DVec3::ONE, DVec3::new(1.3, -0.4, 0.2)).unwrap();
        let mut random = Stream::Experiment.random(4, 0);
        let count = 100_000;
        let (mut within, mut area) = (0.0, 0.0);
        for _ in 0..count {
            let direction = aim.sample_direction(&mut random);
            within +=
                f64::from(u8::from(direction.dot(aim.axis) > 0.5_f64.cos())) / f64::from(count);
            area += 1.0 / aim.pdf_direction(direction) / f64::from(count);
        }
        let exact = 1.0 - (1.0 - 0.5 / PI).powi(2);
        assert!((within - exact).abs() < 4.5 * (0.25 / f64::from(count)).sqrt(), "{within}");
        assert!((area / (4.0 * PI) - 1.0).abs() < 0.02, "{area}");
        let side = 500;
        let cells = (0..side * side).map(|i| {
            let u = glam::DVec2::new((i / side) as f64 + 0.5, (i % side) as f64 + 0.5);
            aim.pdf_direction(square_to_sphere(u / side as f64))
        });
        let total = cells.sum::<f64>() * 4.0 * PI / (side * side) as f64;
        assert!((total - 1.0).abs() < 0.01, "{total}");
    }
}
