//! Environment images of a scene.

use std::path::Path;

use crate::light::EnvironmentImage;
use crate::math::Rgb;

pub(super) fn read(file: &Path, _scale: Rgb, _rotation: f64) -> Result<EnvironmentImage, String> {
    Err(format!("{}: images cannot be read yet", file.display()))
}
