//! `medium.bounds`

use serde::{Serialize, Serializer};

use super::table::Table;
use crate::math::DVec3;
use crate::medium::Bounds;
use crate::scene::error::Problem;

/// Smallest extent whose cube is still a number \[m\].
const MIN_EXTENT: f64 = 1e-30;

/// `medium.bounds` of a homogeneous medium: `{ min, max }`, `{ center, radius }`, or `"infinite"`.
///
/// | key | type | unit | default | range | meaning |
/// |---|---|---|---|---|---|
/// | `min` | 3 numbers | m | required for a box | | lowest corner of an axis-aligned box |
/// | `max` | 3 numbers | m | required for a box | above `min` on every axis | highest corner |
/// | `center` | 3 numbers | m | required for a ball | | centre of a ball |
/// | `radius` | number | m | required for a ball | above 0 | its radius |
///
/// `"infinite"` is for experiments; a render of it is refused.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
#[allow(missing_docs)]
pub enum BoundsSection {
    Box {
        min: DVec3,
        max: DVec3,
    },
    Sphere {
        center: DVec3,
        radius: f64,
    },
    #[serde(serialize_with = "serialize_infinite")]
    Infinite,
}

fn serialize_infinite<S: Serializer>(serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str("infinite")
}

const BOX_KEYS: [&str; 2] = ["min", "max"];
const SPHERE_KEYS: [&str; 2] = ["center", "radius"];

impl BoundsSection {
    /// Reads `bounds` of a medium.
    pub(super) fn read(medium: &Table) -> Result<Self, Problem> {
        if medium.is_text("bounds") {
            medium.choose("bounds", &[("infinite", ())])?;
            return Ok(Self::Infinite);
        }
        let table = medium.section("bounds")?;
        table.allow(&[BOX_KEYS, SPHERE_KEYS].concat())?;
        let is_box = BOX_KEYS.iter().any(|key| table.has(key));
        let is_sphere = SPHERE_KEYS.iter().any(|key| table.has(key));
        match (is_box, is_sphere) {
            (true, false) => Self::read_box(&table),
            (false, true) => Self::read_sphere(&table),
            (true, true) => {
                Err(medium
                    .problem("bounds", "give either min and max or center and radius, not both"))
            }
            (false, false) => Err(medium.problem(
                "bounds",
                "missing; expected { min = [x, y, z], max = [x, y, z] }, \
                 { center = [x, y, z], radius = r } or \"infinite\"",
            )),
        }
    }

    fn read_box(table: &Table) -> Result<Self, Problem> {
        let min: DVec3 = table.require("min")?;
        let max: DVec3 = table.require("max")?;
        let has_volume = (max - min).min_element() >= MIN_EXTENT;
        table.ensure("max", has_volume, &format!("must be above min = {min} on every axis"))?;
        Ok(Self::Box { min, max })
    }

    fn read_sphere(table: &Table) -> Result<Self, Problem> {
        let center = table.require("center")?;
        let radius = table.require("radius")?;
        table.ensure("radius", radius >= MIN_EXTENT, "must be above 0")?;
        Ok(Self::Sphere { center, radius })
    }

    pub(in crate::scene) fn bounds(&self) -> Bounds {
        match *self {
            Self::Box { min, max } => Bounds::Box { min, max },
            Self::Sphere { center, radius } => Bounds::Sphere { center, radius },
            Self::Infinite => Bounds::Infinite,
        }
    }
}
