//! Grids of a volume by name: found, read within limits, mended, placed, and noted for the plan.

use super::error::Problem;
use super::grid_use::{GridRole, GridUse};
use super::volume::VolumeRules;
use crate::math::DAffine3;
use crate::medium::vdb::{
    SanitizeCount, SparseGrid, VdbFile, VolumeSource, find_scalar, find_vector, sanitize_density,
};
use crate::medium::{ColorGrid, ValueGrid};

/// A file of grids, and what reading them has led to.
pub(super) struct GridReader<'a> {
    pub source: &'a VdbFile,
    /// From the file's world to the scene's.
    pub transform: DAffine3,
    pub rules: &'a VolumeRules,
    pub warnings: &'a mut Vec<String>,
    pub grids: &'a mut Vec<GridUse>,
}

impl GridReader<'_> {
    /// The grid of vectors named `name`, as colours.
    pub fn read_color(&mut self, name: &str) -> Result<ColorGrid, Problem> {
        let problem = |text: String| Problem::new("medium.color", text);
        let sparse = find_vector(self.source, name)
            .and_then(|index| self.source.load_vector(index, &self.rules.limits))
            .map_err(|error| problem(error.to_string()))?;
        let shown = self.shown(name);
        let limits = self.source.limits_beside(&self.rules.limits);
        let map = self.transform * sparse.index_to_world;
        let (color, mended) = ColorGrid::new(&sparse, map, &limits)
            .map_err(|error| problem(format!("{shown} cannot be used: {error}")))?
            .ok_or_else(|| problem(format!("{shown} is empty: it has no active voxel")))?;
        self.tell_mended(mended, GridRole::Color, name)?;
        if color.max().max_element() <= 0.0 {
            self.warnings.push(format!("{shown} is black: the medium scatters no light"));
        }
        self.note(GridRole::Color, name, color.bytes());
        Ok(color)
    }

    /// The grid of numbers named `name`, each converted.
    pub fn read_values(
        &mut self,
        role: GridRole,
        name: &str,
        convert: impl Fn(f32) -> f32,
    ) -> Result<ValueGrid, Problem> {
        let problem = |text: String| Problem::new(role.key(), text);
        let mut sparse = find_scalar(self.source, name)
            .and_then(|index| self.source.load_scalar(index, &self.rules.limits))
            .map_err(|error| problem(error.to_string()))?
            .map(convert);
        self.mend(&mut sparse, role, name)?;
        let limits = self.source.limits_beside(&self.rules.limits);
        let grid = ValueGrid::new(&sparse, self.transform * sparse.index_to_world, &limits)
            .map_err(|error| problem(format!("{} cannot be used: {error}", self.shown(name))))?;
        let empty = || problem(format!("{} is empty: it has no active voxel", self.shown(name)));
        let grid = grid.ok_or_else(empty)?;
        self.note(role, name, grid.bytes());
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
            return Err(Problem::new(role.key(), text));
        }
        self.warnings.push(format!("{found}; they count as 0"));
        Ok(())
    }

    /// Enters a grid in the list of those used.
    pub fn note(&mut self, role: GridRole, name: &str, bytes: usize) {
        self.grids.push(GridUse { role, name: name.to_owned(), memory_bytes: bytes as u64 });
    }

    /// What messages call a grid.
    pub fn shown(&self, name: &str) -> String {
        format!("grid {name:?} of {}", self.source.name())
    }
}
