//! Cutting a grid to a box of voxels.
//!
//! Leaves on the boundary lose voxels, tiles on the boundary fall into smaller ones and, at the
//! last, into leaves; what lies inside is not touched.

use super::Limits;
use super::error::memory_size;
use super::sparse::{SparseGrid, Tile};
use super::summary::{IndexBox, memory_bytes};
use super::tree::LEAF_LEN;

/// Tiles on the boundary fall into more leaves and tiles than memory allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "it cuts tiles into more pieces than fit into {}; cut at multiples of 8, 128 or 4096 voxels, where tiles end",
    memory_size(*limit)
)]
pub struct CropError {
    /// Memory allowed \[bytes\].
    pub limit: u64,
}

/// Makes everything outside `bounds` inactive background. The grid's leaves and tiles stay aligned;
/// those wholly outside go.
///
/// # Errors
/// When the pieces of tiles on the boundary make the grid larger than `limits`; the grid is then
/// cropped in part.
pub fn crop<V: Copy + Default>(
    grid: &mut SparseGrid<V>,
    bounds: IndexBox,
    limits: &Limits,
) -> Result<(), CropError> {
    crop_leaves(grid, bounds);
    let mut uncut = std::mem::take(&mut grid.tiles);
    // Depth first, so that few pieces wait at a time.
    while let Some(tile) = uncut.pop() {
        let cube = IndexBox::cube(tile.origin, tile.dim as i32);
        let Some(inside) = cube.intersection(bounds) else {
            continue;
        };
        if inside == cube {
            grid.tiles.push(tile);
        } else if tile.dim == 8 {
            push_leaf(grid, tile, inside);
        } else {
            uncut.extend(pieces(tile, inside));
        }
        let [leaf_count, tile_count] = [grid.leaves.len(), grid.tiles.len() + uncut.len()];
        let needed = memory_bytes(leaf_count as u64, tile_count as u64, size_of::<V>());
        if needed > limits.max_bytes {
            return Err(CropError { limit: limits.max_bytes });
        }
    }
    Ok(())
}

/// Drops the leaves outside and clears the voxels outside of those on the boundary, keeping the
/// order of leaves.
fn crop_leaves<V: Copy>(grid: &mut SparseGrid<V>, bounds: IndexBox) {
    let background = grid.background;
    let whole_count = grid.masks.len().min(grid.values.len() / LEAF_LEN).min(grid.leaves.len());
    let mut kept = 0;
    for index in 0..whole_count {
        let cube = IndexBox::cube(grid.leaves[index], 8);
        let Some(inside) = cube.intersection(bounds) else {
            continue;
        };
        grid.leaves[kept] = grid.leaves[index];
        grid.masks[kept] = grid.masks[index];
        grid.values.copy_within(LEAF_LEN * index..LEAF_LEN * (index + 1), LEAF_LEN * kept);
        if inside != cube {
            let kept_mask = box_mask(cube.min, inside);
            let values = &mut grid.values[LEAF_LEN * kept..][..LEAF_LEN];
            for (offset, value) in values.iter_mut().enumerate() {
                if kept_mask[offset >> 6] >> (offset & 63) & 1 == 0 {
                    *value = background;
                }
            }
            grid.masks[kept] = std::array::from_fn(|word| grid.masks[kept][word] & kept_mask[word]);
        }
        kept += 1;
    }
    grid.leaves.truncate(kept);
    grid.masks.truncate(kept);
    grid.values.truncate(LEAF_LEN * kept);
}

/// Adds the part of a tile of 8^3 voxels that lies in `inside` as a leaf.
fn push_leaf<V: Copy>(grid: &mut SparseGrid<V>, tile: Tile<V>, inside: IndexBox) {
    let kept_mask = box_mask(tile.origin, inside);
    let is_inside = |offset: usize| kept_mask[offset >> 6] >> (offset & 63) & 1 == 1;
    let background = grid.background;
    let values =
        (0..LEAF_LEN).map(|offset| if is_inside(offset) { tile.value } else { background });
    grid.values.extend(values);
    grid.masks.push(if tile.active { kept_mask } else { [0; 8] });
    grid.leaves.push(tile.origin);
}

/// The tiles of the next smaller size that meet `inside`.
fn pieces<V: Copy>(tile: Tile<V>, inside: IndexBox) -> impl Iterator<Item = Tile<V>> {
    let dim = if tile.dim == 4096 { 128 } else { 8 };
    let step = dim as usize;
    let along = move |axis: usize| {
        let first = inside.min[axis] & !(dim - 1);
        (first..=inside.max[axis]).step_by(step)
    };
    along(0).flat_map(move |x| {
        along(1).flat_map(move |y| {
            along(2).map(move |z| Tile { origin: [x, y, z], dim: dim as u32, ..tile })
        })
    })
}

/// The voxels of the leaf at `origin` that lie in `inside`, which lies in the leaf.
fn box_mask(origin: [i32; 3], inside: IndexBox) -> [u64; 8] {
    let holds = |axis: usize, along: usize| {
        let voxel = origin[axis] + along as i32;
        inside.min[axis] <= voxel && voxel <= inside.max[axis]
    };
    std::array::from_fn(|x| {
        let bits = (0..64).filter(|&yz| holds(0, x) && holds(1, yz >> 3) && holds(2, yz & 7));
        bits.fold(0, |mask, bit| mask | 1 << bit)
    })
}
