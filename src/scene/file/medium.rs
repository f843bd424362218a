//! `[medium]`

use std::path::PathBuf;

use serde::{Serialize, Serializer};

use super::bounds::BoundsSection;
use super::phase::PhaseSection;
use super::table::{OneOrThree, Table};
use super::transform::TransformSection;
use crate::math::Rgb;
use crate::medium::grid::BrickPrecision;
use crate::scene::error::Problem;

/// `[medium]`: what scatters and absorbs; one of two kinds. All it is surrounded by is empty space.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[allow(missing_docs)]
pub enum MediumSection {
    /// `kind = "homogeneous"`: the same everywhere inside bounds.
    ///
    /// | key | type | unit | default | range | meaning |
    /// |---|---|---|---|---|---|
    /// | `bounds` | table or `"infinite"` | | required | | see [`BoundsSection`] |
    /// | `sigma_t` | number or RGB | 1/m | required | at least 0 | extinction |
    /// | `albedo` | number or RGB | | required | \[0, 1\] | sigma_s / sigma_t |
    /// | `phase` | table | | isotropic | | see [`PhaseSection`] |
    Homogeneous { bounds: BoundsSection, sigma_t: Rgb, albedo: Rgb, phase: PhaseSection },
    /// `kind = "vdb"`: extinction from a density grid, `sigma_t = density_scale * value`.
    ///
    /// | key | type | unit | default | range | meaning |
    /// |---|---|---|---|---|---|
    /// | `file` | path | | required | | an OpenVDB file, relative to the scene file |
    /// | `density` | text | | `"density"`, else the only float grid | | name of the grid |
    /// | `density_scale` | number | 1/m per grid value | 1 | at least 0 | extinction of value 1 |
    /// | `sdf_to_fog` | boolean | | false | | fill a level set with fog: density 0 on its surface, 1 at depth |
    /// | `precision` | text | | `"single"` | | `"single"` or `"half"`: see [`BrickPrecision`] |
    /// | `albedo` | number or RGB | | required | \[0, 1\] | sigma_s / sigma_t |
    /// | `phase` | table | | isotropic | | see [`PhaseSection`] |
    /// | `transform` | table | | identity | | see [`TransformSection`] |
    ///
    /// The keys of blackbody emission (`temperature`, `temperature_offset`, `temperature_scale`,
    /// `emission_scale`) are reserved and refused.
    Vdb {
        file: PathBuf,
        #[serde(skip_serializing_if = "Option::is_none")]
        density: Option<String>,
        density_scale: f64,
        sdf_to_fog: bool,
        #[serde(serialize_with = "serialize_precision")]
        precision: BrickPrecision,
        albedo: Rgb,
        phase: PhaseSection,
        transform: TransformSection,
    },
}

const EMISSION_KEYS: [&str; 4] =
    ["temperature", "temperature_offset", "temperature_scale", "emission_scale"];

const KINDS: [(&str, &[&str]); 2] = [
    ("homogeneous", &["kind", "bounds", "sigma_t", "albedo", "phase"]),
    (
        "vdb",
        &[
            "kind",
            "file",
            "density",
            "density_scale",
            "sdf_to_fog",
            "precision",
            "albedo",
            "phase",
            "transform",
        ],
    ),
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
    pub(super) fn read(table: &Table) -> Result<Self, Problem> {
        let kind = table.require_choice("kind", &KINDS.map(|(kind, _)| (kind, kind)))?;
        if let Some(key) = EMISSION_KEYS.into_iter().find(|key| table.has(key)) {
            let text = "blackbody emission is not available yet; remove the key to render the \
                        medium without its own light";
            return Err(table.problem(key, text));
        }
        table.allow_for(kind, &KINDS)?;
        if kind == "vdb" { Self::read_vdb(table) } else { Self::read_homogeneous(table) }
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
        Ok(Self::Vdb {
            file: table.require::<String>("file")?.into(),
            density: table.get("density")?,
            density_scale,
            sdf_to_fog: table.get_or("sdf_to_fog", false)?,
            precision: table.choose("precision", &PRECISIONS)?.unwrap_or_default(),
            albedo: read_albedo(table)?,
            phase: PhaseSection::read(table)?,
            transform: TransformSection::read(table)?,
        })
    }
}

fn read_albedo(table: &Table) -> Result<Rgb, Problem> {
    let albedo = table.require::<OneOrThree>("albedo")?.0;
    let in_range = albedo.min_element() >= 0.0 && albedo.max_element() <= 1.0;
    table.ensure("albedo", in_range, "must lie in [0, 1]")?;
    Ok(albedo)
}
