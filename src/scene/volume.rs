//! Density volumes of a scene: from a VDB file to extinction in the scene's world.

use std::path::Path;

use super::error::Problem;
use super::grid_use::{GridRole, GridUse};
use crate::math::DAffine3;
use crate::medium::grid::DensityGrid;
use crate::medium::vdb::{Limits, VdbFile, VolumeSource, find_density, sanitize_density};
use crate::medium::{Bounds, GridExtinction, MediumExtinction, UniformExtinction};

/// Opens the file of a volume.
pub(super) fn open(file: &Path) -> Result<VdbFile, Problem> {
    VdbFile::open(file).map_err(|error| Problem::new("medium.file", error.to_string()))
}

/// The extinction `density_scale * density` \[1/m\] of a grid, and where it is. `density` names the grid;
/// `transform` leads from the file's world to the scene's. Pushes a sentence on `warnings` for what was mended, and
/// the grid on `grids`.
pub(super) fn read(
    source: &VdbFile,
    density: Option<&str>,
    density_scale: f64,
    transform: DAffine3,
    warnings: &mut Vec<String>,
    grids: &mut Vec<GridUse>,
) -> Result<(Bounds, MediumExtinction), Problem> {
    let in_grid = |text: String| Problem::new("medium.density", text);
    let index = find_density(source, density.unwrap_or("density"), density.is_some())
        .map_err(|error| in_grid(error.to_string()))?;
    let unique_name = source.grids()[index].unique_name.clone();
    let name = format!("grid {unique_name:?} of {}", source.name());

    let limits = Limits::default();
    let mut sparse = source.load_scalar(index, &limits).map_err(|e| in_grid(e.to_string()))?;
    let mended = sanitize_density(&mut sparse);
    if mended.total() > 0 {
        warnings.push(format!(
            "{name}: {} values are no densities and count as 0 ({} NaN, {} infinite, {} negative)",
            mended.total(),
            mended.nan,
            mended.infinite,
            mended.negative,
        ));
    }
    if let Some(damage) = source.damage() {
        warnings.push(format!("{} is damaged beyond its readable grids: {damage}", source.name()));
    }

    let index_to_world = transform * sparse.index_to_world;
    let grid = DensityGrid::from_sparse(&sparse);
    drop(sparse);
    if grid.statistics().max_density <= 0.0 {
        return Err(in_grid(format!("{name} is empty: no density is above 0")));
    }
    let memory_bytes = grid.statistics().memory_bytes as u64;
    grids.push(GridUse { role: GridRole::Density, name: unique_name, memory_bytes });
    place(grid, index_to_world, density_scale)
}

/// A grid in the world. At scale 0 all that is left of it is its bounds.
fn place(
    grid: DensityGrid,
    index_to_world: DAffine3,
    density_scale: f64,
) -> Result<(Bounds, MediumExtinction), Problem> {
    let is_transparent = density_scale == 0.0;
    let scale = if is_transparent { 1.0 } else { density_scale };
    let extinction = GridExtinction::new(grid, index_to_world, scale);
    let bounds = extinction.bounds().ok_or_else(|| {
        let text = "must be invertible and finite together with the file's own transform";
        Problem::new("medium.transform", text)
    })?;
    if is_transparent {
        return Ok((bounds, MediumExtinction::Uniform(UniformExtinction { sigma_t: 0.0 })));
    }
    Ok((bounds, MediumExtinction::Grid(Box::new(extinction))))
}
