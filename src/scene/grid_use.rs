//! What each grid of a volume is used for.

use serde::Serialize;

/// What a grid is to the medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum GridRole {
    /// sigma_t per `density_scale`.
    Density,
    /// What the albedo is multiplied by.
    Color,
    /// Heat that glows.
    Temperature,
    /// Flames that glow.
    Flame,
}

/// A grid that the scene uses; the others of the file are not read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct GridUse {
    /// What it is for.
    pub role: GridRole,
    /// Its name, `density[1]` for the second grid named so.
    pub name: String,
    /// The name of its file, without folders.
    pub file: String,
    /// Volumes that use it, from the same memory.
    pub volumes: usize,
    /// Memory it is held in \[bytes\].
    pub memory_bytes: u64,
}

impl GridRole {
    /// As scene files spell it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Density => "density",
            Self::Color => "color",
            Self::Temperature => "temperature",
            Self::Flame => "flame",
        }
    }

    /// What its values are.
    pub(super) fn plural(self) -> &'static str {
        match self {
            Self::Density => "densities",
            Self::Color => "colours",
            Self::Temperature => "temperatures",
            Self::Flame => "flames",
        }
    }
}
