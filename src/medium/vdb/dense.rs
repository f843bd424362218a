//! Dense boxes of voxels, as arrays of other programs hold them, to and from [`SparseGrid`]s.

use rayon::prelude::*;

use super::Limits;
use super::error::memory_size;
use super::sparse::{SparseGrid, Tile};
use super::summary::IndexBox;
use super::tree::LEAF_LEN;
use crate::math::DAffine3;

/// A box of voxels, each with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct DenseBox<T> {
    /// Lowest voxel.
    pub origin: [i32; 3],
    /// Voxels along x, y and z.
    pub size: [usize; 3],
    /// Their values, z running fastest and x slowest.
    pub values: Vec<T>,
}

/// Why there is no dense box, or no grid of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DenseError {
    /// It would take too much memory.
    #[error(
        "a box of {} x {} x {} voxels needs {} of memory and the limit is {}; crop the grid or raise the limit",
        size[0], size[1], size[2], memory_size(*needed), memory_size(*limit)
    )]
    TooLarge {
        /// Voxels along x, y and z.
        size: [usize; 3],
        /// What they need \[bytes\].
        needed: u64,
        /// What is allowed \[bytes\].
        limit: u64,
    },
    /// The machine has not got the memory.
    #[error("a box of {} x {} x {} voxels needs more memory than there is; crop the grid", size[0], size[1], size[2])]
    OutOfMemory {
        /// Voxels along x, y and z.
        size: [usize; 3],
    },
    /// More or fewer values than voxels.
    #[error("{values} values are not those of {} x {} x {} voxels", size[0], size[1], size[2])]
    Length {
        /// How many.
        values: usize,
        /// Voxels along x, y and z.
        size: [usize; 3],
    },
    /// Voxels lie beyond the largest index of a grid.
    #[error("{} x {} x {} voxels from {origin:?} on reach beyond index 2147483647", size[0], size[1], size[2])]
    Reach {
        /// Lowest voxel.
        origin: [i32; 3],
        /// Voxels along x, y and z.
        size: [usize; 3],
    },
}

/// Edge of a leaf \[voxels\].
const EDGE: usize = 8;

impl<T: Copy + PartialEq + Send + Sync> SparseGrid<T> {
    /// All voxels of `bounds` with their values, inactive ones included.
    ///
    /// # Errors
    /// When they take more memory than `limits` allow, or than there is.
    pub fn to_dense(&self, bounds: IndexBox, limits: &Limits) -> Result<DenseBox<T>, DenseError> {
        let size = std::array::from_fn(|axis| {
            let voxels = i64::from(bounds.max[axis]) - i64::from(bounds.min[axis]) + 1;
            usize::try_from(voxels).unwrap_or(0)
        });
        let count = size.iter().fold(1_u128, |count, &edge| count * edge as u128);
        let needed = u64::try_from(count * size_of::<T>() as u128).unwrap_or(u64::MAX);
        if needed > limits.max_bytes {
            return Err(DenseError::TooLarge { size, needed, limit: limits.max_bytes });
        }
        let mut values = Vec::new();
        let count = usize::try_from(count).map_err(|_| DenseError::OutOfMemory { size })?;
        values.try_reserve_exact(count).map_err(|_| DenseError::OutOfMemory { size })?;
        values.resize(count, self.background);
        let mut dense = DenseBox { origin: bounds.min, size, values };
        for Tile { origin, dim, value, .. } in &self.tiles {
            dense.set(bounds, IndexBox::cube(*origin, *dim as i32), |_, row| row.fill(*value));
        }
        for (origin, leaf) in self.leaves.iter().zip(self.values.chunks_exact(LEAF_LEN)) {
            dense.set(bounds, IndexBox::cube(*origin, EDGE as i32), |first, row| {
                let local: [usize; 3] =
                    std::array::from_fn(|axis| first[axis].abs_diff(origin[axis]) as usize);
                let start = local[0] << 6 | local[1] << 3 | local[2];
                row.copy_from_slice(&leaf[start..start + row.len()]);
            });
        }
        Ok(dense)
    }

    /// The grid of a dense box: what differs from `background` is active.
    ///
    /// # Errors
    /// When there are more or fewer values than voxels, or voxels that no grid can index.
    pub fn from_dense(
        dense: &DenseBox<T>,
        background: T,
        index_to_world: DAffine3,
    ) -> Result<Self, DenseError> {
        let DenseBox { origin, size, ref values } = *dense;
        let count = size.iter().try_fold(1_usize, |count, &edge| count.checked_mul(edge));
        if count != Some(values.len()) {
            return Err(DenseError::Length { values: values.len(), size });
        }
        let is_within = |axis: usize| {
            i64::try_from(size[axis])
                .is_ok_and(|edge| i64::from(origin[axis]) + edge - 1 <= i64::from(i32::MAX))
        };
        if !(0..3).all(is_within) {
            return Err(DenseError::Reach { origin, size });
        }
        let mut grid = Self {
            background,
            index_to_world,
            leaves: Vec::new(),
            masks: Vec::new(),
            values: Vec::new(),
            tiles: Vec::new(),
        };
        if values.is_empty() {
            return Ok(grid);
        }
        // The lowest index is a multiple of 8 itself: rounding down cannot leave the range.
        let starts = |axis: usize| {
            let last = i64::from(origin[axis]) + size[axis] as i64 - 1;
            (i64::from(origin[axis] & !7)..=last).step_by(EDGE).map(|start| start as i32)
        };
        let slabs: Vec<i32> = starts(0).collect();
        let found: Vec<Vec<Leaf<T>>> = slabs
            .into_par_iter()
            .map(|x| {
                let rows = starts(1).flat_map(|y| starts(2).map(move |z| [x, y, z]));
                rows.filter_map(|place| dense.leaf(place, background)).collect()
            })
            .collect();
        for leaf in found.into_iter().flatten() {
            grid.leaves.push(leaf.origin);
            grid.masks.push(leaf.mask);
            grid.values.extend_from_slice(&*leaf.values);
        }
        Ok(grid)
    }
}

