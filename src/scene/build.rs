//! Lights from a checked scene file to what the renderer uses: angles in radians, directions of unit length, other
//! files read.

use std::path::Path;

use super::environment;
use super::error::Problem;
use super::file::LightSection;
use crate::light::{
    DirectionalLight, Environment, Light, PointLight, QuadLight, SphereLight, SpotLight,
};

/// The light at key path `key`.
pub(super) fn light(section: &LightSection, key: &str, directory: &Path) -> Result<Light, Problem> {
    Ok(match *section {
        LightSection::Point { position, intensity } => {
            Light::Point(PointLight { position, intensity })
        }
        LightSection::Spot { position, look_at, intensity, cone_angle, falloff_angle } => {
            Light::Spot(SpotLight {
                position,
                axis: (look_at - position).normalize(),
                intensity,
                cone_angle: cone_angle.to_radians(),
                falloff_angle: falloff_angle.to_radians(),
            })
        }
        LightSection::Directional { direction, irradiance } => {
            Light::Directional(DirectionalLight { direction: direction.normalize(), irradiance })
        }
        LightSection::ConstantEnvironment { radiance } => {
            Light::Environment(Environment::Constant(radiance))
        }
        LightSection::ImageEnvironment { ref file, scale, rotation } => {
            let image = environment::read(&directory.join(file), scale, rotation.to_radians());
            let image = image.map_err(|text| Problem::new(format!("{key}.file"), text))?;
            Light::Environment(Environment::Image(Box::new(image)))
        }
        LightSection::Quad { corner, edge_u, edge_v, radiance, visible: is_visible } => {
            Light::Quad(QuadLight { corner, edge_u, edge_v, radiance, is_visible })
        }
        LightSection::Sphere { center, radius, radiance, visible: is_visible } => {
            Light::Sphere(SphereLight { center, radius, radiance, is_visible })
        }
    })
}
