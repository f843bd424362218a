//! What a file says of a grid's values, so that readers need not count: bounds, active voxels,
//! memory.

use std::collections::BTreeMap;

use super::order::Entry;
use super::value::StoredValue;
use crate::medium::vdb::metadata::MetadataValue;
use crate::medium::vdb::sparse::SparseGrid;
use crate::medium::vdb::summary::{IndexBox, active_bounds};
use crate::medium::vdb::tree::{LEAF_LEN, count_ones};

/// Bytes of a leaf beyond its values in the OpenVDB library (10.0, 64 bits).
const LEAF_BYTES: u64 = 96;
/// Places of the nodes between root and leaves, with the bytes beyond them: two masks and an origin.
const UPPER_NODE: (u64, u64) = (32_768, 2 * 4096 + 12);
const LOWER_NODE: (u64, u64) = (4096, 2 * 512 + 12);

/// Counts of a grid's values.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Statistics {
    pub active_voxel_count: u64,
    bbox: Option<IndexBox>,
    memory_bytes: u64,
}

impl Statistics {
    /// Of the grid, whose leaves and tiles are those of `entries`.
    pub(super) fn of<V: StoredValue>(grid: &SparseGrid<V>, entries: &[Entry]) -> Self {
        let leaves = grid.leaves.iter().zip(&grid.masks);
        let leaf_boxes = leaves.filter_map(|(&origin, mask)| active_bounds(origin, mask));
        let active_tiles = || grid.tiles.iter().filter(|tile| tile.active);
        let tile_boxes = active_tiles().map(|tile| IndexBox::cube(tile.origin, tile.dim as i32));
        let leaf_voxels: u64 = grid.masks.iter().map(|mask| count_ones(mask) as u64).sum();
        let tile_voxels = active_tiles().map(|tile| u64::from(tile.dim).pow(3));
        Self {
            active_voxel_count: tile_voxels.fold(leaf_voxels, u64::saturating_add),
            bbox: leaf_boxes.chain(tile_boxes).reduce(IndexBox::union),
            memory_bytes: memory_bytes::<V>(entries, grid.leaves.len() as u64),
        }
    }

    /// Under the names the OpenVDB library has for them.
    pub(super) fn metadata(&self) -> BTreeMap<String, MetadataValue> {
        // The library's empty box is inside out.
        let empty = IndexBox { min: [i32::MAX; 3], max: [i32::MIN; 3] };
        let bbox = self.bbox.unwrap_or(empty);
        let values = [
            ("file_bbox_max", MetadataValue::coordinates(bbox.max)),
            ("file_bbox_min", MetadataValue::coordinates(bbox.min)),
            ("file_mem_bytes", MetadataValue::count(self.memory_bytes)),
            ("file_voxel_count", MetadataValue::count(self.active_voxel_count)),
        ];
        values.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// Memory of the tree in the OpenVDB library.
fn memory_bytes<V: StoredValue>(entries: &[Entry], leaf_count: u64) -> u64 {
    let node_bytes = |(places, rest): (u64, u64)| places * V::PLACE_BYTES + rest;
    let inner = entries.iter().filter(|entry| !entry.is_root_tile());
    let deep = inner.clone().filter(|entry| !entry.is_upper_tile());
    let upper_count = count_runs(inner.map(|entry| entry.region));
    let lower_count = count_runs(deep.map(|entry| (entry.region, entry.upper_place())));
    V::TREE_BYTES
        + upper_count * node_bytes(UPPER_NODE)
        + lower_count * node_bytes(LOWER_NODE)
        + leaf_count * (LEAF_BYTES + (LEAF_LEN * size_of::<V>()) as u64)
}

/// Number of runs of equal keys.
fn count_runs<K: PartialEq + Copy>(keys: impl Iterator<Item = K>) -> u64 {
    let mut last = None;
    keys.filter(|&key| last.replace(key) != Some(key)).count() as u64
}
