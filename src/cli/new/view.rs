//! A camera that has a box in its frame.

use photonvdb::camera::Camera;
use photonvdb::math::{DVec3, Ray};

/// Full angle over the image height \[degrees\].
pub const VERTICAL_FOV: f64 = 35.0;

/// Share of the frame that the box takes along the side it fills.
const FILLED: f64 = 0.88;

/// Longer side of the image \[pixels\].
const LONG_SIDE: f64 = 640.0;

/// Narrowest and widest image, width over height.
const ASPECTS: [f64; 2] = [9.0 / 16.0, 16.0 / 9.0];

/// The keys of `[camera]`, rounded as they are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    pub position: DVec3,
    pub look_at: DVec3,
    pub up: DVec3,
    /// Width and height \[pixels\].
    pub resolution: [usize; 2],
    /// To the right of the image.
    right: DVec3,
}

impl View {
    /// Looks at the corners of a box, a little from the right and from above, with `up` upright.
    pub fn around(corners: &[DVec3], up: DVec3) -> Self {
        let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let size = (high - low).max_element();
        let center = rounded(0.5 * (low + high), size);
        // The front is +z where y is up, and -y where z is.
        let front = DVec3::X.cross(up);
        let forward = -(front + 0.3 * DVec3::X + 0.18 * up).normalize();
        let right = forward.cross(up).normalize();
        let upright = right.cross(forward);
        let extent = |axis: DVec3| {
            corners.iter().map(|corner| (*corner - center).dot(axis).abs()).fold(0.0, f64::max)
        };
        let aspect = (extent(right) / extent(upright)).clamp(ASPECTS[0], ASPECTS[1]);
        let resolution = resolution(aspect);
        let aspect = resolution[0] as f64 / resolution[1] as f64;
        let half_height = FILLED * (0.5 * VERTICAL_FOV.to_radians()).tan();
        let half_width = half_height * aspect;
        // A corner at depth d + f along the view is inside where it is off the axis by less than the frame there.
        let distance = corners.iter().map(|corner| {
            let offset = *corner - center;
            let across = offset.dot(right).abs() / half_width;
            let along = offset.dot(upright).abs() / half_height;
            across.max(along) - offset.dot(forward)
        });
        let distance = distance.fold(0.0, f64::max);
        let position = rounded(center - forward * distance, size);
        Self { position, look_at: center, up, resolution, right }
    }

    /// A direction of the scene, given to the right, up and away from the camera.
    pub fn direction(&self, right: f64, up: f64, away: f64) -> DVec3 {
        let level = self.up.cross(self.right);
        rounded(self.right * right + self.up * up + level * away, 1.0)
    }

    /// Rays through a lattice of pixels over all of the frame.
    pub fn rays(&self, per_side: usize) -> Vec<Ray> {
        let size = [per_side; 2];
        let fov = VERTICAL_FOV.to_radians();
        // A square lattice over a frame that need not be square: stretched by the camera's own resolution.
        let Some(camera) =
            Camera::look_at(self.position, self.look_at, self.up, fov, self.resolution)
        else {
            return Vec::new();
        };
        let step = |axis: usize| self.resolution[axis] as f64 / size[axis] as f64;
        let place = |index: usize, axis: usize| (index as f64 + 0.5) * step(axis);
        (0..per_side * per_side)
            .map(|cell| camera.ray(place(cell % per_side, 0), place(cell / per_side, 1)))
            .collect()
    }
}

fn resolution(aspect: f64) -> [usize; 2] {
    let short = |share: f64| (LONG_SIDE * share / 16.0).round() as usize * 16;
    if aspect >= 1.0 {
        [LONG_SIDE as usize, short(1.0 / aspect)]
    } else {
        [short(aspect), LONG_SIDE as usize]
    }
}

/// Rounded to a ten-thousandth of `size`, or a little less.
pub fn rounded(place: DVec3, size: f64) -> DVec3 {
    let step = 10_f64.powi(size.log10().floor() as i32 - 3);
    place.map(|x| {
        let steps = (x / step).round();
        // A quotient of a whole power of ten is the nearest number to what is meant, a product is not.
        let near = if step < 1.0 { steps / (1.0 / step).round() } else { steps * step };
        if near.is_finite() { near + 0.0 } else { x }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(low: DVec3, size: DVec3) -> Vec<DVec3> {
        let bit = |corner: usize, axis: usize| (corner >> axis & 1) as f64;
        (0..8).map(|c| low + size * DVec3::new(bit(c, 0), bit(c, 1), bit(c, 2))).collect()
    }

    #[test]
    fn boxes_of_any_size_and_place_are_inside_and_fill_the_frame() {
        for (low, size) in [
            (DVec3::splat(-1.0), DVec3::splat(2.0)),
            (DVec3::new(1e6, -3.0, 2e5), DVec3::new(10.0, 300.0, 2.0)),
            (DVec3::splat(1e-7), DVec3::new(4e-6, 1e-6, 1e-6)),
            (DVec3::ZERO, DVec3::new(9e4, 2e3, 9e4)),
        ] {
            for up in [DVec3::Y, DVec3::Z] {
                let corners = corners(low, size);
                let view = View::around(&corners, up);
                let fov = VERTICAL_FOV.to_radians();
                let [width, height] = view.resolution;
                let camera =
                    Camera::look_at(view.position, view.look_at, up, fov, [width, height]).unwrap();
                let mut largest = 0.0_f64;
                for corner in corners {
                    let pixel = camera.project(corner).expect("in front");
                    let across = (2.0 * pixel.x / width as f64 - 1.0).abs();
                    let along = (2.0 * pixel.y / height as f64 - 1.0).abs();
                    largest = largest.max(across).max(along);
                }
                assert!((0.8..0.95).contains(&largest), "{low} {size} {up}: {largest}");
            }
        }
    }

    #[test]
    fn numbers_are_written_short() {
        assert_eq!(rounded(DVec3::new(0.123_456, -7.0, -1e-9), 2.5).to_string(), "[0.123, -7, 0]");
        assert_eq!(rounded(DVec3::new(123_456.7, 0.0, 0.0), 2e5).x, 123_500.0);
    }
}
