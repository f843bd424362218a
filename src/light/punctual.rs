//! Lights without extent: point, spot, and directional.

use std::f64::consts::PI;

use crate::light::Illumination;
use crate::math::square_maps::{versine, versine_angle};
use crate::math::{DVec3, Ray, Rgb, Span};

/// A point that radiates the same in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// \[m\]
    pub position: DVec3,
    /// \[W/sr\]
    pub intensity: Rgb,
}

/// A point that radiates within a cone: full intensity within `falloff_angle` of the axis, then linear in
/// the angle down to 0 at `cone_angle`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLight {
    /// \[m\]
    pub position: DVec3,
    /// Unit direction of the axis.
    pub axis: DVec3,
    /// On the axis \[W/sr\].
    pub intensity: Rgb,
    /// Half-angle of the cone, in (0, pi) \[rad\].
    pub cone_angle: f64,
    /// In \[0, `cone_angle`\] \[rad\].
    pub falloff_angle: f64,
}

/// Parallel light from infinitely far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// Unit direction of travel.
    pub direction: DVec3,
    /// On a plane facing the light \[W/m^2\].
    pub irradiance: Rgb,
}

impl PointLight {
    /// I / d^2 at a place.
    pub fn illumination(&self, place: DVec3) -> Option<Illumination> {
        inverse_square(self.position, place, |_| self.intensity)
    }
}

impl SpotLight {
    /// I(angle) / d^2 at a place.
    pub fn illumination(&self, place: DVec3) -> Option<Illumination> {
        inverse_square(self.position, place, |direction| {
            self.intensity * self.falloff(self.angle_to(direction))
        })
        .filter(|illumination| illumination.irradiance != Rgb::ZERO)
    }

    /// The part of a ray that can be inside the cone; `None` if nothing is. A cone of 90 degrees or more
    /// is not convex, and answers the whole span.
    pub fn lit_span(&self, ray: &Ray, span: Span) -> Option<Span> {
        if self.cone_angle >= 0.5 * PI {
            return Some(span);
        }
        // Points with (axis . w)^2 = cos^2 w^2, w = origin + t direction - position, on the forward nappe.
        let offset = ray.origin - self.position;
        let (sin, cos) = self.cone_angle.sin_cos();
        let (along, along_offset) = (self.axis.dot(ray.direction), self.axis.dot(offset));
        let across = ray.direction - self.axis * along;
        let across_offset = offset - self.axis * along_offset;
        // Inside where f(t) = cos^2 |across|^2 - sin^2 along^2 <= 0: written in sin, it keeps needles' digits.
        let a = cos * cos * across.length_squared() - sin * sin * along * along;
        let b = cos * cos * across.dot(across_offset) - sin * sin * along * along_offset;
        let c =
            cos * cos * across_offset.length_squared() - sin * sin * along_offset * along_offset;
        let apex = -along_offset / along;
        let forward = if along > 0.0 {
            Span::new(apex, f64::INFINITY)
        } else if along < 0.0 {
            Span::new(f64::NEG_INFINITY, apex)
        } else {
            Span::new(f64::NEG_INFINITY, f64::INFINITY)
        };
        let ahead = span.intersect(forward)?;
        let discriminant = b * b - a * c;
        if discriminant <= 0.0 {
            // No crossing: outside all along, or (a < 0) inside all along the forward nappe.
            return (a < 0.0).then_some(ahead);
        }
        let q = -(b + discriminant.sqrt().copysign(b));
        let (first, second) = (q / a, c / q);
        let (low, high) = (first.min(second), first.max(second));
        let inside = if a > 0.0 {
            Span::new(low, high)
        } else if along > 0.0 {
            Span::new(high, f64::INFINITY)
        } else {
            Span::new(f64::NEG_INFINITY, low)
        };
        ahead.intersect(inside)
    }

    /// Intensity at an angle from the axis, over that on the axis.
    pub fn falloff(&self, angle: f64) -> f64 {
        if angle <= self.falloff_angle {
            1.0
        } else if angle < self.cone_angle {
            (self.cone_angle - angle) / (self.cone_angle - self.falloff_angle)
        } else {
            0.0
        }
    }

