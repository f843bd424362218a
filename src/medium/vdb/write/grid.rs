//! A grid as it is handed to the writer.

use std::collections::BTreeMap;

use crate::medium::vdb::metadata::MetadataValue;
use crate::medium::vdb::sparse::SparseGrid;

/// A grid to write: values, a name, and what they mean.
///
/// ```
/// use photonvdb::medium::vdb::{GridClass, GridToWrite, SparseGrid};
/// # fn smoke(grid: &SparseGrid<f32>) -> GridToWrite<'_> {
/// GridToWrite { class: GridClass::FogVolume, ..GridToWrite::new("density", grid) }
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct GridToWrite<'a> {
    /// Name, possibly empty. Names may repeat: readers number them.
    pub name: &'a str,
    /// What the values mean.
    pub class: GridClass,
    /// The grid.
    pub values: ValuesToWrite<'a>,
    /// Whether this grid is saved as half even where [`WriteOptions`](super::WriteOptions) leave others whole: right for
    /// values that were halves before.
    pub half: bool,
    /// Further values by name, such as `vector_type` or `creator`. The names `name`, `class`,
    /// `is_saved_as_half_float` and those that begin with `file_` are the writer's own.
    pub metadata: BTreeMap<String, MetadataValue>,
}

impl<'a> GridToWrite<'a> {
    /// A grid of unknown class without further metadata.
    pub fn new(name: &'a str, values: impl Into<ValuesToWrite<'a>>) -> Self {
        Self {
            name,
            class: GridClass::Unknown,
            values: values.into(),
            half: false,
            metadata: BTreeMap::new(),
        }
    }
}

/// The types of grid that can be written.
#[derive(Clone, Copy, Debug)]
pub enum ValuesToWrite<'a> {
    /// One number a voxel.
    Float(&'a SparseGrid<f32>),
    /// Three numbers a voxel.
    Vec3(&'a SparseGrid<[f32; 3]>),
}

impl<'a> From<&'a SparseGrid<f32>> for ValuesToWrite<'a> {
    fn from(grid: &'a SparseGrid<f32>) -> Self {
        Self::Float(grid)
    }
}

impl<'a> From<&'a SparseGrid<[f32; 3]>> for ValuesToWrite<'a> {
    fn from(grid: &'a SparseGrid<[f32; 3]>) -> Self {
        Self::Vec3(grid)
    }
}

/// What the values of a grid mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GridClass {
    /// Densities and the like, zero outside.
    FogVolume,
    /// Distances to a surface.
    LevelSet,
    /// Vectors whose components lie on the faces of voxels.
    Staggered,
    /// Anything.
    #[default]
    Unknown,
}

impl GridClass {
    /// The class that OpenVDB has this word for; unknown for words it has not.
    pub fn from_word(word: &str) -> Self {
        match word {
            "fog volume" => Self::FogVolume,
            "level set" => Self::LevelSet,
            "staggered" => Self::Staggered,
            _ => Self::Unknown,
        }
    }

    /// The word in metadata; none is written for grids that may be anything.
    pub(super) fn word(self) -> Option<&'static str> {
        match self {
            Self::FogVolume => Some("fog volume"),
            Self::LevelSet => Some("level set"),
            Self::Staggered => Some("staggered"),
            Self::Unknown => None,
        }
    }
}
