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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DAffine3;

    fn grid(tiles: &[([i32; 3], u32, bool)]) -> SparseGrid<f32> {
        SparseGrid {
            background: -1.0,
            index_to_world: DAffine3::IDENTITY,
            leaves: vec![[8, 0, -8]],
            masks: vec![[u64::MAX / 3; 8]],
            values: (0..512).map(|offset| offset as f32).collect(),
            tiles: tiles
                .iter()
                .map(|&(origin, dim, active)| Tile { origin, dim, value: dim as f32, active })
                .collect(),
        }
    }

    fn holds(bounds: IndexBox, voxel: [i32; 3]) -> bool {
        IndexBox::cube(voxel, 1).intersection(bounds).is_some()
    }

    /// Value and state of a voxel; it must not be stored twice.
    fn at(grid: &SparseGrid<f32>, voxel: [i32; 3]) -> (f32, bool) {
        let leaves = grid.leaves.iter().enumerate();
        let leaves = leaves.filter(|(_, origin)| holds(IndexBox::cube(**origin, 8), voxel));
        let leaves = leaves.map(|(leaf, origin)| {
            let place: [i32; 3] = std::array::from_fn(|axis| voxel[axis] - origin[axis]);
            let offset = (place[0] << 6 | place[1] << 3 | place[2]) as usize;
            let active = grid.masks[leaf][offset >> 6] >> (offset & 63) & 1 == 1;
            (grid.values[LEAF_LEN * leaf + offset], active)
        });
        let tiles = grid.tiles.iter();
        let tiles = tiles.filter(|t| holds(IndexBox::cube(t.origin, t.dim as i32), voxel));
        let found: Vec<_> = leaves.chain(tiles.map(|tile| (tile.value, tile.active))).collect();
        assert!(found.len() <= 1, "{voxel:?} is stored {} times", found.len());
        found.first().copied().unwrap_or((grid.background, false))
    }

    #[test]
    fn voxels_inside_stay_and_those_outside_are_background() {
        let source = grid(&[
            ([0, 0, 0], 8, true),
            ([0, 8, 0], 8, false),
            ([-128, 0, 0], 128, true),
            ([-4096, -4096, 0], 4096, true),
            ([4096, 0, 0], 4096, false),
        ]);
        for bounds in [
            IndexBox { min: [-3, -2, -4], max: [12, 9, 3] },
            IndexBox { min: [-60, -60, 17], max: [4106, 3, 19] },
            IndexBox { min: [-128, 0, 0], max: [-1, 127, 127] },
            IndexBox { min: [i32::MIN; 3], max: [i32::MAX; 3] },
            IndexBox { min: [i32::MIN, -5, 5], max: [-4000, 5, 5] },
        ] {
            let mut cropped = source.clone();
            crop(&mut cropped, bounds, &Limits::default()).unwrap();
            let ends = |axis: usize| {
                let near = [bounds.min[axis], bounds.max[axis], 0, 8, -128, 127, 4096];
                near.into_iter().flat_map(|end: i32| (-1..=1).map(move |by| end.saturating_add(by)))
            };
            for voxel in
                ends(0).flat_map(|x| ends(1).flat_map(move |y| ends(2).map(move |z| [x, y, z])))
            {
                let expected =
                    if holds(bounds, voxel) { at(&source, voxel) } else { (-1.0, false) };
                assert_eq!(at(&cropped, voxel), expected, "{voxel:?} of {bounds:?}");
            }
        }
    }

    #[test]
    fn what_lies_inside_is_not_touched() {
        let source = grid(&[([-4096, -4096, 0], 4096, true), ([-128, 0, 0], 128, false)]);
        let mut cropped = source.clone();
        let bounds = IndexBox { min: [-4096; 3], max: [4095; 3] };
        crop(&mut cropped, bounds, &Limits::default()).unwrap();
        assert_eq!((cropped.leaves, cropped.masks), (source.leaves, source.masks));
        assert_eq!(cropped.values, source.values);
        assert_eq!(cropped.tiles.len(), 2);
    }

    #[test]
    fn a_tile_falls_into_the_largest_pieces() {
        let mut cropped = grid(&[([0, 0, 0], 4096, true)]);
        crop(&mut cropped, IndexBox { min: [0; 3], max: [135, 127, 127] }, &Limits::default())
            .unwrap();
        let count = |dim| cropped.tiles.iter().filter(|tile| tile.dim == dim).count();
        assert_eq!([count(128), count(8), cropped.tiles.len()], [1, 256, 257]);
    }

    #[test]
    fn pieces_beyond_the_limit_are_an_error() {
        let limits = Limits { max_bytes: 1 << 20 };
        let mut cropped = grid(&[([0, 0, 0], 4096, true)]);
        let bounds = IndexBox { min: [1; 3], max: [4094; 3] };
        let error = crop(&mut cropped, bounds, &limits).unwrap_err();
        assert!(error.to_string().contains("1.0 MiB"), "{error}");
    }
}
