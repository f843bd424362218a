//! The order of leaves and tiles in the file: depth first, x slowest at every level.
//!
//! A voxel's place is its region of 4096^3 voxels, then the 15 bits of its child of 128^3 in there,
//! then the 12 bits of its child of 8^3 in that one. Every leaf and tile covers a run of places, so
//! that sorting by place puts them in order, and two that overlap next to each other.

use rayon::prelude::*;

use super::error::GridProblem;
use crate::medium::vdb::sparse::SparseGrid;
use crate::medium::vdb::tree::{LEAF_LEN, ROOT_DIM};

/// Bits of a place below the child of the root.
const LOWER_BITS: u32 = 12;

/// A leaf or a tile, and where it belongs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Lowest voxel of the root's child.
    pub region: [i32; 3],
    /// First place in the region.
    place: u32,
    /// Number of places.
    span: u32,
    pub item: Item,
}

/// Which leaf or tile of the grid.
#[derive(Clone, Copy, Debug)]
pub(super) enum Item {
    Leaf(usize),
    Tile(usize),
}

impl Entry {
    fn new(origin: [i32; 3], dim: u32, span: u32, item: Item) -> Result<Self, GridProblem> {
        // Edges are powers of two.
        if origin.iter().any(|&along| along & (dim as i32 - 1) != 0) {
            return Err(GridProblem::Misaligned { origin, dim });
        }
        let inside = origin.map(|along| (along & (ROOT_DIM - 1)) as u32);
        let upper = inside.iter().fold(0, |place, along| place << 5 | along >> 7);
        let lower = inside.iter().fold(0, |place, along| place << 4 | along >> 3 & 15);
        let region = origin.map(|along| along & !(ROOT_DIM - 1));
        Ok(Self { region, place: upper << LOWER_BITS | lower, span, item })
    }

    /// Whether it is all of its region.
    pub(super) fn is_root_tile(&self) -> bool {
        self.span == 1 << (15 + LOWER_BITS)
    }

    /// Whether it is all of a child of 128^3 voxels.
    pub(super) fn is_upper_tile(&self) -> bool {
        self.span == 1 << LOWER_BITS
    }

    /// Place among the children of a region.
    pub(super) fn upper_place(&self) -> usize {
        (self.place >> LOWER_BITS) as usize
    }

    /// Place among the children of 8^3 voxels of one of 128^3.
    pub(super) fn lower_place(&self) -> usize {
        (self.place & ((1 << LOWER_BITS) - 1)) as usize
    }
}

/// Sorts the leaves and tiles of a grid, and makes sure that they fit together.
pub(super) fn entries_in_order<V: Sync>(grid: &SparseGrid<V>) -> Result<Vec<Entry>, GridProblem> {
    let [leaves, masks, values] = [grid.leaves.len(), grid.masks.len(), grid.values.len()];
    if masks != leaves || leaves.checked_mul(LEAF_LEN) != Some(values) {
        return Err(GridProblem::Lengths { leaves, masks, values });
    }
    let leaves = grid.leaves.iter().enumerate();
    let leaves = leaves.map(|(index, &origin)| Entry::new(origin, 8, 1, Item::Leaf(index)));
    let tiles = grid.tiles.iter().enumerate().map(|(index, tile)| {
        let (origin, dim) = (tile.origin, tile.dim);
        let span = match dim {
            8 => 1,
            128 => 1 << LOWER_BITS,
            4096 => 1 << (15 + LOWER_BITS),
            _ => return Err(GridProblem::TileSize { origin, dim }),
        };
        Entry::new(origin, dim, span, Item::Tile(index))
    });
    let mut entries = leaves.chain(tiles).collect::<Result<Vec<_>, _>>()?;
    entries.par_sort_unstable_by_key(|entry| (entry.region, entry.place));

    let overlapping = entries.windows(2).find(|pair| {
        pair[0].region == pair[1].region && pair[1].place - pair[0].place < pair[0].span
    });
    // Runs are nested where they overlap: an origin of the shorter is a voxel of both.
    match overlapping.map(|pair| if pair[0].span < pair[1].span { pair[0] } else { pair[1] }) {
        Some(Entry { item: Item::Leaf(index), .. }) => {
            Err(GridProblem::Overlap { voxel: grid.leaves[index] })
        }
        Some(Entry { item: Item::Tile(index), .. }) => {
            Err(GridProblem::Overlap { voxel: grid.tiles[index].origin })
        }
        None => Ok(entries),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DAffine3;
    use crate::medium::vdb::sparse::Tile;

    fn grid(leaves: &[[i32; 3]], tiles: &[([i32; 3], u32)]) -> SparseGrid<f32> {
        SparseGrid {
            background: 0.0,
            index_to_world: DAffine3::IDENTITY,
            leaves: leaves.to_vec(),
            masks: vec![[0; 8]; leaves.len()],
            values: vec![0.0; 512 * leaves.len()],
            tiles: tiles
                .iter()
                .map(|&(origin, dim)| Tile { origin, dim, value: 1.0, active: true })
                .collect(),
        }
    }

    #[test]
    fn x_is_slowest_at_every_level() {
        let leaves = [[0, 0, 8], [0, 0, 128], [0, 0, 0], [8, 0, 0], [-8, 0, 0], [0, 8, 0]];
        let order = entries_in_order(&grid(&leaves, &[([4096, 0, 0], 4096)])).unwrap();
        let sorted: Vec<_> = order
            .iter()
            .filter_map(|entry| match entry.item {
                Item::Leaf(index) => Some(leaves[index]),
                Item::Tile(_) => None,
            })
            .collect();
        let expected = [[-8, 0, 0], [0, 0, 0], [0, 0, 8], [0, 8, 0], [8, 0, 0], [0, 0, 128]];
        assert_eq!(sorted, expected);
        assert!(order[6].is_root_tile());
        assert_eq!([order[0].upper_place(), order[0].lower_place()], [31 << 10, 15 << 8]);
    }

    #[test]
    fn overlaps_are_found_at_every_level() {
        let voxel = [-128, 8, 136];
        for tiles in [
            vec![([-128, 8, 136], 8)],
            vec![([-128, 0, 128], 128)],
            vec![([-4096, 0, 0], 4096)],
            vec![([-128, 8, 136], 8), ([0, 0, 0], 4096)],
        ] {
            let problem = entries_in_order(&grid(&[voxel], &tiles)).unwrap_err();
            assert_eq!(problem, GridProblem::Overlap { voxel });
        }
        let twice = entries_in_order(&grid(&[voxel, [0; 3], voxel], &[])).unwrap_err();
        assert_eq!(twice, GridProblem::Overlap { voxel });
        // Lower places of the same region lie before the tile.
        let tiles = [([-128, 0, 128], 128), ([-4096, 0, 0], 128)];
        assert!(entries_in_order(&grid(&[[-8, 128, 0]], &tiles)).is_ok());
    }
}
