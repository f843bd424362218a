//! Density volumes of a scene.

use std::path::Path;

use super::error::Problem;
use crate::math::DAffine3;
use crate::medium::{Bounds, MediumExtinction};

pub(super) fn read(
    file: &Path,
    _density: Option<&str>,
    _density_scale: f64,
    _transform: DAffine3,
    _warnings: &mut Vec<String>,
) -> Result<(Bounds, MediumExtinction), Problem> {
    let text = format!("{}: volumes cannot be read yet", file.display());
    Err(Problem::new("medium.file", text))
}
