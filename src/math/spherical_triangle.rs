//! Uniform directions within a spherical triangle (Arvo, *Stratified Sampling of Spherical Triangles*, 1995).

use glam::{DVec2, DVec3};

/// The triangle of directions between three unit vectors.
#[derive(Clone, Copy, Debug)]
pub struct SphericalTriangle {
    vertices: [DVec3; 3],
    /// Angle at the first vertex, by its cosine and sine.
    first_angle: DVec2,
    /// Cosine of the side between the first two vertices.
    first_side_cosine: f64,
    /// Its area \[sr\].
    pub solid_angle: f64,
}

impl SphericalTriangle {
    /// The triangle seen from `eye`; `None` where it has no solid angle.
    pub fn seen_from(eye: DVec3, corners: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = corners.map(|p| (p - eye).normalize_or_zero());
        // Van Oosterom and Strackee 1983: no cancellation for small triangles.
        let triple = a.dot(b.cross(c)).abs();
        let solid_angle = 2.0 * triple.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        let (towards_b, towards_c) = (a.cross(b), a.cross(c));
        let scale = towards_b.length() * towards_c.length();
        if !(solid_angle > 0.0 && scale > 0.0) {
            return None;
        }
        let cosine = towards_b.dot(towards_c) / scale;
        let sine = towards_b.cross(towards_c).length() / scale;
        Some(Self {
            vertices: [a, b, c],
            first_angle: DVec2::new(cosine, sine),
            first_side_cosine: a.dot(b),
            solid_angle,
        })
    }

    /// The direction at `u` in the unit square; density 1 / `solid_angle`.
    pub fn direction(&self, u: DVec2) -> DVec3 {
        let [a, b, c] = self.vertices;
        let DVec2 { x: cos_alpha, y: sin_alpha } = self.first_angle;
        let (sin_area, cos_area) = (u.x * self.solid_angle).sin_cos();
        // Arvo's s and t: sine and cosine of (sub-area - alpha).
        let s = sin_area * cos_alpha - cos_area * sin_alpha;
        let t = cos_area * cos_alpha + sin_area * sin_alpha;
        let (p, q) = (t - cos_alpha, s + sin_alpha * self.first_side_cosine);
        let numerator = (q * t - p * s) * cos_alpha - q;
        let denominator = (q * s + p * t) * sin_alpha;
        let cos_side =
            if denominator.abs() > 0.0 { (numerator / denominator).clamp(-1.0, 1.0) } else { 1.0 };
        let towards_c = (c - a * a.dot(c)).normalize_or_zero();
        let new_c = a * cos_side + towards_c * (1.0 - cos_side * cos_side).max(0.0).sqrt();
        let z = 1.0 - u.y * (1.0 - new_c.dot(b));
        let towards_new_c = (new_c - b * b.dot(new_c)).normalize_or_zero();
        (b * z + towards_new_c * ((1.0 - z) * (1.0 + z)).max(0.0).sqrt()).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean direction over a fine grid against the exact vector area of the triangle,
    /// half the sum over sides of their arc times their pole.
    #[test]
    fn directions_are_uniform_and_the_solid_angle_is_right() {
        let eye = DVec3::new(0.1, 0.2, -1.0);
        let corners =
            [DVec3::new(0.0, 0.0, 0.3), DVec3::new(1.5, 0.1, 0.2), DVec3::new(0.2, 1.0, -0.4)];
        let triangle = SphericalTriangle::seen_from(eye, corners).unwrap();
        let side = 400;
        let mut mean = DVec3::ZERO;
        for i in 0..side * side {
            let u = DVec2::new((i / side) as f64 + 0.5, (i % side) as f64 + 0.5) / side as f64;
            mean += triangle.direction(u);
        }
        let measured = mean * triangle.solid_angle / (side * side) as f64;
        let [a, b, c] = triangle.vertices;
        let arc = |p: DVec3, q: DVec3| {
            let cross = p.cross(q);
            cross.normalize() * 0.5 * cross.length().atan2(p.dot(q))
        };
        let vector_area = arc(a, b) + arc(b, c) + arc(c, a);
        assert!((measured.length() - vector_area.length()).abs() < 1e-5);
        assert!(measured.normalize().dot(vector_area.normalize()).abs() > 1.0 - 1e-9);
    }

    #[test]
    fn an_octant_has_half_pi_and_a_degenerate_triangle_none() {
        let octant = SphericalTriangle::seen_from(DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::Z]);
        assert!((octant.unwrap().solid_angle - std::f64::consts::FRAC_PI_2).abs() < 1e-14);
        let flat = [DVec3::X, DVec3::Y, DVec3::X + DVec3::Y];
        assert!(SphericalTriangle::seen_from(DVec3::ZERO, flat).is_none());
    }
}
