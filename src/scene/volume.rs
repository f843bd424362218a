//! Density volumes of a scene: from a VDB file to extinction in the scene's world.

use std::path::Path;
use std::sync::Arc;

use super::error::Problem;
use super::grid_reader::GridReader;
use super::grid_use::GridRole;
use super::loaded_grids::{GridForm, LoadedGrid};
use crate::math::DAffine3;
use crate::medium::grid::{BrickPrecision, DensityGrid};
use crate::medium::vdb::{
    GridSummary, Limits, SparseGrid, VdbFile, VolumeSource, find_density,
    find_density_or_level_set, fog_of_level_set,
};
use crate::medium::{Bounds, GridExtinction, MediumExtinction, UniformExtinction};

/// What reading volumes may cost and must find.
#[derive(Clone, Copy, Debug)]
pub(super) struct VolumeRules {
    /// Memory allowed.
    pub limits: Limits,
    /// Whether a value that cannot be a density is an error.
    pub strict: bool,
}

/// A density grid of a file, and how a scene uses it: sigma_t = density_scale * density \[1/m\].
pub(super) struct DensityVolume<'a> {
    /// Name of the grid, if the scene gives one.
    pub grid: Option<&'a str>,
    /// Whether a level set is filled with fog.
    pub sdf_to_fog: bool,
    /// How densities are kept.
    pub precision: BrickPrecision,
    /// Extinction of density 1 \[1/m\].
    pub density_scale: f64,
}

/// Opens the file of the volume at key path `key`.
pub(super) fn open(file: &Path, key: &str, rules: &VolumeRules) -> Result<VdbFile, Problem> {
    VdbFile::open_within(file, &rules.limits)
        .map_err(|error| Problem::new(format!("{key}.file"), error.to_string()))
}

impl DensityVolume<'_> {
    /// Reads the extinction and where it is.
    pub(super) fn read(
        &self,
        reader: &mut GridReader,
    ) -> Result<(Bounds, MediumExtinction), Problem> {
        let source = reader.source;
        let index = self.find(reader)?;
        let Self { sdf_to_fog, precision, .. } = *self;
        let key = reader.grid_key(index, GridForm::Density { sdf_to_fog, precision });
        if let Some((LoadedGrid::Density(grid), index_to_file)) = reader.find_loaded(key) {
            return self.place(grid, index_to_file, reader);
        }
        let name = reader.shown(&source.grids()[index].unique_name);
        let sparse = self.load(index, reader)?;
        if let Some(damage) = source.damage() {
            let name = source.name();
            reader.warnings.push(format!("{name} is damaged beyond its readable grids: {damage}"));
        }

        let index_to_file = sparse.index_to_world;
        let limits = source.limits_beside(&reader.rules.limits);
        let grid = DensityGrid::build(&sparse, self.precision, &limits).map_err(|error| {
            reader.problem(GridRole::Density, format!("{name} cannot be used: {error}"))
        })?;
        drop(sparse);
        if grid.statistics().max_density <= 0.0 {
            let text = format!("{name} is empty: no density is above 0");
            return Err(reader.problem(GridRole::Density, text));
        }
        let grid = Arc::new(grid);
        let bytes = grid.statistics().memory_bytes;
        let loaded = LoadedGrid::Density(Arc::clone(&grid));
        reader.note(GridRole::Density, bytes, key, loaded, index_to_file);
        self.place(grid, index_to_file, reader)
    }

    /// The densities as they are rendered, in the tree of the file and in the scene's world.
    pub(super) fn read_tree(&self, reader: &mut GridReader) -> Result<SparseGrid<f32>, Problem> {
        let index = self.find(reader)?;
        let mut sparse = self.load(index, reader)?;
        sparse.index_to_world = reader.transform * sparse.index_to_world;
        Ok(sparse)
    }

    /// The densities of a grid of the file: what it holds, or the fog inside it, mended.
    fn load(&self, index: usize, reader: &mut GridReader) -> Result<SparseGrid<f32>, Problem> {
        let summary = &reader.source.grids()[index];
        let unique_name = summary.unique_name.as_str();
        let stored = reader
            .source
            .load_scalar(index, &reader.rules.limits)
            .map_err(|error| reader.problem(GridRole::Density, error.to_string()))?;
        let name = reader.shown(unique_name);
        let mut sparse = self.density(stored, summary, &name, reader.warnings);
        reader.mend(&mut sparse, GridRole::Density, unique_name)?;
        Ok(sparse)
    }

    /// The grid in the world. At scale 0 all that is left of it is its bounds.
    fn place(
        &self,
        grid: Arc<DensityGrid>,
        index_to_file: DAffine3,
        reader: &GridReader,
    ) -> Result<(Bounds, MediumExtinction), Problem> {
        let is_transparent = self.density_scale == 0.0;
        let scale = if is_transparent { 1.0 } else { self.density_scale };
        let extinction = GridExtinction::new(grid, reader.transform * index_to_file, scale);
        let bounds = extinction.bounds().ok_or_else(|| {
            let text = "must be invertible and finite together with the file's own transform";
            Problem::new(format!("{}.transform", reader.key), text)
        })?;
        if is_transparent {
            return Ok((bounds, MediumExtinction::Uniform(UniformExtinction { sigma_t: 0.0 })));
        }
        Ok((bounds, MediumExtinction::Grid(Box::new(extinction))))
    }

    fn find(&self, reader: &GridReader) -> Result<usize, Problem> {
        let find = if self.sdf_to_fog { find_density_or_level_set } else { find_density };
        find(reader.source, self.grid.unwrap_or("density"), self.grid.is_some())
            .map_err(|error| reader.problem(GridRole::Density, error.to_string()))
    }

    /// The grid's densities: what it holds, or the fog inside it.
    fn density(
        &self,
        stored: SparseGrid<f32>,
        summary: &GridSummary,
        name: &str,
        warnings: &mut Vec<String>,
    ) -> SparseGrid<f32> {
        if !self.sdf_to_fog {
            return stored;
        }
        // Not every program names the class; a density is 0 far away, a distance is not.
        let is_unnamed_level_set = summary.class == "unknown" && stored.background > 0.0;
        if summary.is_level_set() || is_unnamed_level_set {
            return fog_of_level_set(stored);
        }
        warnings.push(format!("{name} is no level set and is used as it is"));
        stored
    }
}
