//! The camera: a pinhole, with a box pixel filter.

use crate::math::{DVec3, Ray};

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

    /// The ray through image coordinates (`x`, `y`) in pixels; (0, 0) is the top left corner of the image.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let u = 2.0 * x / self.width as f64 - 1.0;
        let v = 1.0 - 2.0 * y / self.height as f64;
        let direction = (self.forward + self.right * u + self.up * v).normalize();
        Ray::new(self.position, direction)
    }
}
