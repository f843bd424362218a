//! From a checked scene file to what the renderer uses: angles in radians, directions of unit length, other
//! files read.

use std::path::Path;

use super::error::Problem;
use super::file::{LightSection, MediumSection};
use super::grid_reader::GridReader;
use super::grid_use::GridUse;
use super::hash::FileHashes;
use super::volume::{self, DensityVolume, VolumeRules};
use super::{emission, environment};
use crate::light::{
    DirectionalLight, Environment, Light, PointLight, QuadLight, SphereLight, SpotLight,
};
use crate::math::Rgb;
use crate::medium::{ChromaticExtinction, Medium, MediumExtinction, UniformExtinction};

/// The medium, with `warnings` of what had to be mended in its file, the `grids` of that file that it uses, and the
/// file's hash.
pub(super) fn medium(
    section: &MediumSection,
    directory: &Path,
    rules: &VolumeRules,
    warnings: &mut Vec<String>,
    grids: &mut Vec<GridUse>,
    hashes: &mut FileHashes,
) -> Result<Medium, Problem> {
    match section {
        MediumSection::Homogeneous { bounds, sigma_t, albedo, phase } => Ok(Medium {
            bounds: bounds.bounds(),
            extinction: homogeneous_extinction(*sigma_t),
            albedo: *albedo,
            color: None,
            phase: phase.phase(),
            emissivity: None,
        }),
        MediumSection::Vdb {
            file,
            density,
            density_scale,
            sdf_to_fog,
            precision,
            albedo,
            color,
            phase,
            emission,
            transform,
        } => {
            let source = volume::open(&directory.join(file), rules)?;
            hashes.insert("medium.file".into(), source.content_hash());
            let transform = transform.affine();
            let mut reader = GridReader { source: &source, transform, rules, warnings, grids };
            let density = DensityVolume {
                grid: density.as_deref(),
                sdf_to_fog: *sdf_to_fog,
                precision: *precision,
                density_scale: *density_scale,
            };
            let (bounds, extinction) = density.read(&mut reader)?;
            let color = color.as_deref().map(|name| reader.read_color(name).map(Box::new));
            let (color, phase) = (color.transpose()?, phase.phase());
            let medium =
                Medium { bounds, extinction, albedo: *albedo, color, phase, emissivity: None };
            match emission {
                Some(section) => emission::read(section, medium, &mut reader),
                None => Ok(medium),
            }
        }
    }
}

fn homogeneous_extinction(sigma_t: Rgb) -> MediumExtinction {
    if sigma_t == Rgb::splat(sigma_t.x) {
        MediumExtinction::Uniform(UniformExtinction { sigma_t: sigma_t.x })
    } else {
        MediumExtinction::Chromatic(ChromaticExtinction { sigma_t })
    }
}

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
        LightSection::Quad { corner, edge_u, edge_v, radiance } => {
            Light::Quad(QuadLight { corner, edge_u, edge_v, radiance })
        }
        LightSection::Sphere { center, radius, radiance } => {
            Light::Sphere(SphereLight { center, radius, radiance })
        }
    })
}
