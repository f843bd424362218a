//! Directions in four bytes.

use crate::math::DVec3;

/// A unit direction, folded to an octahedron and kept as two 16-bit numbers (Meyer et al., *On Floating-Point
/// Normal Vectors*, 2010): within 7e-5 rad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PackedDirection(u16, u16);

impl PackedDirection {
    /// Packs a unit direction.
    pub fn new(direction: [f32; 3]) -> Self {
        let [x, y, z] = direction;
        let scale = 1.0 / (x.abs() + y.abs() + z.abs());
        let (mut u, mut v) = (x * scale, y * scale);
        if z < 0.0 {
            (u, v) = ((1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v));
        }
        let quantise = |t: f32| ((t * 0.5 + 0.5) * 65535.0).round() as u16;
        Self(quantise(u), quantise(v))
    }

    /// The unit direction.
    #[inline]
    pub fn unpack(self) -> DVec3 {
        let unit = |q: u16| f64::from(q) * (2.0 / 65535.0) - 1.0;
        let (u, v) = (unit(self.0), unit(self.1));
        let z = 1.0 - u.abs() - v.abs();
        let fold = (-z).max(0.0);
        DVec3::new(u - fold.copysign(u), v - fold.copysign(v), z).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::square_maps::square_to_sphere;

    #[test]
    fn directions_survive_within_the_stated_angle() {
        let mut worst = 0.0_f64;
        for i in 0..40_000 {
            let u = glam::DVec2::new((i % 200) as f64 + 0.31, (i / 200) as f64 + 0.77) / 200.0;
            let direction = square_to_sphere(u);
            let unpacked = PackedDirection::new(direction.as_vec3().to_array()).unpack();
            worst = worst.max((unpacked - direction).length());
        }
        assert!(worst < 7e-5, "{worst}");
        for axis in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
            let unpacked = PackedDirection::new(axis.as_vec3().to_array()).unpack();
            assert!((unpacked - axis).length() < 7e-5, "{axis}");
        }
    }
}