/// A leaf of 8^3 voxels.
struct Leaf<T> {
    origin: [i32; 3],
    mask: [u64; 8],
    values: Box<[T; LEAF_LEN]>,
}

impl<T: Copy + PartialEq> DenseBox<T> {
    /// Hands the rows along z that lie in `cube` to `fill`, each with its first voxel. `bounds` are the box's own.
    fn set(&mut self, bounds: IndexBox, cube: IndexBox, fill: impl Fn([i32; 3], &mut [T])) {
        let Some(inside) = cube.intersection(bounds) else { return };
        let length = inside.max[2].abs_diff(inside.min[2]) as usize + 1;
        for x in inside.min[0]..=inside.max[0] {
            for y in inside.min[1]..=inside.max[1] {
                let first = [x, y, inside.min[2]];
                let start = self.index(first);
                fill(first, &mut self.values[start..start + length]);
            }
        }
    }

    /// The leaf at `origin`, if any voxel in it is active.
    fn leaf(&self, origin: [i32; 3], background: T) -> Option<Leaf<T>> {
        let last = |axis: usize| self.origin[axis] as i64 + self.size[axis] as i64 - 1;
        let bounds =
            IndexBox { min: self.origin, max: std::array::from_fn(|axis| last(axis) as i32) };
        let inside = IndexBox::cube(origin, EDGE as i32).intersection(bounds)?;
        let mut values = Box::new([background; LEAF_LEN]);
        let mut mask = [0_u64; 8];
        for x in inside.min[0]..=inside.max[0] {
            for y in inside.min[1]..=inside.max[1] {
                for z in inside.min[2]..=inside.max[2] {
                    let value = self.values[self.index([x, y, z])];
                    if value != background {
                        let [i, j, k] = [x - origin[0], y - origin[1], z - origin[2]];
                        values[(i << 6 | j << 3 | k) as usize] = value;
                        mask[i as usize] |= 1 << (j << 3 | k);
                    }
                }
            }
        }
        (mask != [0; 8]).then_some(Leaf { origin, mask, values })
    }

    /// Where the value of a voxel of the box lies.
    fn index(&self, voxel: [i32; 3]) -> usize {
        let along = |axis: usize| voxel[axis].abs_diff(self.origin[axis]) as usize;
        (along(0) * self.size[1] + along(1)) * self.size[2] + along(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checkered(origin: [i32; 3], size: [usize; 3]) -> DenseBox<f32> {
        let count = size.iter().product();
        let value = |index: usize| if index.is_multiple_of(3) { 0.0 } else { index as f32 };
        DenseBox { origin, size, values: (0..count).map(value).collect() }
    }

    fn bounds(dense: &DenseBox<f32>) -> IndexBox {
        let max = std::array::from_fn(|axis| dense.origin[axis] + (dense.size[axis] as i32 - 1));
        IndexBox { min: dense.origin, max }
    }

    #[test]
    fn a_box_comes_back_as_it_was() {
        for (origin, size) in [
            ([0, 0, 0], [8, 8, 8]),
            ([-5, 3, -17], [11, 1, 30]),
            ([i32::MIN, i32::MAX - 8, -1], [9, 9, 2]),
        ] {
            let dense = checkered(origin, size);
            let grid = SparseGrid::from_dense(&dense, 0.0, DAffine3::IDENTITY).unwrap();
            let active: u32 = grid.masks.iter().flatten().map(|word| word.count_ones()).sum();
            let expected = dense.values.iter().filter(|&&value| value != 0.0).count();
            assert_eq!(active as usize, expected);
            assert_eq!(grid.to_dense(bounds(&dense), &Limits::default()).unwrap(), dense);
        }
    }

    #[test]
    fn tiles_fill_their_cube_and_nothing_else() {
        let tile = Tile { origin: [8, 8, 8], dim: 8, value: 2.0_f32, active: true };
        let empty = DenseBox { origin: [0; 3], size: [0; 3], values: Vec::new() };
        let mut grid = SparseGrid::from_dense(&empty, -1.0, DAffine3::IDENTITY).unwrap();
        grid.tiles.push(tile);
        let bounds = IndexBox { min: [7, 8, 14], max: [8, 9, 16] };
        let dense = grid.to_dense(bounds, &Limits::default()).unwrap();
        assert_eq!(dense.size, [2, 2, 3]);
        let row = [2.0, 2.0, -1.0];
        assert_eq!(dense.values, [[-1.0; 3], [-1.0; 3], row, row].concat());
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let dense = DenseBox { origin: [0; 3], size: [2, 2, 2], values: vec![1.0_f32; 7] };
        let grid = |dense| SparseGrid::from_dense(dense, 0.0, DAffine3::IDENTITY);
        assert_eq!(grid(&dense).unwrap_err(), DenseError::Length { values: 7, size: [2; 3] });
        let dense = DenseBox { origin: [0, 0, i32::MAX], size: [1, 1, 2], values: vec![1.0; 2] };
        assert!(matches!(grid(&dense).unwrap_err(), DenseError::Reach { .. }));
        let dense = checkered([0; 3], [4; 3]);
        let all = IndexBox { min: [i32::MIN; 3], max: [i32::MAX; 3] };
        let refused = grid(&dense).unwrap().to_dense(all, &Limits::default()).unwrap_err();
        assert!(matches!(refused, DenseError::TooLarge { needed: u64::MAX, .. }), "{refused}");
    }
}
