//! Distances along a ray in proportion to the inverse square of the distance to a place.
//!
//! p(t) = D / (angle (D^2 + (t - nearest)^2)), D the distance of the place from the ray (Kulla and Fajardo, *Importance Sampling Techniques
//! for Path Tracing in Participating Media*, CGF 31(4), 2012). The angle is measured from the far end of the ray's longer
//! side, where it is small, so that nothing cancels.

use crate::math::{DVec3, Ray, Span};

/// The angle over its largest value below which it is rounding, and distances are uniform.
const SMALLEST_ANGLE: f64 = 1e-6;

/// Sampling of one span of a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct EquiAngular {
    span: Span,
    /// Distance along the ray of its point nearest to the place, and distance of that from the place \[m\].
    nearest: f64,
    offset: f64,
    /// 1 where the longer side lies beyond the nearest point, else -1.
    side: f64,
    /// Angles of the span's start and end.
    start_angle: f64,
    end_angle: f64,
}

impl EquiAngular {
    /// About `place`.
    pub(super) fn new(ray: &Ray, span: Span, place: DVec3) -> Self {
        let to_place = place - ray.origin;
        let nearest = to_place.dot(ray.direction);
        // A ray through the place itself would leave nothing to sample.
        let floor = 1e-12 * to_place.length() + f64::MIN_POSITIVE;
        let offset = (to_place - ray.direction * nearest).length().max(floor);
        let (a, b) = (span.start - nearest, span.end - nearest);
        let side = if a + b < 0.0 { -1.0 } else { 1.0 };
        let (start_angle, end_angle) = (offset.atan2(side * a), offset.atan2(side * b));
        Self { span, nearest, offset, side, start_angle, end_angle }
    }

    /// The distance at quantile `u`.
    pub(super) fn sample_distance(&self, u: f64) -> f64 {
        if self.is_uniform() {
            return self.span.start + u * self.span.length();
        }
        let angle = self.start_angle + u * (self.end_angle - self.start_angle);
        let along = self.side * self.offset / angle.tan();
        (self.nearest + along).clamp(self.span.start, self.span.end)
    }

    /// Density of [`Self::sample_distance`] \[1/m\]; 0 outside the span.
    pub(super) fn pdf_distance(&self, distance: f64) -> f64 {
        if distance < self.span.start || distance > self.span.end {
            return 0.0;
        }
        if self.is_uniform() {
            return 1.0 / self.span.length();
        }
        let along = distance - self.nearest;
        let angle = (self.end_angle - self.start_angle).abs();
        self.offset / (angle * (self.offset * self.offset + along * along))
    }

    fn is_uniform(&self) -> bool {
        let angle = (self.end_angle - self.start_angle).abs();
        angle < SMALLEST_ANGLE * self.start_angle.max(self.end_angle)
            && self.span.length().is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The density is the derivative of the quantile, for near, far and grazing places, ahead and behind.
    #[test]
    fn distances_follow_their_density() {
        let ray = Ray::new(DVec3::ZERO, DVec3::Z);
        for end in [3.0, f64::INFINITY] {
            let span = Span::new(0.5, end);
            for place in [
                DVec3::new(0.3, 0.0, 1.0),
                DVec3::new(1e-6, 0.0, 2.0),
                DVec3::new(1e7, 0.0, -1e7),
                DVec3::new(0.2, 0.0, -40.0),
                DVec3::new(0.0, 0.01, 900.0),
                DVec3::new(0.0, 1e-9, -3.0),
            ] {
                let sampling = EquiAngular::new(&ray, span, place);
                assert!((sampling.sample_distance(0.0) - span.start).abs() < 1e-7, "{place}");
                for step in 1..50 {
                    let (u, h) = (f64::from(step) / 50.0, 1e-5);
                    let [low, middle, high] =
                        [u - h, u, u + h].map(|u| sampling.sample_distance(u));
                    let ratio = 2.0 * h / (high - low) / sampling.pdf_distance(middle);
                    assert!((ratio - 1.0).abs() < 2e-3, "{place} to {end} at {u}: {ratio}");
                }
                assert_eq!(sampling.pdf_distance(0.4), 0.0);
            }
        }
    }
}
