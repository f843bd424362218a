//! Density volumes of a scene.

use std::path::Path;

use super::error::Problem;
use crate::math::DAffine3;
use crate::medium::{Bounds, GridExtinction};

/// A density grid in the scene's world.
pub(super) struct Volume {
    pub bounds: Bounds,
    pub extinction: GridExtinction,
}

pub(super) fn read(
    file: &Path,
    _density: Option<&str>,
    _density_scale: f64,
    _transform: DAffine3,
    _warnings: &mut [String],
) -> Result<Volume, Problem> {
    Err(Problem::new("medium.file", format!("{}: volumes cannot be read yet", file.display())))
}
