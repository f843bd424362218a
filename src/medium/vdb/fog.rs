//! From a level set to a fog volume: density 0 on the surface and outside, rising with the depth below the
//! surface to 1 where the level set's distances end.
//!
//! density = distance / cutoff for distance <= 0, else 0; the cutoff is the least distance of the level set, that
//! of its interior tiles where it has some. Those tiles, and voxels as deep, become active with density 1. The same
//! numbers, bit for bit, as `tools::sdfToFogVolume` of the OpenVDB library with its default cutoff.

use rayon::prelude::*;

use super::sparse::{SparseGrid, Tile};
use super::tree::LEAF_LEN;

/// Edge of the tiles that stand beside leaves, which tell the cutoff \[voxels\].
const LEAF_DIM: u32 = 8;

/// The fog inside a level set, whose distances are negative inside. Nothing is inside one without negative
/// distances; its fog is empty.
pub fn fog_of_level_set(distances: SparseGrid<f32>) -> SparseGrid<f32> {
    let weight = 1.0 / cutoff(&distances);
    let SparseGrid { index_to_world, leaves, masks, mut values, tiles, .. } = distances;
    let active: Vec<[u64; 8]> = values
        .par_chunks_exact_mut(LEAF_LEN)
        .map(|values| {
            let mut mask = [0; 8];
            for (offset, value) in values.iter_mut().enumerate() {
                *value = if *value > 0.0 { 0.0 } else { *value * weight };
                if *value > 0.0 {
                    mask[offset >> 6] |= 1 << (offset & 63);
                }
            }
            mask
        })
        .collect();
    drop(masks);
    let interior = tiles.into_iter().filter(|tile| tile.value < 0.0);
    let mut fog = SparseGrid {
        background: 0.0,
        index_to_world,
        leaves,
        masks: active,
        values,
        tiles: interior.map(|tile| Tile { value: 1.0, active: true, ..tile }).collect(),
    };
    drop_empty_leaves(&mut fog);
    fog
}

/// The least finite distance of the tiles beside leaves, or of the voxels when no such tile is inside.
fn cutoff(distances: &SparseGrid<f32>) -> f32 {
    let least = |least: f32, value: f32| if value.is_finite() { least.min(value) } else { least };
    let tiles = distances.tiles.iter().filter(|tile| tile.dim == LEAF_DIM);
    let of_tiles = tiles.map(|tile| tile.value).fold(f32::INFINITY, least);
    if of_tiles <= 0.0 {
        return of_tiles;
    }
    distances
        .values
        .par_chunks(64 * LEAF_LEN)
        .map(|values| values.iter().copied().fold(of_tiles, least))
        .reduce(|| of_tiles, f32::min)
}

/// Moves the leaves with active voxels to the front and cuts off the others.
fn drop_empty_leaves(grid: &mut SparseGrid<f32>) {
    let mut kept = 0;
    for leaf in 0..grid.leaves.len() {
        if grid.masks[leaf] == [0; 8] {
            continue;
        }
        grid.leaves[kept] = grid.leaves[leaf];
        grid.masks[kept] = grid.masks[leaf];
        grid.values.copy_within(leaf * LEAF_LEN..(leaf + 1) * LEAF_LEN, kept * LEAF_LEN);
        kept += 1;
    }
    grid.leaves.truncate(kept);
    grid.masks.truncate(kept);
    grid.values.truncate(kept * LEAF_LEN);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DAffine3;

    /// A leaf whose first voxels have the distances given, all others being outside; then one wholly outside.
    fn level_set(distances: &[f32], tiles: &[(u32, f32)]) -> SparseGrid<f32> {
        let mut values = vec![3.0; 2 * LEAF_LEN];
        values[LEAF_LEN + 5..][..distances.len()].copy_from_slice(distances);
        let tile = |&(dim, value)| Tile { origin: [4096; 3], dim, value, active: false };
        SparseGrid {
            background: 3.0,
            index_to_world: DAffine3::IDENTITY,
            leaves: vec![[8, 0, 0], [0; 3]],
            masks: vec![[u64::MAX; 8]; 2],
            values,
            tiles: tiles.iter().map(tile).collect(),
        }
    }

    #[test]
    fn the_inside_becomes_active_and_rises_to_one() {
        let fog = fog_of_level_set(level_set(&[-2.0, -0.5, 0.0, -0.0, 1.0], &[]));
        assert_eq!(fog.leaves, [[0; 3]]);
        assert_eq!(fog.background, 0.0);
        assert_eq!(fog.masks[0], [0b11 << 5, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(fog.values[4..11], [0.0, 1.0, 0.25, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(fog.values.len(), LEAF_LEN);
    }

    #[test]
    fn interior_tiles_are_full_and_tell_the_cutoff() {
        let tiles = [(8, -4.0), (128, -7.0), (8, 3.0)];
        let fog = fog_of_level_set(level_set(&[-2.0], &tiles));
        assert_eq!(fog.values[5], 0.5);
        let full = |dim| Tile { origin: [4096; 3], dim, value: 1.0, active: true };
        assert_eq!(fog.tiles, [full(8), full(128)]);
        // A tile above the leaves does not.
        let fog = fog_of_level_set(level_set(&[-2.0], &[(128, -7.0)]));
        assert_eq!(fog.values[5], 1.0);
    }

    #[test]
    fn nothing_inside_is_no_fog() {
        for distances in [&[][..], &[0.0], &[f32::NAN]] {
            let fog = fog_of_level_set(level_set(distances, &[]));
            assert!(fog.leaves.is_empty() && fog.tiles.is_empty());
        }
    }
}
