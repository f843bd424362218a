//! `medium.phase`

use serde::Serialize;

use super::table::Table;
use crate::medium::Phase;
use crate::scene::error::Problem;

/// `medium.phase`: where scattered light goes.
///
/// | key | type | unit | default | range | meaning |
/// |---|---|---|---|---|---|
/// | `kind` | `"isotropic"`, `"henyey-greenstein"` | | `"isotropic"` | | phase function |
/// | `g` | number | | required for Henyey-Greenstein | (-1, 1) | mean cosine; above 0 is forward |
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[allow(missing_docs)]
pub enum PhaseSection {
    Isotropic,
    HenyeyGreenstein { g: f64 },
}

const KINDS: [(&str, &[&str]); 2] =
    [("isotropic", &["kind"]), ("henyey-greenstein", &["kind", "g"])];

impl PhaseSection {
    /// Reads `phase` of a medium.
    pub(super) fn read(medium: &Table) -> Result<Self, Problem> {
        let table = medium.section("phase")?;
        let kinds = KINDS.map(|(kind, _)| (kind, kind));
        let kind = table.choose("kind", &kinds)?.unwrap_or("isotropic");
        table.allow_for(kind, &KINDS)?;
        if kind == "isotropic" {
            return Ok(Self::Isotropic);
        }
        let g: f64 = table.require("g")?;
        table.ensure("g", g > -1.0 && g < 1.0, "must lie in (-1, 1)")?;
        Ok(Self::HenyeyGreenstein { g })
    }

    pub(in crate::scene) fn phase(&self) -> Phase {
        match *self {
            Self::HenyeyGreenstein { g } if g != 0.0 => Phase::HenyeyGreenstein { g },
            _ => Phase::Isotropic,
        }
    }
}
