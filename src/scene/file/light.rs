//! `[[light]]`

use std::path::PathBuf;

use serde::Serialize;

use super::table::{OneOrThree, Table};
use crate::math::{DVec3, Rgb};
use crate::scene::error::Problem;

/// `[[light]]`: one light, and what its layer is called.
///
/// | key | type | unit | default | range | meaning |
/// |---|---|---|---|---|---|
/// | `name` | text | | its number, from 0 | letters, digits, `_`, `-`, a letter first; not `medium` | with `--layers lights` its layer is `light.NAME`; lights of one name share it |
///
/// The other keys are those of [`LightSection`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedLight {
    /// Name of its layer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The light.
    #[serde(flatten)]
    pub light: LightSection,
}

impl NamedLight {
    pub(super) fn read(table: &Table) -> Result<Self, Problem> {
        let name: Option<String> = table.get("name")?;
        let fits = name.as_deref().is_none_or(is_layer_name);
        table.ensure("name", fits, NAME_RULE)?;
        Ok(Self { name, light: LightSection::read(table)? })
    }
}

const NAME_RULE: &str = "must begin with a letter and hold up to 64 letters, digits, `_` and `-` (`medium` is the medium's own light)";

/// Whether a layer can be called so: numbers are those of lights without a name.
fn is_layer_name(name: &str) -> bool {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.len() <= 64
        && name.chars().all(is_part)
        && name != "medium"
}

/// `[[light]]`: one light, of one of six kinds. Light of zero power is legal.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[allow(missing_docs)]
pub enum LightSection {
    /// `kind = "point"`: the same in all directions from a point.
    ///
    /// | key | type | unit | default | range | meaning |
    /// |---|---|---|---|---|---|
    /// | `position` | 3 numbers | m | required | | |
    /// | `intensity` | number or RGB | W/sr | required | at least 0 | |
    Point { position: DVec3, intensity: Rgb },
    /// `kind = "spot"`: a point that shines within a cone.
    ///
    /// | key | type | unit | default | range | meaning |
    /// |---|---|---|---|---|---|
    /// | `position` | 3 numbers | m | required | | |
    /// | `look_at` | 3 numbers | m | required | not `position` | a point on the axis |
    /// | `intensity` | number or RGB | W/sr | required | at least 0 | on the axis |
    /// | `cone_angle` | number | degrees | required | 0.001 to below 180 | half-angle; dark outside |
    /// | `falloff_angle` | number | degrees | `cone_angle` | 0 to `cone_angle` | half-angle of full intensity, from where it falls linearly in the angle |
    Spot { position: DVec3, look_at: DVec3, intensity: Rgb, cone_angle: f64, falloff_angle: f64 },
    /// `kind = "directional"`: parallel light from infinitely far.
    ///
    /// | key | type | unit | default | range | meaning |
    /// |---|---|---|---|---|---|
    /// | `direction` | 3 numbers | | required | not zero | where the light travels to |
    /// | `irradiance` | number or RGB | W/m^2 | required | at least 0 | on a plane that faces the light |
    Directional { direction: DVec3, irradiance: Rgb },
    /// `kind = "environment"`: constant radiance from all around.
    ///
    /// | key | type | unit | default | range | meaning |
    /// |---|---|---|---|---|---|
    /// | `radiance` | number or RGB | W/(m^2 sr) | this or `file` | at least 0 | |
    #[serde(rename = "environment")]
    ConstantEnvironment { radiance: Rgb },
    /// `kind = "environment"` with `file`: radiance from a latitude-longitude image, +y up.
    ///
    /// | key | type | unit | default | range | meaning |
    /// |---|---|---|---|---|---|
    /// | `file` | path | | this or `radiance` | | an EXR image, relative to the scene file |
    /// | `scale` | number or RGB | W/(m^2 sr) per pixel value | 1 | at least 0 | factor on the pixels |
    /// | `rotation` | number | degrees | 0 | | turns the image about +y, counter-clockwise from above |
    #[serde(rename = "environment")]
    ImageEnvironment { file: PathBuf, scale: Rgb, rotation: f64 },
    /// `kind = "quad"`: a parallelogram that shines to one side, along `edge_u` x `edge_v`.
    ///
    /// | key | type | unit | default | range | meaning |
    /// |---|---|---|---|---|---|
    /// | `corner` | 3 numbers | m | required | | |
    /// | `edge_u`, `edge_v` | 3 numbers | m | required | not parallel | the edges that leave the corner |
    /// | `radiance` | number or RGB | W/(m^2 sr) | required | at least 0 | |
    /// | `visible` | bool | | true | | whether the camera sees it |
    Quad {
        corner: DVec3,
        edge_u: DVec3,
        edge_v: DVec3,
        radiance: Rgb,
        #[serde(skip_serializing_if = "is_visible")]
        visible: bool,
    },
    /// `kind = "sphere"`: a sphere that shines outwards.
    ///
    /// | key | type | unit | default | range | meaning |
    /// |---|---|---|---|---|---|
    /// | `center` | 3 numbers | m | required | | |
    /// | `radius` | number | m | required | above 0 | |
    /// | `radiance` | number or RGB | W/(m^2 sr) | required | at least 0 | |
    /// | `visible` | bool | | true | | whether the camera sees it |
    Sphere {
        center: DVec3,
        radius: f64,
        radiance: Rgb,
        #[serde(skip_serializing_if = "is_visible")]
        visible: bool,
    },
}

