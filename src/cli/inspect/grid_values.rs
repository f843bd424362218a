//! Least, greatest, summed and mean value of a grid's active voxels.

use photonvdb::medium::vdb::{GridSummary, GridValue, Limits, SparseGrid, VdbError, VdbFile};
use serde::Serialize;

/// Figures over all active voxels, those in tiles included, that are finite: one number of a grid of numbers,
/// three of a grid of vectors. `None`: there are none, or the grid holds neither.
#[derive(Default, Serialize)]
pub struct GridValues {
    pub min: Option<Figure>,
    pub max: Option<Figure>,
    pub sum: Option<Figure>,
    pub mean: Option<Figure>,
    /// Active voxels with a component that is NaN or infinite; they count in none of the above.
    pub nonfinite_voxels: u64,
    /// Active voxels with a component below 0.
    pub negative_voxels: u64,
}

/// A figure of a grid, as JSON a number or a list of three.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Figure {
    Number(f64),
    Vector([f64; 3]),
}

/// Reads the values of a grid of numbers or vectors; of other grids nothing.
pub fn read_values(
    file: &VdbFile,
    index: usize,
    summary: &GridSummary,
    limits: &Limits,
) -> Result<GridValues, VdbError> {
    let scalar = |[value]: [f64; 1]| Figure::Number(value);
    match summary.value_type.as_str() {
        _ if summary.unusable.is_some() => Ok(GridValues::default()),
        "float" => Ok(Sums::of(file, index, limits, |v: f32| [v.into()])?.values(scalar)),
        "double" => Ok(Sums::of(file, index, limits, |v: f64| [v])?.values(scalar)),
        "int32" => Ok(Sums::of(file, index, limits, |v: i32| [v.into()])?.values(scalar)),
        "int64" => Ok(Sums::of(file, index, limits, |v: i64| [v as f64])?.values(scalar)),
        "vec3s" => {
            Ok(Sums::of(file, index, limits, |v: [f32; 3]| v.map(f64::from))?
                .values(Figure::Vector))
        }
        "vec3d" => Ok(Sums::of(file, index, limits, |v: [f64; 3]| v)?.values(Figure::Vector)),
        _ => Ok(GridValues::default()),
    }
}

/// Running figures of values of `N` components.
struct Sums<const N: usize> {
    min: [f64; N],
    max: [f64; N],
    sum: [f64; N],
    count: u64,
    nonfinite_voxels: u64,
    negative_voxels: u64,
}

impl<const N: usize> Sums<N> {
    fn of<V: GridValue>(
        file: &VdbFile,
        index: usize,
        limits: &Limits,
        components: impl Fn(V) -> [f64; N],
    ) -> Result<Self, VdbError> {
        let grid = file.load_stored::<V>(index, limits)?;
        let mut sums = Self {
            min: [f64::INFINITY; N],
            max: [f64::NEG_INFINITY; N],
            sum: [0.0; N],
            count: 0,
            nonfinite_voxels: 0,
            negative_voxels: 0,
        };
        for (value, count) in active_values(&grid) {
            sums.add(components(value), count);
        }
        Ok(sums)
    }

    fn add(&mut self, value: [f64; N], count: u64) {
        if value.iter().any(|component| *component < 0.0) {
            self.negative_voxels += count;
        }
        if !value.iter().all(|component| component.is_finite()) {
            self.nonfinite_voxels += count;
            return;
        }
        self.count += count;
        for (axis, component) in value.into_iter().enumerate() {
            self.min[axis] = self.min[axis].min(component);
            self.max[axis] = self.max[axis].max(component);
            self.sum[axis] += component * count as f64;
        }
    }

    fn values(self, figure: impl Fn([f64; N]) -> Figure) -> GridValues {
        let known = |value| (self.count > 0).then(|| figure(value));
        GridValues {
            min: known(self.min),
            max: known(self.max),
            sum: known(self.sum),
            mean: known(self.sum.map(|sum| sum / self.count as f64)),
            nonfinite_voxels: self.nonfinite_voxels,
            negative_voxels: self.negative_voxels,
        }
    }
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
