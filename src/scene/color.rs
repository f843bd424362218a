//! The colour grid of a volume.

use super::error::Problem;
use super::grid_use::{GridRole, GridUse};
use crate::math::DAffine3;
use crate::medium::ColorGrid;
use crate::medium::vdb::{Limits, VdbFile, VolumeSource, find_vector};

/// The grid of vectors named `name`, in the scene's world: `transform` leads there from the file's. Pushes a sentence
/// on `warnings` for what was mended, and the grid on `grids`.
pub(super) fn read(
    source: &VdbFile,
    name: &str,
    transform: DAffine3,
    warnings: &mut Vec<String>,
    grids: &mut Vec<GridUse>,
) -> Result<ColorGrid, Problem> {
    let in_grid = |text: String| Problem::new("medium.color", text);
    let index = find_vector(source, name).map_err(|error| in_grid(error.to_string()))?;
    let sparse =
        source.load_vector(index, &Limits::default()).map_err(|e| in_grid(e.to_string()))?;
    let unique_name = source.grids()[index].unique_name.clone();
    let shown = format!("grid {unique_name:?} of {}", source.name());

    let (color, mended) = ColorGrid::new(&sparse, transform * sparse.index_to_world)
        .ok_or_else(|| in_grid(format!("{shown} is empty: it has no active voxel")))?;
    if mended.total() > 0 {
        warnings.push(format!(
            "{shown}: {} components are no colours and count as 0 ({} NaN, {} infinite, {} negative)",
            mended.total(),
            mended.nan,
            mended.infinite,
            mended.negative,
        ));
    }
    if color.max().max_element() <= 0.0 {
        warnings.push(format!("{shown} is black: the medium scatters no light"));
    }
    let memory_bytes = color.bytes() as u64;
    grids.push(GridUse { role: GridRole::Color, name: unique_name, memory_bytes });
    Ok(color)
}
