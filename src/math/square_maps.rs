//! Area-preserving maps from the unit square, chosen so that compact cells of the square stay compact:
//! strata drawn on the square remain strata on the disc, the cap and the sphere.

use std::f64::consts::{FRAC_PI_4, PI};

use glam::{DVec2, DVec3};

/// The unit disc (Shirley and Chiu, *A Low Distortion Map Between Disk and Square*, 1997).
pub fn square_to_disc(u: DVec2) -> DVec2 {
    let p = 2.0 * u - DVec2::ONE;
    if p.x == 0.0 && p.y == 0.0 {
        return DVec2::ZERO;
    }
    let (radius, angle) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (p.x / p.y))
    };
    DVec2::new(angle.cos(), angle.sin()) * radius
}

/// The unit sphere, folding the square to an octahedron (Clarberg, *Fast Equal-Area Mapping of the
/// (Hemi)Sphere using SIMD*, 2008).
pub fn square_to_sphere(u: DVec2) -> DVec3 {
    let p = 2.0 * u - DVec2::ONE;
    let (x, y) = (p.x.abs(), p.y.abs());
    let signed_distance = 1.0 - (x + y);
    let radius = 1.0 - signed_distance.abs();
    let phi = if radius == 0.0 { 0.0 } else { ((y - x) / radius + 1.0) * FRAC_PI_4 };
    let z = (1.0 - radius * radius).copysign(signed_distance);
    let scale = radius * (2.0 - radius * radius).max(0.0).sqrt();
    DVec3::new((phi.cos() * scale).copysign(p.x), (phi.sin() * scale).copysign(p.y), z)
}

/// A cap of the unit sphere about +z: `versine` is 1 - cos of its half-angle, kept as such because the
/// cosine of a needle's angle is 1. Returns the direction and 1 - cos of its angle to the axis.
pub fn disc_to_cap(disc: DVec2, versine: f64) -> (DVec3, f64) {
    let down = disc.length_squared() * versine;
    // sin^2 = (1 - cos)(1 + cos), divided by the disc's own squared radius.
    let scale = (versine * (2.0 - down)).max(0.0).sqrt();
    (DVec3::new(disc.x * scale, disc.y * scale, 1.0 - down), down)
}

/// The hemisphere about +z with density cos / pi (Malley's method).
pub fn disc_to_cosine_hemisphere(disc: DVec2) -> DVec3 {
    let z = (1.0 - disc.length_squared()).max(0.0).sqrt();
    DVec3::new(disc.x, disc.y, z)
}

/// 1 - cos(angle), without cancellation for small angles.
pub fn versine(angle: f64) -> f64 {
    let half = (0.5 * angle).sin();
    2.0 * half * half
}

/// The angle whose 1 - cos is given.
pub fn versine_angle(versine: f64) -> f64 {
    2.0 * (0.5 * versine).sqrt().min(1.0).asin()
}

/// The solid angle of a cap \[sr\].
pub fn cap_solid_angle(versine: f64) -> f64 {
    2.0 * PI * versine
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moments of a map over a fine midpoint grid of the square.
    fn mean(side: usize, f: impl Fn(DVec2) -> f64) -> f64 {
        let cells = side * side;
        let at = |i: usize| (i as f64 + 0.5) / side as f64;
        (0..cells).map(|i| f(DVec2::new(at(i / side), at(i % side)))).sum::<f64>() / cells as f64
    }

    #[test]
    fn disc_moments_are_those_of_a_uniform_disc() {
        assert!(mean(512, |u| square_to_disc(u).x).abs() < 1e-12);
        assert!((mean(512, |u| square_to_disc(u).length_squared()) - 0.5).abs() < 1e-5);
        assert!((mean(512, |u| square_to_disc(u).x.powi(2)) - 0.25).abs() < 1e-5);
        assert!((mean(512, |u| square_to_disc(u).x.powi(4)) - 0.125).abs() < 1e-5);
    }

    #[test]
    fn sphere_points_are_unit_and_have_uniform_moments() {
        for u in [DVec2::ZERO, DVec2::splat(0.5), DVec2::new(1.0, 0.3), DVec2::new(0.25, 0.75)] {
            assert!((square_to_sphere(u).length() - 1.0).abs() < 1e-12, "{u}");
        }
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.36, 0.48, 0.8)] {
            let along = |u| square_to_sphere(u).dot(axis);
            assert!(mean(512, along).abs() < 1e-5);
            assert!((mean(512, |u| along(u).powi(2)) - 1.0 / 3.0).abs() < 1e-5);
            assert!((mean(512, |u| along(u).powi(4)) - 0.2).abs() < 1e-5);
        }
    }

    #[test]
    fn a_needle_keeps_its_angle() {
        let angle = 1e-6_f64;
        let (direction, down) = disc_to_cap(DVec2::new(1.0, 0.0), versine(angle));
        assert!((down / (0.5 * angle * angle) - 1.0).abs() < 1e-9);
        assert!((direction.x / angle - 1.0).abs() < 1e-9);
    }

    #[test]
    fn cosine_hemisphere_has_mean_cosine_two_thirds() {
        let cosine = mean(512, |u| disc_to_cosine_hemisphere(square_to_disc(u)).z);
        assert!((cosine - 2.0 / 3.0).abs() < 1e-4);
    }
}
