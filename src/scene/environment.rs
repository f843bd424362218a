//! Environment images of a scene: read, checked pixel by pixel, and scaled to radiance.

use std::path::Path;

use crate::film::{RgbImage, read_rgb};
use crate::light::EnvironmentImage;
use crate::math::Rgb;

/// Reads an image whose pixels times `scale` are radiance \[W/(m^2 sr)\], turned by `rotation` \[rad\].
pub(super) fn read(file: &Path, scale: Rgb, rotation: f64) -> Result<EnvironmentImage, String> {
    let RgbImage { width, height, mut pixels } = read_rgb(file).map_err(|e| e.to_string())?;
    if pixels.is_empty() {
        return Err(format!("{} has no pixels", file.display()));
    }
    for (index, pixel) in pixels.iter_mut().enumerate() {
        let is_radiance = |radiance: f64| (0.0..=f64::from(f32::MAX)).contains(&radiance);
        let radiance = Rgb::from_array(pixel.map(f64::from)) * scale;
        if !radiance.to_array().into_iter().all(is_radiance) {
            return Err(format!(
                "{}: pixel (x = {}, y = {}) is {pixel:?}; radiance must be finite and not negative",
                file.display(),
                index % width,
                index / width,
            ));
        }
        *pixel = radiance.as_vec3().to_array();
    }
    Ok(EnvironmentImage::new(width, height, pixels, rotation))
}
