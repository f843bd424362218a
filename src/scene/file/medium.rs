//! `[medium]`

use std::path::PathBuf;

use serde::{Serialize, Serializer};

use super::bounds::BoundsSection;
use super::emission::EmissionSection;
use super::phase::PhaseSection;
use super::table::{OneOrThree, Table};
use super::transform::TransformSection;
use crate::math::Rgb;
use crate::medium::grid::BrickPrecision;
use crate::scene::error::Problem;

/// `[medium]`: what scatters and absorbs; one of two kinds. All it is surrounded by is empty space.
///
/// Several volumes are as many `[[medium]]` (in JSON, a list), of either kind. They may overlap: there sigma_t and emission add up, and
/// each collision is with one of the volumes, by its share of sigma_t, with that volume's albedo and phase function. Each needs bounds, and one
/// sigma_t for all channels. Grids that several of them name are in memory once, whatever their transforms. Where volumes scatter by different
/// phase functions light is gathered from the photon map, whatever `render.gather` says; every ray looks at every volume.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[allow(missing_docs)]
pub enum MediumSection {
    /// `kind = "homogeneous"`: the same everywhere inside bounds.
    ///
    /// | key | type | unit | default | range | meaning |
    /// |---|---|---|---|---|---|
    /// | `preset` | text | | none | | a [`Preset`](crate::scene::Preset), which fills in `sigma_t`, `albedo` and `phase` |
    /// | `bounds` | table or `"infinite"` | | required | | see [`BoundsSection`] |
    /// | `sigma_t` | number or RGB | 1/m | required | at least 0 | extinction |
    /// | `albedo` | number or RGB | | required | \[0, 1\] | sigma_s / sigma_t |
    /// | `phase` | table | | isotropic | | see [`PhaseSection`] |
    Homogeneous { bounds: BoundsSection, sigma_t: Rgb, albedo: Rgb, phase: PhaseSection },
    /// `kind = "vdb"`: extinction from a density grid, `sigma_t = density_scale * value`.
    ///
    /// | key | type | unit | default | range | meaning |
    /// |---|---|---|---|---|---|
    /// | `preset` | text | | none | | a [`Preset`](crate::scene::Preset), which fills in `density_scale`, `albedo` and `phase` |
    /// | `file` | path | | required | | an OpenVDB file, relative to the scene file |
    /// | `density` | text | | `"density"`, else the only float grid | | name of the grid |
    /// | `density_scale` | number | 1/m per grid value | 1 | at least 0 | extinction of value 1 |
    /// | `sdf_to_fog` | boolean | | false | | fill a level set with fog: density 0 on its surface, 1 at depth |
    /// | `precision` | text | | `"single"` | | `"single"` or `"half"`: see [`BrickPrecision`] |
    /// | `albedo` | number or RGB | | required; 1 with `color` | \[0, 1\] | sigma_s / sigma_t |
    /// | `color` | text | | none | | name of a grid of vectors (vec3s or vec3d), linear RGB: the albedo is `albedo` times its value, each channel clamped to \[0, 1\] |
    /// | `phase` | table | | isotropic | | see [`PhaseSection`] |
    /// | `transform` | table | | identity | | see [`TransformSection`] |
    ///
    /// Grids may have transforms of their own. Each is trilinear between voxels, its background beyond the active ones:
    /// where that is 0, a colour fades to black over the last voxel.
    ///
    /// [`EmissionSection`] has the keys that make it glow.
    Vdb {
        file: PathBuf,
        #[serde(skip_serializing_if = "Option::is_none")]
        density: Option<String>,
        density_scale: f64,
        sdf_to_fog: bool,
        #[serde(serialize_with = "serialize_precision")]
        precision: BrickPrecision,
        albedo: Rgb,
        #[serde(skip_serializing_if = "Option::is_none")]
        color: Option<String>,
        phase: PhaseSection,
        #[serde(flatten, skip_serializing_if = "Option::is_none")]
        emission: Option<Box<EmissionSection>>,
        transform: TransformSection,
    },
}

const HOMOGENEOUS_KEYS: [&str; 6] = ["kind", "preset", "bounds", "sigma_t", "albedo", "phase"];

const VDB_KEYS: [&str; 11] = [
    "kind",
    "preset",
    "file",
    "density",
    "density_scale",
    "sdf_to_fog",
    "precision",
    "albedo",
    "color",
    "phase",
    "transform",
];