const KINDS: [(&str, &[&str]); 6] = [
    ("point", &["name", "kind", "position", "intensity"]),
    ("spot", &["name", "kind", "position", "look_at", "intensity", "cone_angle", "falloff_angle"]),
    ("directional", &["name", "kind", "direction", "irradiance"]),
    ("environment", &["name", "kind", "radiance", "file", "scale", "rotation"]),
    ("quad", &["name", "kind", "corner", "edge_u", "edge_v", "radiance", "visible"]),
    ("sphere", &["name", "kind", "center", "radius", "radiance", "visible"]),
];

/// Narrowest cone whose solid angle does not vanish by rounding \[degrees\].
const MIN_CONE_ANGLE: f64 = 0.001;

/// Sine of the angle below which the edges of a quad count as parallel.
const PARALLEL: f64 = 1e-9;

impl LightSection {
    pub(super) fn read(table: &Table) -> Result<Self, Problem> {
        let kind = table.require_choice("kind", &KINDS.map(|(kind, _)| (kind, kind)))?;
        table.allow_for(kind, &KINDS)?;
        match kind {
            "point" => Ok(Self::Point {
                position: table.require("position")?,
                intensity: read_strength(table, "intensity")?,
            }),
            "spot" => Self::read_spot(table),
            "directional" => Self::read_directional(table),
            "environment" => Self::read_environment(table),
            "quad" => Self::read_quad(table),
            _ => Self::read_sphere(table),
        }
    }

    fn read_spot(table: &Table) -> Result<Self, Problem> {
        let position: DVec3 = table.require("position")?;
        let look_at: DVec3 = table.require("look_at")?;
        let has_axis = (look_at - position).try_normalize().is_some();
        table.ensure("look_at", has_axis, "must not be the light's position")?;
        let cone_angle: f64 = table.require("cone_angle")?;
        let is_cone = (MIN_CONE_ANGLE..180.0).contains(&cone_angle);
        table.ensure("cone_angle", is_cone, "must lie in [0.001, 180) degrees")?;
        let falloff_angle: f64 = table.get_or("falloff_angle", cone_angle)?;
        let rule = format!("must lie between 0 and cone_angle = {cone_angle}");
        table.ensure("falloff_angle", (0.0..=cone_angle).contains(&falloff_angle), &rule)?;
        let intensity = read_strength(table, "intensity")?;
        Ok(Self::Spot { position, look_at, intensity, cone_angle, falloff_angle })
    }

    fn read_directional(table: &Table) -> Result<Self, Problem> {
        let direction: DVec3 = table.require("direction")?;
        table.ensure("direction", direction.try_normalize().is_some(), "must have a length")?;
        Ok(Self::Directional { direction, irradiance: read_strength(table, "irradiance")? })
    }

    fn read_environment(table: &Table) -> Result<Self, Problem> {
        let Some(file) = table.get::<String>("file")? else {
            if let Some(key) = ["scale", "rotation"].into_iter().find(|key| table.has(key)) {
                return Err(table.problem(key, "applies to an image only; give file too"));
            }
            let constant = || table.problem("radiance", "missing key; give radiance or file");
            table.has("radiance").then_some(()).ok_or_else(constant)?;
            return Ok(Self::ConstantEnvironment { radiance: read_strength(table, "radiance")? });
        };
        if table.has("radiance") {
            return Err(table.problem("radiance", "give either radiance or file, not both"));
        }
        let scale = table.get_or("scale", OneOrThree(Rgb::ONE))?.0;
        table.ensure("scale", scale.min_element() >= 0.0, "must not be below 0")?;
        let rotation = table.get_or("rotation", 0.0)?;
        Ok(Self::ImageEnvironment { file: file.into(), scale, rotation })
    }

    fn read_quad(table: &Table) -> Result<Self, Problem> {
        let edge_u: DVec3 = table.require("edge_u")?;
        let edge_v: DVec3 = table.require("edge_v")?;
        let area = edge_u.cross(edge_v).length();
        let is_flat = area == 0.0 || area < PARALLEL * edge_u.length() * edge_v.length();
        table.ensure("edge_v", !is_flat, "must not be zero or parallel to edge_u")?;
        let corner = table.require("corner")?;
        let radiance = read_strength(table, "radiance")?;
        let visible = table.get_or("visible", true)?;
        Ok(Self::Quad { corner, edge_u, edge_v, radiance, visible })
    }

    fn read_sphere(table: &Table) -> Result<Self, Problem> {
        let radius = table.require("radius")?;
        table.ensure("radius", radius > 0.0, "must be above 0")?;
        let center = table.require("center")?;
        let radiance = read_strength(table, "radiance")?;
        let visible = table.get_or("visible", true)?;
        Ok(Self::Sphere { center, radius, radiance, visible })
    }
}

/// What a light that says nothing is, and needs no word where a scene is written or hashed.
fn is_visible(visible: &bool) -> bool {
    *visible
}

fn read_strength(table: &Table, key: &str) -> Result<Rgb, Problem> {
    let strength = table.require::<OneOrThree>(key)?.0;
    table.ensure(key, strength.min_element() >= 0.0, "must not be below 0")?;
    Ok(strength)
}
