//! `[render]`

use serde::Serialize;

use super::table::Table;
use crate::scene::error::Problem;

/// `[render]`: how pixels are sampled.
///
/// | key | type | unit | default | range | meaning |
/// |---|---|---|---|---|---|
/// | `samples_per_pixel` | integer | | 4 | 1 to 65536 | rays a pixel, jittered in a grid of that many cells |
/// | `march_samples` | integer | | 8 | 1 to 65536 | photon-map queries a ray |
/// | `light_samples` | integer | | 8 | 1 to 65536 | single-scattering points a ray and light |
/// | `photons_only` | true, false | | false | | whether single scattering, too, comes from photons |
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RenderSettings {
    /// Rays a pixel, jittered in a grid of that many cells.
    pub samples_per_pixel: usize,
    /// Photon-map queries a ray.
    pub march_samples: usize,
    /// Single-scattering points a ray and light.
    pub light_samples: usize,
    /// Whether single scattering, too, comes from photons (for the lab).
    pub photons_only: bool,
}

impl RenderSettings {
    pub(super) fn read(table: &Table) -> Result<Self, Problem> {
        table.allow(&["samples_per_pixel", "march_samples", "light_samples", "photons_only"])?;
        Ok(Self {
            samples_per_pixel: read_count(table, "samples_per_pixel", 4)?,
            march_samples: read_count(table, "march_samples", 8)?,
            light_samples: read_count(table, "light_samples", 8)?,
            photons_only: table.get_or("photons_only", false)?,
        })
    }
}

fn read_count(table: &Table, key: &str, default: u64) -> Result<usize, Problem> {
    let count = table.get_or(key, default)?;
    table.ensure(key, (1..=65536).contains(&count), "must lie in 1 to 65536")?;
    Ok(count as usize)
}
