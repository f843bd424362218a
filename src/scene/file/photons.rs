//! `[photons]`

use serde::{Serialize, Serializer};

use super::table::Table;
use crate::emission::EmissionKind;
use crate::scene::error::Problem;

/// `[photons]`: how photons are emitted and followed.
///
/// | key | type | unit | default | range | meaning |
/// |---|---|---|---|---|---|
/// | `count` | integer | | 1 000 000 | 1 to 10^12 | photons emitted per pass; with `--target-error` or `--time-budget` the plan chooses, unless it is given |
/// | `emission` | `"random"`, `"stratified"`, `"sobol"` | | `"stratified"` | | how they are sampled |
/// | `seed` | integer | | 0 | 0 to 2^64 - 1 | seed of every random number |
/// | `max_order` | integer | | 1000 | 1 to 2^32 - 1 | scatterings a photon is followed through; what is cut is counted |
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PhotonSettings {
    /// Photons emitted per pass.
    pub count: u64,
    /// How they are sampled.
    #[serde(serialize_with = "serialize_emission")]
    pub emission: EmissionKind,
    /// Seed of every random number.
    pub seed: u64,
    /// Scatterings a photon is followed through; what is cut is counted.
    pub max_order: u32,
}

const EMISSIONS: [(&str, EmissionKind); 3] = [
    ("random", EmissionKind::Random),
    ("stratified", EmissionKind::Stratified),
    ("sobol", EmissionKind::Sobol),
];

const MAX_COUNT: u64 = 1_000_000_000_000;

/// The word for a kind of emission in scene files.
pub(in crate::scene) fn emission_word(emission: EmissionKind) -> &'static str {
    match emission {
        EmissionKind::Random => "random",
        EmissionKind::Stratified => "stratified",
        EmissionKind::Sobol => "sobol",
    }
}

fn serialize_emission<S: Serializer>(
    kind: &EmissionKind,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(emission_word(*kind))
}

impl PhotonSettings {
    pub(super) fn read(table: &Table) -> Result<Self, Problem> {
        table.allow(&["count", "emission", "seed", "max_order"])?;
        let count = table.get_or("count", 1_000_000)?;
        table.ensure("count", (1..=MAX_COUNT).contains(&count), "must lie in 1 to 10^12")?;
        let max_order: u64 = table.get_or("max_order", 1000)?;
        let max_order = u32::try_from(max_order).unwrap_or(0);
        table.ensure("max_order", max_order > 0, "must lie in 1 to 4294967295")?;
        let emission = table.choose("emission", &EMISSIONS)?.unwrap_or(EmissionKind::Stratified);
        Ok(Self { count, emission, seed: table.get_or("seed", 0)?, max_order })
    }
}
