//! Grids that are in memory already, so that volumes that name the same one share it, wherever they place it.
//!
//! A grid is known by the content of its file, not by its path, by its number in the file, and by what its values were turned into.

use std::sync::Arc;

use crate::math::DAffine3;
use crate::medium::grid::{BrickPrecision, DensityGrid};
use crate::medium::{ColorGrid, ValueGrid};

/// Which grid, as what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GridKey {
    /// Hash of all bytes of the file.
    pub file: u64,
    /// Number of the grid in the file.
    pub grid: usize,
    /// What it was read as.
    pub form: GridForm,
}

/// What the values of a grid were turned into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum GridForm {
    Density { sdf_to_fog: bool, precision: BrickPrecision },
    Color,
    Temperature { offset: f64, scale: f64 },
    Flame,
}

/// A grid, in the place where it was needed first.
#[derive(Clone, Debug)]
pub(super) enum LoadedGrid {
    Density(Arc<DensityGrid>),
    Color(Box<ColorGrid>),
    Values(Box<ValueGrid>),
}

/// All grids so far.
#[derive(Debug, Default)]
pub(super) struct LoadedGrids(Vec<Entry>);

#[derive(Debug)]
struct Entry {
    key: GridKey,
    grid: LoadedGrid,
    /// The file's own transform.
    index_to_world: DAffine3,
    /// Its number among the grids used.
    used_as: usize,
}

impl LoadedGrids {
    /// The grid with the file's own transform and its number among the grids used, if it is there.
    pub fn find(&self, key: GridKey) -> Option<(LoadedGrid, DAffine3, usize)> {
        let entry = self.0.iter().find(|entry| entry.key == key)?;
        Some((entry.grid.clone(), entry.index_to_world, entry.used_as))
    }

    /// Keeps a grid for later volumes.
    pub fn insert(
        &mut self,
        key: GridKey,
        grid: LoadedGrid,
        index_to_world: DAffine3,
        used_as: usize,
    ) {
        self.0.push(Entry { key, grid, index_to_world, used_as });
    }
}