    /// Angle between the axis and a unit direction, exact also for needles: by the chord, not the cosine.
    pub fn angle_to(&self, direction: DVec3) -> f64 {
        2.0 * (0.5 * (direction - self.axis).length()).min(1.0).asin()
    }

    /// Solid angle that, at full intensity, would carry the same power \[sr\]: the falloff integrated by the
    /// midpoint rule in 1 - cos.
    pub fn effective_solid_angle(&self) -> f64 {
        let (inner, outer) = (versine(self.falloff_angle), versine(self.cone_angle));
        let steps = 4096;
        let width = (outer - inner) / f64::from(steps);
        let ring = |i: i32| {
            let down = inner + (f64::from(i) + 0.5) * width;
            self.falloff(versine_angle(down))
        };
        let falling: f64 = (0..steps).map(ring).sum::<f64>() * width;
        2.0 * PI * (inner + falling)
    }
}

impl DirectionalLight {
    /// The same everywhere.
    pub fn illumination(&self) -> Illumination {
        Illumination {
            direction: -self.direction,
            distance: f64::INFINITY,
            irradiance: self.irradiance,
        }
    }
}

/// The illumination by a point; `intensity` is asked for the direction of travel. `None` on the point itself.
fn inverse_square(
    position: DVec3,
    place: DVec3,
    intensity: impl Fn(DVec3) -> Rgb,
) -> Option<Illumination> {
    let to_light = position - place;
    let distance = to_light.length();
    if distance == 0.0 {
        return None;
    }
    let direction = to_light / distance;
    let irradiance = intensity(-direction) / distance / distance;
    Some(Illumination { direction, distance, irradiance })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Stream, uniform};

    #[test]
    fn spot_falls_linearly_in_the_angle_and_needles_keep_their_solid_angle() {
        let mut spot = SpotLight {
            position: DVec3::ZERO,
            axis: DVec3::Z,
            intensity: Rgb::ONE,
            cone_angle: 0.2,
            falloff_angle: 0.1,
        };
        let at = |angle: f64| DVec3::new(angle.sin(), 0.0, angle.cos());
        assert!((spot.falloff(spot.angle_to(at(0.15))) - 0.5).abs() < 1e-12);
        let exact = 2.0
            * PI
            * (versine(0.1) + ((0.1 * 0.1_f64.cos()) - (0.2_f64.sin() - 0.1_f64.sin())) / 0.1);
        assert!((spot.effective_solid_angle() / exact - 1.0).abs() < 1e-7);
        spot.cone_angle = 1e-6;
        spot.falloff_angle = 1e-6;
        assert!((spot.effective_solid_angle() / (PI * 1e-12) - 1.0).abs() < 1e-9);
        assert_eq!(spot.illumination(at(2e-6)), None);
        assert!(spot.illumination(at(5e-7)).is_some());
    }

    /// The lit span against the angle at many points of random rays, inside and outside the cone.
    #[test]
    fn the_lit_span_is_where_the_angle_is_within_the_cone() {
        let mut random = Stream::Experiment.random(9, 0);
        let mut draw =
            || DVec3::from_array(std::array::from_fn(|_| 2.0 * uniform(&mut random) - 1.0));
        let (mut lit, mut rays) = (0, 0);
        for case in 0..4000 {
            let spot = SpotLight {
                position: draw(),
                axis: draw().normalize(),
                intensity: Rgb::ONE,
                cone_angle: [0.02, 0.3, 1.0, 1.5][case % 4],
                falloff_angle: 0.01,
            };
            let ray = Ray::new(draw() * 2.0, draw().normalize());
            let span = Span::new(0.0, 5.0);
            let found = spot.lit_span(&ray, span);
            rays += 1;
            for step in 0..200 {
                let distance = 0.0125 + 0.025 * f64::from(step);
                let angle = spot.angle_to((ray.at(distance) - spot.position).normalize());
                let within = found.is_some_and(|s| s.start <= distance && distance <= s.end);
                if (angle - spot.cone_angle).abs() > 1e-9 {
                    assert_eq!(within, angle < spot.cone_angle, "case {case} at {distance}");
                }
                lit += i32::from(within);
            }
        }
        assert!(lit > 10 * rays, "some of it is lit");
    }
}
