//! `medium.phase`

use serde::Serialize;

use super::table::Table;
use crate::medium::{LARGEST_DROPLET, Lobe, Phase, SMALLEST_DROPLET};
use crate::scene::error::Problem;

/// `medium.phase`: where scattered light goes, by `kind`. cos is the cosine of the angle by which it is scattered, 1 straight on.
///
/// | kind | density \[1/sr\] |
/// |---|---|
/// | `"isotropic"` (default) | 1 / 4 pi |
/// | `"henyey-greenstein"` | HG(g) = (1 - g²) / (4 pi (1 + g² - 2 g cos)^(3/2)) |
/// | `"double-henyey-greenstein"` | weight HG(g1) + (1 - weight) HG(g2) |
/// | `"draine"` | HG(g) (1 + alpha cos²) / (1 + alpha (1 + 2 g²) / 3); Rayleigh's with g = 0, alpha = 1 |
/// | `"droplets"` | of the water droplets of fog and clouds: Jendersie and d'Eon's fit (2023) to Mie theory |
///
/// | key | of kind | type | unit | range | meaning |
/// |---|---|---|---|---|---|
/// | `g` | henyey-greenstein, draine | number | | (-1, 1) | above 0 is forward; the mean cosine of the former |
/// | `g1`, `g2` | double-henyey-greenstein | number | | (-1, 1) | mean cosines of its two lobes |
/// | `weight` | double-henyey-greenstein | number | | \[0, 1\] | share of the lobe of `g1` |
/// | `alpha` | draine | number | | at least 0 | weight of cos² |
/// | `diameter_um` | droplets | number | micrometres | \[5, 50\] | diameter of the droplets |
///
/// All keys of a kind are required.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[allow(missing_docs)]
pub enum PhaseSection {
    Isotropic,
    HenyeyGreenstein { g: f64 },
    DoubleHenyeyGreenstein { g1: f64, g2: f64, weight: f64 },
    Draine { g: f64, alpha: f64 },
    Droplets { diameter_um: f64 },
}

const KINDS: [(&str, &[&str]); 5] = [
    ("isotropic", &["kind"]),
    ("henyey-greenstein", &["kind", "g"]),
    ("double-henyey-greenstein", &["kind", "g1", "g2", "weight"]),
    ("draine", &["kind", "g", "alpha"]),
    ("droplets", &["kind", "diameter_um"]),
];

impl PhaseSection {
    /// Reads `phase` of a medium.
    pub(super) fn read(medium: &Table) -> Result<Self, Problem> {
        let table = medium.section("phase")?;
        let kinds = KINDS.map(|(kind, _)| (kind, kind));
        let kind = table.choose("kind", &kinds)?.unwrap_or("isotropic");
        table.allow_for(kind, &KINDS)?;
        let number = |key: &str, rule: &str, holds: fn(f64) -> bool| {
            let value: f64 = table.require(key)?;
            table.ensure(key, holds(value), rule).map(|()| value)
        };
        let g = |key: &str| number(key, "must lie in (-1, 1)", |g| g > -1.0 && g < 1.0);
        Ok(match kind {
            "henyey-greenstein" => Self::HenyeyGreenstein { g: g("g")? },
            "double-henyey-greenstein" => Self::DoubleHenyeyGreenstein {
                g1: g("g1")?,
                g2: g("g2")?,
                weight: number("weight", "must lie in [0, 1]", |w| (0.0..=1.0).contains(&w))?,
            },
            "draine" => Self::Draine {
                g: g("g")?,
                alpha: number("alpha", "must not be below 0", |alpha| alpha >= 0.0)?,
            },
            "droplets" => {
                let is_fitted = |d| (SMALLEST_DROPLET..=LARGEST_DROPLET).contains(&d);
                let rule = "must lie in [5, 50], the micrometres that the fit is made for";
                Self::Droplets { diameter_um: number("diameter_um", rule, is_fitted)? }
            }
            _ => Self::Isotropic,
        })
    }

    pub(in crate::scene) fn phase(&self) -> Phase {
        match *self {
            Self::Isotropic => Phase::Isotropic,
            Self::HenyeyGreenstein { g } => Phase::draine(g, 0.0),
            Self::DoubleHenyeyGreenstein { g1, g2, weight } => {
                let [first, second] = [g1, g2].map(Lobe::henyey_greenstein);
                Phase::two_lobes(first, second, weight)
            }
            Self::Draine { g, alpha } => Phase::draine(g, alpha),
            Self::Droplets { diameter_um } => Phase::droplets(diameter_um),
        }
    }
}
