//! Lights with extent: a one-sided parallelogram and a sphere, sampled by the solid angle they fill, so
//! that no place is lit without bound.

use crate::light::Illumination;
use crate::math::square_maps::{cap_solid_angle, disc_to_cap, square_to_disc};
use crate::math::{DMat3, DVec2, DVec3, Frame, Ray, Rgb, SphericalTriangle};

/// A parallelogram that radiates to the side that `edge_u` x `edge_v` points to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadLight {
    /// One corner \[m\].
    pub corner: DVec3,
    /// \[m\]
    pub edge_u: DVec3,
    /// \[m\]
    pub edge_v: DVec3,
    /// \[W/(m^2 sr)\]
    pub radiance: Rgb,
    /// Whether the camera sees it.
    pub is_visible: bool,
}

/// A sphere that radiates from its whole surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereLight {
    /// \[m\]
    pub center: DVec3,
    /// \[m\]
    pub radius: f64,
    /// \[W/(m^2 sr)\]
    pub radiance: Rgb,
    /// Whether the camera sees it.
    pub is_visible: bool,
}

impl QuadLight {
    /// Normal of the shining side, as long as the area \[m^2\].
    pub fn area_normal(&self) -> DVec3 {
        self.edge_u.cross(self.edge_v)
    }

    /// A direction uniform in the solid angle of the quad, cut into two spherical triangles.
    pub fn sample_illumination(&self, place: DVec3, u: DVec2) -> Option<Illumination> {
        let normal = self.area_normal();
        if normal.dot(place - self.corner) <= 0.0 {
            return None;
        }
        let (p, q) = (self.corner + self.edge_u, self.corner + self.edge_v);
        let halves = [[self.corner, p, q], [p + self.edge_v, q, p]];
        let [first, second] = halves.map(|t| SphericalTriangle::seen_from(place, t));
        let of = |t: Option<SphericalTriangle>| t.map_or(0.0, |t| t.solid_angle);
        let solid_angle = of(first) + of(second);
        let position = u.x * solid_angle;
        let direction = if position < of(first) {
            first?.direction(DVec2::new(position / of(first), u.y))
        } else {
            let along = (position - of(first)) / of(second);
            second?.direction(DVec2::new(along.min(1.0), u.y))
        };
        let distance = normal.dot(self.corner - place) / normal.dot(direction);
        (distance > 0.0).then_some(Illumination {
            direction,
            distance,
            irradiance: self.radiance * solid_angle,
        })
    }

    /// Radiance seen along a ray that meets the shining side, and its distance.
    pub fn seen_along(&self, ray: &Ray) -> Option<(f64, Rgb)> {
        let normal = self.area_normal();
        let facing = normal.dot(ray.direction);
        if facing >= 0.0 {
            return None;
        }
        let distance = normal.dot(self.corner - ray.origin) / facing;
        let basis = DMat3::from_cols(self.edge_u, self.edge_v, normal);
        let local = basis.inverse() * (ray.at(distance) - self.corner);
        let within = (0.0..=1.0).contains(&local.x) && (0.0..=1.0).contains(&local.y);
        (distance > 0.0 && within).then_some((distance, self.radiance))
    }
}

impl SphereLight {
    /// A direction uniform in the cone that the sphere fills; from inside, uniform over all directions.
    pub fn sample_illumination(&self, place: DVec3, u: DVec2) -> Option<Illumination> {
        let to_center = self.center - place;
        let distance_squared = to_center.length_squared();
        // The surface shines outward only: inside it is dark.
        let sine_squared = self.radius * self.radius / distance_squared;
        if sine_squared >= 1.0 {
            return None;
        }
        let versine = sine_squared / (1.0 + (1.0 - sine_squared).sqrt());
        let (local, down) = disc_to_cap(square_to_disc(u), versine);
        let axis = to_center / distance_squared.sqrt();
        let direction = Frame::about(axis).to_world(local).normalize();
        let nearest = distance_squared.sqrt() * (1.0 - down);
        let half = self.radius * self.radius - distance_squared * down * (2.0 - down);
        let distance = nearest - half.max(0.0).sqrt();
        let irradiance = self.radiance * cap_solid_angle(versine);
        Some(Illumination { direction, distance, irradiance })
    }

    /// Radiance seen along a ray that meets the sphere from outside, and its distance.
    pub fn seen_along(&self, ray: &Ray) -> Option<(f64, Rgb)> {
        let to_center = self.center - ray.origin;
        let nearest = to_center.dot(ray.direction);
        let offset = to_center - ray.direction * nearest;
        let half_squared = self.radius * self.radius - offset.length_squared();
        let distance = nearest - half_squared.max(0.0).sqrt();
        (half_squared > 0.0 && distance > 0.0).then_some((distance, self.radiance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean_irradiance(sample: impl Fn(DVec2) -> Option<Illumination>, facing: DVec3) -> f64 {
        let side = 200;
        let mut sum = 0.0;
        for i in 0..side * side {
            let u = DVec2::new((i / side) as f64 + 0.5, (i % side) as f64 + 0.5) / side as f64;
            if let Some(light) = sample(u) {
                sum += light.irradiance.x * light.direction.dot(facing).max(0.0);
            }
        }
        sum / (side * side) as f64
    }

    /// A small plane facing a sphere of radius R at distance d receives pi L (R/d)^2.
    #[test]
    fn sphere_irradiance_is_exact() {
        let light = SphereLight {
            center: DVec3::new(0.0, 0.0, 3.0),
            radius: 1.0,
            radiance: Rgb::ONE,
            is_visible: true,
        };
        let measured = mean_irradiance(|u| light.sample_illumination(DVec3::ZERO, u), DVec3::Z);
        let exact = std::f64::consts::PI / 9.0;
        assert!((measured / exact - 1.0).abs() < 1e-4, "{measured} {exact}");
        let sample = light.sample_illumination(DVec3::ZERO, DVec2::splat(0.5)).unwrap();
        assert!((sample.distance - 2.0).abs() < 1e-12);
        assert!(light.sample_illumination(light.center, DVec2::ZERO).is_none());
    }

    /// Parallel facing square of half-side h at height z: the textbook form factor of a rectangle over a
    /// corner, four times.
    #[test]
    fn quad_irradiance_is_exact() {
        let light = QuadLight {
            corner: DVec3::new(-1.0, -1.0, 2.0),
            edge_u: DVec3::new(0.0, 2.0, 0.0),
            edge_v: DVec3::new(2.0, 0.0, 0.0),
            radiance: Rgb::ONE,
            is_visible: true,
        };
        let measured = mean_irradiance(|u| light.sample_illumination(DVec3::ZERO, u), DVec3::Z);
        let (a, b) = (0.5_f64, 0.5_f64);
        let term = |a: f64, b: f64| a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan();
        let exact = 4.0 * 0.5 * (term(a, b) + term(b, a));
        assert!((measured / exact - 1.0).abs() < 1e-4, "{measured} {exact}");
        assert!(light.sample_illumination(DVec3::new(0.0, 0.0, 3.0), DVec2::ZERO).is_none());
        let seen = light.seen_along(&Ray::new(DVec3::ZERO, DVec3::Z));
        assert_eq!(seen, Some((2.0, Rgb::ONE)));
    }
}
