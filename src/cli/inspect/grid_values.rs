//! Least, greatest and summed value of a grid's active voxels.

use photonvdb::medium::vdb::{GridSummary, GridValue, Limits, SparseGrid, VdbError, VdbFile, f16};
use serde::Serialize;

/// Figures over all active voxels, those in tiles included, that are finite. `None`: there are none, or the grid
/// does not hold one number a voxel.
#[derive(Default, Serialize)]
pub struct GridValues {
    pub min: Option<f64>,
    pub max: Option<f64>,
    pub sum: Option<f64>,
    /// Active voxels that are NaN or infinite.
    pub nonfinite_voxels: u64,
}

/// Reads the values of a grid of numbers; of other grids nothing.
pub fn read_values(
    file: &VdbFile,
    index: usize,
    summary: &GridSummary,
) -> Result<GridValues, VdbError> {
    if !summary.is_usable_scalar() {
        return Ok(GridValues::default());
    }
    match summary.value_type.as_str() {
        "double" => figures(file, index, |value: f64| value),
        "half" => figures(file, index, |value: f16| value.into()),
        "int32" => figures(file, index, |value: i32| value.into()),
        "int64" => figures(file, index, |value: i64| value as f64),
        _ => figures(file, index, |value: f32| value.into()),
    }
}

fn figures<V: GridValue>(
    file: &VdbFile,
    index: usize,
    to_f64: impl Fn(V) -> f64,
) -> Result<GridValues, VdbError> {
    let grid = file.load_stored::<V>(index, &Limits::default())?;
    let mut figures = GridValues::default();
    for (value, count) in active_values(&grid) {
        figures.add(to_f64(value), count);
    }
    Ok(figures)
}

/// Values of active voxels, each with the number of voxels that have it.
fn active_values<V: Copy>(grid: &SparseGrid<V>) -> impl Iterator<Item = (V, u64)> {
    let leaves = grid.masks.iter().zip(grid.values.chunks_exact(512));
    let voxels = leaves.flat_map(|(mask, values)| {
        let is_active = |offset: usize| mask[offset >> 6] >> (offset & 63) & 1 == 1;
        let active = values.iter().enumerate().filter(move |(offset, _)| is_active(*offset));
        active.map(|(_, &value)| (value, 1))
    });
    let tiles = grid.tiles.iter().filter(|tile| tile.active);
    voxels.chain(tiles.map(|tile| (tile.value, u64::from(tile.dim).pow(3))))
}

impl GridValues {
    fn add(&mut self, value: f64, count: u64) {
        if !value.is_finite() {
            self.nonfinite_voxels += count;
            return;
        }
        self.min = Some(self.min.map_or(value, |min| min.min(value)));
        self.max = Some(self.max.map_or(value, |max| max.max(value)));
        self.sum = Some(self.sum.unwrap_or(0.0) + value * count as f64);
    }
}
