//! Grids of a volume by name: found, read within limits, mended, placed, and noted for the plan.

use std::path::Path;

use super::error::Problem;
use super::grid_use::{GridRole, GridUse};
use super::loaded_grids::{GridForm, GridKey, LoadedGrid, LoadedGrids};
use super::volume::VolumeRules;
use crate::math::DAffine3;
use crate::medium::vdb::{
    SanitizeCount, SparseGrid, VdbFile, VolumeSource, find_scalar, find_vector, sanitize_density,
};
use crate::medium::{ColorGrid, ValueGrid};

/// A file of grids, and what reading them has led to.
pub(super) struct GridReader<'a> {
    pub source: &'a VdbFile,
    /// Path of the volume's keys.
    pub key: String,
    /// From the file's world to the scene's.
    pub transform: DAffine3,
    pub rules: &'a VolumeRules,
    pub warnings: &'a mut Vec<String>,
    pub grids: &'a mut Vec<GridUse>,
    pub loaded: &'a mut LoadedGrids,
}

impl GridReader<'_> {
    /// The grid of vectors named `name`, as colours.
    pub fn read_color(&mut self, name: &str) -> Result<ColorGrid, Problem> {
        let path = format!("{}.{}", self.key, GridRole::Color.name());
        let problem = |text: String| Problem::new(path.clone(), text);
        let index = find_vector(self.source, name).map_err(|error| problem(error.to_string()))?;
        let shown = self.shown(name);
        let empty = || problem(format!("{shown} is empty: it has no active voxel"));
        let key = self.grid_key(index, GridForm::Color);
        if let Some((LoadedGrid::Color(color), index_to_file)) = self.find_loaded(key) {
            return color.moved(self.transform * index_to_file).ok_or_else(empty);
        }
        let sparse = self
            .source
            .load_vector(index, &self.rules.limits)
            .map_err(|error| problem(error.to_string()))?;
        let limits = self.source.limits_beside(&self.rules.limits);
        let map = self.transform * sparse.index_to_world;
        let (color, mended) = ColorGrid::new(&sparse, map, &limits)
            .map_err(|error| problem(format!("{shown} cannot be used: {error}")))?
            .ok_or_else(empty)?;
        self.tell_mended(mended, GridRole::Color, name)?;
        if color.max().max_element() <= 0.0 {
            self.warnings.push(format!("{shown} is black: the medium scatters no light"));
        }
        let loaded = LoadedGrid::Color(Box::new(color.clone()));
        self.note(GridRole::Color, color.bytes(), key, loaded, sparse.index_to_world);
        Ok(color)
    }

    /// The grid of numbers named `name`, each converted.
    pub fn read_values(
        &mut self,
        role: GridRole,
        name: &str,
        form: GridForm,
        convert: impl Fn(f32) -> f32,
    ) -> Result<ValueGrid, Problem> {
        let index = find_scalar(self.source, name)
            .map_err(|error| self.problem(role, error.to_string()))?;
        let empty = |reader: &Self| {
            let text = format!("{} is empty: it has no active voxel", reader.shown(name));
            reader.problem(role, text)
        };
        let key = self.grid_key(index, form);
        if let Some((LoadedGrid::Values(values), index_to_file)) = self.find_loaded(key) {
            return values.moved(self.transform * index_to_file).ok_or_else(|| empty(self));
        }
        let mut sparse = self
            .source
            .load_scalar(index, &self.rules.limits)
            .map_err(|error| self.problem(role, error.to_string()))?
            .map(convert);
        self.mend(&mut sparse, role, name)?;
        let limits = self.source.limits_beside(&self.rules.limits);
        let grid = ValueGrid::new(&sparse, self.transform * sparse.index_to_world, &limits)
            .map_err(|error| {
                self.problem(role, format!("{} cannot be used: {error}", self.shown(name)))
            })?;
        let grid = grid.ok_or_else(|| empty(self))?;
        let loaded = LoadedGrid::Values(Box::new(grid.clone()));
        self.note(role, grid.bytes(), key, loaded, sparse.index_to_world);
        Ok(grid)
    }

    /// Sets to 0 what is not finite or below 0, and says so; an error when the rules are strict.
    pub fn mend(
        &mut self,
        grid: &mut SparseGrid<f32>,
        role: GridRole,
        name: &str,
    ) -> Result<(), Problem> {
        let mended = sanitize_density(grid);
        self.tell_mended(mended, role, name)
    }

    fn tell_mended(
        &mut self,
        mended: SanitizeCount,
        role: GridRole,
        name: &str,
    ) -> Result<(), Problem> {
        if mended.total() == 0 {
            return Ok(());
        }
        let found = format!(
            "{}: {} values are no {} ({} NaN, {} infinite, {} negative)",
            self.shown(name),
            mended.total(),
            role.plural(),
            mended.nan,
            mended.infinite,
            mended.negative,
        );
        if self.rules.strict {
            let text = format!("{found}; mend the file, or leave out --strict to count them as 0");
            return Err(self.problem(role, text));
        }
        self.warnings.push(format!("{found}; they count as 0"));
        Ok(())
    }

    /// Enters a grid in the list of those used, and keeps it for other volumes.
    pub fn note(
        &mut self,
        role: GridRole,
        bytes: usize,
        key: GridKey,
        grid: LoadedGrid,
        index_to_file: DAffine3,
    ) {
        self.loaded.insert(key, grid, index_to_file, self.grids.len());
        let name = self.source.grids()[key.grid].unique_name.clone();
        let file = Path::new(self.source.name()).file_name().unwrap_or_default();
        let file = file.to_string_lossy().into_owned();
        self.grids.push(GridUse { role, name, file, volumes: 1, memory_bytes: bytes as u64 });
    }

    /// What tells a grid of the file, in one form, from all others.
    pub fn grid_key(&self, grid: usize, form: GridForm) -> GridKey {
        GridKey { file: self.source.content_hash(), grid, form }
    }

    /// The grid with the file's own transform, if another volume has it; counts this one in.
    pub fn find_loaded(&mut self, key: GridKey) -> Option<(LoadedGrid, DAffine3)> {
        let (grid, index_to_file, used_as) = self.loaded.find(key)?;
        if let Some(used) = self.grids.get_mut(used_as) {
            used.volumes += 1;
        }
        Some((grid, index_to_file))
    }

    /// Something wrong with the grid of a role.
    pub fn problem(&self, role: GridRole, text: String) -> Problem {
        Problem::new(format!("{}.{}", self.key, role.name()), text)
    }

    /// What messages call a grid.
    pub fn shown(&self, name: &str) -> String {
        format!("grid {name:?} of {}", self.source.name())
    }
}
