//! `[render]`

use serde::{Serialize, Serializer};

use super::table::Table;
use crate::render::Gather;
use crate::scene::error::Problem;

/// `[render]`: how pixels are sampled.
///
/// | key | type | unit | default | range | meaning |
/// |---|---|---|---|---|---|
/// | `samples_per_pixel` | integer | | 4 | 1 to 65536 | rays a pixel, jittered in a grid of that many cells |
/// | `march_samples` | integer | | 8 | 1 to 65536 | queries a ray for light scattered twice or more; at most 2 where paths are bounced |
/// | `light_samples` | integer | | 8 | 1 to 65536 | single-scattering points a ray and light |
/// | `gather` | `"auto"`, `"knn"`, `"lattice"`, `"bounce"` | | `"auto"` | | how light scattered twice or more is gathered from photons; `"auto"` is `"bounce"` in media where light scatters many times, else `"lattice"`; left out, `"knn"` with `photons_only` or any key of `[estimate]`, else `"auto"` |
/// | `lattice` | integer | | by the number of photons | 2 to 512 | cells of the lattice along its longest side |
/// | `bounces` | integer | | 8 | 1 to 1024 | collisions of a path before it ends in the lattice, where `gather` is `"bounce"` |
/// | `filter` | `"auto"`, `"on"`, `"off"` | | `"auto"` | | whether multiple scattering is smoothed from pixel to pixel, as far as the noise taken away exceeds the measured bias; `"auto"` is `"on"` where the image is made to a target error or a time, and where paths are bounced |
/// | `background` | `"visible"`, `"holdout"` | | `"visible"` | | whether the camera sees environments; held out, they still light the medium, and what lies behind is composited by coverage |
/// | `photons_only` | true, false | | false | | whether single scattering, too, comes from photons |
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RenderSettings {
    /// Rays a pixel, jittered in a grid of that many cells.
    pub samples_per_pixel: usize,
    /// Photon-map queries a ray.
    pub march_samples: usize,
    /// Single-scattering points a ray and light.
    pub light_samples: usize,
    /// How light scattered twice or more is gathered.
    pub gather: Gather,
    /// Cells of the lattice along its longest side; `None`: by the number of photons.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lattice: Option<usize>,
    /// Collisions of a path before it ends in the lattice.
    pub bounces: u32,
    /// Whether multiple scattering is filtered; `None`: where the image is made to a target error or a time.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "filter_word")]
    pub filter: Option<bool>,
    /// Whether single scattering, too, comes from photons (for the lab).
    pub photons_only: bool,
    /// Whether the camera sees environments.
    #[serde(skip_serializing_if = "Background::is_visible")]
    pub background: Background,
}

/// What the camera sees of environments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Background {
    /// Their light, through the medium.
    #[default]
    Visible,
    /// Nothing: another image goes there.
    Holdout,
}

impl Background {
    fn is_visible(&self) -> bool {
        *self == Self::Visible
    }
}

impl RenderSettings {
    /// `asks_for_k`: whether the scene has an opinion on estimates from the k nearest photons.
    pub(super) fn read(table: &Table, asks_for_k: bool) -> Result<Self, Problem> {
        table.allow(&[
            "samples_per_pixel",
            "march_samples",
            "light_samples",
            "gather",
            "lattice",
            "bounces",
            "filter",
            "background",
            "photons_only",
        ])?;
        let photons_only = table.get_or("photons_only", false)?;
        let default = if photons_only || asks_for_k { Gather::Knn } else { Gather::Auto };
        let gather = match table.choose("gather", &GATHERS)? {
            Some(Gather::Auto) if photons_only => Gather::Knn,
            asked => asked.unwrap_or(default),
        };
        let needs_map = photons_only && gather != Gather::Knn;
        table.ensure("gather", !needs_map, "must be \"knn\" where photons_only is true")?;
        let lattice: Option<u64> = table.get("lattice")?;
        let fits = lattice.is_none_or(|cells| (2..=512).contains(&cells));
        table.ensure("lattice", fits, "must lie in 2 to 512")?;
        let bounces: u64 = table.get_or("bounces", 8)?;
        table.ensure("bounces", (1..=1024).contains(&bounces), "must lie in 1 to 1024")?;
        Ok(Self {
            samples_per_pixel: read_count(table, "samples_per_pixel", 4)?,
            march_samples: read_count(table, "march_samples", 8)?,
            light_samples: read_count(table, "light_samples", 8)?,
            gather,
            lattice: lattice.map(|cells| cells as usize),
            bounces: bounces as u32,
            filter: table.choose("filter", &FILTERS)?.flatten(),
            photons_only,
            background: table.choose("background", &BACKGROUNDS)?.unwrap_or_default(),
        })
    }
}

/// `None` stands for the plan's own choice.
const FILTERS: [(&str, Option<bool>); 3] =
    [("auto", None), ("on", Some(true)), ("off", Some(false))];

const GATHERS: [(&str, Gather); 4] = [
    ("auto", Gather::Auto),
    ("knn", Gather::Knn),
    ("lattice", Gather::Lattice),
    ("bounce", Gather::Bounce),
];

fn filter_word<S: Serializer>(filter: &Option<bool>, serializer: S) -> Result<S::Ok, S::Error> {
    let word = FILTERS.iter().find(|(_, other)| other == filter).map_or("auto", |(word, _)| word);
    serializer.serialize_str(word)
}

const BACKGROUNDS: [(&str, Background); 2] =
    [("visible", Background::Visible), ("holdout", Background::Holdout)];

fn read_count(table: &Table, key: &str, default: u64) -> Result<usize, Problem> {
    let count = table.get_or(key, default)?;
    table.ensure(key, (1..=65536).contains(&count), "must lie in 1 to 65536")?;
    Ok(count as usize)
}
