//! How many voxels are active, and where: the extent of the medium.

use rayon::prelude::*;

use crate::medium::vdb::{SparseGrid, Tile};

/// Leaves a thread takes at once.
const LEAVES_A_TASK: usize = 1024;

/// The active voxels of a grid, tiles included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ActiveVoxels {
    /// How many, saturating.
    pub(super) count: u64,
    /// Lowest active voxel.
    pub(super) min: [i64; 3],
    /// Highest active voxel.
    pub(super) max: [i64; 3],
}

impl ActiveVoxels {
    /// Counts the active voxels; `None` if there are none.
    pub(super) fn of(grid: &SparseGrid<f32>) -> Option<Self> {
        let leaves = grid
            .leaves
            .par_iter()
            .zip(&grid.masks)
            .zip(grid.values.par_chunks_exact(512))
            .with_min_len(LEAVES_A_TASK)
            .filter_map(|((origin, mask), _)| Self::of_leaf(*origin, mask))
            .reduce_with(Self::merge);
        let tiles = grid.tiles.iter().filter(|tile| tile.active).map(Self::of_tile);
        leaves.into_iter().chain(tiles).reduce(Self::merge)
    }

    fn of_leaf(origin: [i32; 3], mask: &[u64; 8]) -> Option<Self> {
        // One word a layer of x; in it, one byte a row of y, and in that one bit a voxel of z.
        let mut layers =
            mask.iter().enumerate().filter(|(_, word)| **word != 0).map(|(x, _)| x as i64);
        let first_x = layers.next()?;
        let last_x = layers.next_back().unwrap_or(first_x);
        let rows = mask.iter().fold(0, |union, word| union | word);
        let columns = rows.to_le_bytes().iter().fold(0, |union, byte| union | byte);
        let low = [first_x, i64::from(rows.trailing_zeros() / 8), columns.trailing_zeros().into()];
        let high = [
            last_x,
            i64::from(7 - rows.leading_zeros() / 8),
            i64::from(7 - columns.leading_zeros()),
        ];
        Some(Self {
            count: mask.iter().map(|word| u64::from(word.count_ones())).sum(),
            min: std::array::from_fn(|axis| i64::from(origin[axis]) + low[axis]),
            max: std::array::from_fn(|axis| i64::from(origin[axis]) + high[axis]),
        })
    }

    fn of_tile(tile: &Tile<f32>) -> Self {
        let edge = u64::from(tile.dim);
        let min = tile.origin.map(i64::from);
        Self {
            count: edge.saturating_pow(3),
            min,
            max: min.map(|c| c + i64::from(tile.dim.max(1)) - 1),
        }
    }

    fn merge(self, other: Self) -> Self {
        Self {
            count: self.count.saturating_add(other.count),
            min: std::array::from_fn(|axis| self.min[axis].min(other.min[axis])),
            max: std::array::from_fn(|axis| self.max[axis].max(other.max[axis])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DAffine3;

    #[test]
    fn one_voxel_and_a_tile_are_counted_and_bounded() {
        let mut mask = [0_u64; 8];
        mask[2] = 1 << (3 << 3 | 5);
        let mut grid = SparseGrid {
            background: 0.0,
            index_to_world: DAffine3::IDENTITY,
            leaves: vec![[-16, 8, 0]],
            masks: vec![mask],
            values: vec![1.0; 512],
            tiles: vec![],
        };
        let one = ActiveVoxels { count: 1, min: [-14, 11, 5], max: [-14, 11, 5] };
        assert_eq!(ActiveVoxels::of(&grid), Some(one));

        grid.tiles.push(Tile { origin: [128, 0, 0], dim: 128, value: 1.0, active: true });
        grid.tiles.push(Tile { origin: [4096, 0, 0], dim: 4096, value: 1.0, active: false });
        let both = ActiveVoxels { count: 1 + (1 << 21), min: [-14, 0, 0], max: [255, 127, 127] };
        assert_eq!(ActiveVoxels::of(&grid), Some(both));

        grid.masks[0] = [0; 8];
        grid.tiles.clear();
        assert_eq!(ActiveVoxels::of(&grid), None);
    }
}