const PRECISIONS: [(&str, BrickPrecision); 2] =
    [("single", BrickPrecision::Single), ("half", BrickPrecision::Half)];

fn serialize_precision<S: Serializer>(
    precision: &BrickPrecision,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let words = PRECISIONS.iter().filter(|(_, known)| known == precision).map(|(word, _)| word);
    serializer.collect_str(&words.copied().collect::<String>())
}

impl MediumSection {
    /// Reads all media of a scene: a table, or a list of them.
    pub(super) fn read_all(root: &Table) -> Result<Vec<Self>, Problem> {
        let tables = root.section_or_sections("medium")?;
        root.ensure("medium", !tables.is_empty(), "a scene needs a medium")?;
        let media: Vec<Self> = tables.iter().map(Self::read).collect::<Result<_, _>>()?;
        if media.len() > 1 {
            tables.iter().zip(&media).try_for_each(|(table, medium)| medium.check_shared(table))?;
        }
        Ok(media)
    }

    /// What one of several volumes must be.
    fn check_shared(&self, table: &Table) -> Result<(), Problem> {
        let Self::Homogeneous { bounds, sigma_t, .. } = self else { return Ok(()) };
        let is_bounded = *bounds != BoundsSection::Infinite;
        table.ensure("bounds", is_bounded, "one of several media needs a box or a ball")?;
        let is_grey = *sigma_t == Rgb::splat(sigma_t.x);
        let rule = "must be one number where there are several media; the albedo may have colour";
        table.ensure("sigma_t", is_grey, rule)
    }

    fn read(table: &Table) -> Result<Self, Problem> {
        let vdb_keys = [&VDB_KEYS[..], &EmissionSection::KEYS].concat();
        let kinds = [("homogeneous", &HOMOGENEOUS_KEYS[..]), ("vdb", &vdb_keys[..])];
        let kind = table.require_choice("kind", &kinds.map(|(kind, _)| (kind, kind)))?;
        table.allow_for(kind, &kinds)?;
        if kind == "vdb" { Self::read_vdb(table) } else { Self::read_homogeneous(table) }
    }

    /// Whether it has light of its own.
    pub(super) fn emits(&self) -> bool {
        matches!(self, Self::Vdb { emission: Some(_), .. })
    }

    fn read_homogeneous(table: &Table) -> Result<Self, Problem> {
        let sigma_t = table.require::<OneOrThree>("sigma_t")?.0;
        table.ensure("sigma_t", sigma_t.min_element() >= 0.0, "must not be below 0")?;
        Ok(Self::Homogeneous {
            bounds: BoundsSection::read(table)?,
            sigma_t,
            albedo: read_albedo(table)?,
            phase: PhaseSection::read(table)?,
        })
    }

    fn read_vdb(table: &Table) -> Result<Self, Problem> {
        let density_scale = table.get_or("density_scale", 1.0)?;
        table.ensure("density_scale", density_scale >= 0.0, "must not be below 0")?;
        let color = table.get::<String>("color")?;
        Ok(Self::Vdb {
            file: table.require::<String>("file")?.into(),
            density: table.get("density")?,
            density_scale,
            sdf_to_fog: table.get_or("sdf_to_fog", false)?,
            precision: table.choose("precision", &PRECISIONS)?.unwrap_or_default(),
            albedo: if color.is_some() {
                read_albedo_or_white(table)?
            } else {
                read_albedo(table)?
            },
            color,
            phase: PhaseSection::read(table)?,
            emission: EmissionSection::read(table)?.map(Box::new),
            transform: TransformSection::read(table)?,
        })
    }
}

fn read_albedo(table: &Table) -> Result<Rgb, Problem> {
    let albedo = table.require::<OneOrThree>("albedo")?.0;
    check_albedo(table, albedo)
}

fn read_albedo_or_white(table: &Table) -> Result<Rgb, Problem> {
    let albedo = table.get_or("albedo", OneOrThree(Rgb::ONE))?.0;
    check_albedo(table, albedo)
}

fn check_albedo(table: &Table, albedo: Rgb) -> Result<Rgb, Problem> {
    let in_range = albedo.min_element() >= 0.0 && albedo.max_element() <= 1.0;
    table.ensure("albedo", in_range, "must lie in [0, 1]")?;
    Ok(albedo)
}
