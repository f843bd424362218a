//! `[camera]`

use serde::Serialize;

use super::table::Table;
use crate::camera::Camera;
use crate::math::DVec3;
use crate::scene::error::Problem;

/// Longest side of an image \[pixels\].
const MAX_SIDE: u64 = 16384;

/// An 8K image is just below; its film takes 7 GB while it is made.
const MAX_PIXELS: u64 = 1 << 25;

/// Sine of the angle below which two directions count as parallel.
const PARALLEL: f64 = 1e-9;

/// `[camera]`: a pinhole, which may stand inside the medium.
///
/// | key | type | unit | default | range | meaning |
/// |---|---|---|---|---|---|
/// | `position` | 3 numbers | m | required | | the pinhole |
/// | `look_at` | 3 numbers | m | required | not `position` | a point in the middle of the image |
/// | `up` | 3 numbers | | `[0, 1, 0]` | not along the view | direction that the image shows upright |
/// | `vertical_fov` | number | degrees | 35 | (0, 180) | full angle over the image height |
/// | `resolution` | 2 integers | pixels | `[640, 360]` | 1 to 16384, together at most 2^25 | width, height; row 0 is the top |
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct CameraSection {
    pub position: DVec3,
    pub look_at: DVec3,
    pub up: DVec3,
    pub vertical_fov: f64,
    pub resolution: [u64; 2],
}

impl CameraSection {
    pub(super) fn read(table: &Table) -> Result<Self, Problem> {
        table.allow(&["position", "look_at", "up", "vertical_fov", "resolution"])?;
        let section = Self {
            position: table.require("position")?,
            look_at: table.require("look_at")?,
            up: table.get_or("up", DVec3::Y)?,
            vertical_fov: table.get_or("vertical_fov", 35.0)?,
            resolution: table.get_or("resolution", [640, 360])?,
        };
        let fov = section.vertical_fov;
        table.ensure("vertical_fov", fov > 0.0 && fov < 180.0, "must lie in (0, 180) degrees")?;
        let in_range = section.resolution.iter().all(|side| (1..=MAX_SIDE).contains(side));
        table.ensure("resolution", in_range, "each side must lie in 1 to 16384 pixels")?;
        let pixels = section.resolution.iter().product::<u64>();
        table.ensure("resolution", pixels <= MAX_PIXELS, "must have at most 2^25 pixels")?;
        section.check_view(table)?;
        Ok(section)
    }

    fn check_view(&self, table: &Table) -> Result<(), Problem> {
        let view = (self.look_at - self.position).try_normalize();
        let view =
            view.ok_or_else(|| table.problem("look_at", "must not be the camera's position"))?;
        let up = self.up.try_normalize();
        let up = up.ok_or_else(|| table.problem("up", "must be a direction, found no length"))?;
        let is_parallel = view.cross(up).length() < PARALLEL;
        table.ensure("up", !is_parallel, "must not be parallel to the view (look_at - position)")
    }

    /// The camera itself.
    pub(in crate::scene) fn camera(&self) -> Result<Camera, Problem> {
        let resolution = self.resolution.map(|side| side as usize);
        let fov = self.vertical_fov.to_radians();
        Camera::look_at(self.position, self.look_at, self.up, fov, resolution)
            .ok_or_else(|| Problem::new("camera.up", "must not be parallel to the view"))
    }
}
