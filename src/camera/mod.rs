//! The camera: a pinhole, with a box pixel filter.

use crate::math::{DVec2, DVec3, Ray};

/// A pinhole camera. It may stand inside the medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Image width \[pixels\].
    pub width: usize,
    /// Image height \[pixels\].
    pub height: usize,
    position: DVec3,
    /// To the right edge of the image plane at distance 1.
    right: DVec3,
    /// To the top edge of the image plane at distance 1.
    up: DVec3,
    forward: DVec3,
}

impl Camera {
    /// A camera at `position` that looks at `look_at`; `vertical_fov` is the full angle over the image
    /// height, in (0, pi) \[rad\]. `None` if `up` is parallel to the view or `look_at` is `position`.
    pub fn look_at(
        position: DVec3,
        look_at: DVec3,
        up: DVec3,
        vertical_fov: f64,
        resolution: [usize; 2],
    ) -> Option<Self> {
        let forward = (look_at - position).try_normalize()?;
        let right = forward.cross(up.try_normalize()?).try_normalize()?;
        let half_height = (0.5 * vertical_fov).tan();
        let [width, height] = resolution;
        let half_width = half_height * width as f64 / height as f64;
        let up = right.cross(forward) * half_height;
        Some(Self { width, height, position, right: right * half_width, up, forward })
    }

    /// Where the image is taken from \[m\].
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The ray through image coordinates (`x`, `y`) in pixels; (0, 0) is the top left corner of the image.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let u = 2.0 * x / self.width as f64 - 1.0;
        let v = 1.0 - 2.0 * y / self.height as f64;
        let direction = (self.forward + self.right * u + self.up * v).normalize();
        Ray::new(self.position, direction)
    }

    /// Image coordinates of a place, the inverse of [`Camera::ray`]; `None` behind the camera.
    pub fn project(&self, place: DVec3) -> Option<DVec2> {
        let offset = place - self.position;
        let depth = offset.dot(self.forward);
        if depth <= 0.0 {
            return None;
        }
        let u = offset.dot(self.right) / (depth * self.right.length_squared());
        let v = offset.dot(self.up) / (depth * self.up.length_squared());
        let (width, height) = (self.width as f64, self.height as f64);
        Some(DVec2::new(0.5 * (u + 1.0) * width, 0.5 * (1.0 - v) * height))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projection_inverts_rays() {
        let position = DVec3::new(2.2, 1.8, 4.2);
        let camera =
            Camera::look_at(position, DVec3::ZERO, DVec3::Y, 0.66, [128, 72]).expect("a camera");
        for (x, y) in [(0.0, 0.0), (64.0, 36.0), (100.3, 7.9), (128.0, 72.0)] {
            let ray = camera.ray(x, y);
            let place = camera.project(ray.at(3.7)).expect("in front");
            assert!((place - DVec2::new(x, y)).length() < 1e-10, "{place}");
        }
        assert_eq!(camera.project(position + DVec3::Z), None);
        // The centre of the image looks at the point; the top of the image is up.
        assert!((camera.ray(64.0, 36.0).direction + position.normalize()).length() < 1e-12);
        assert!(camera.ray(64.0, 0.0).direction.y > camera.ray(64.0, 72.0).direction.y);
    }
}
