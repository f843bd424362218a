//! The values of the leaves, packed in parallel and written in order.

use std::io::{self, Seek, Write};

use rayon::prelude::*;

use super::block::NodeValues;
use super::order::{Entry, Item};
use super::output::Output;
use super::pack::Packer;
use super::tree::put_mask;
use super::value::StoredValue;
use crate::medium::vdb::block::Layout;
use crate::medium::vdb::sparse::SparseGrid;
use crate::medium::vdb::tree::LEAF_LEN;

/// Leaves a thread takes at once: one alone is too little work.
const LEAVES_A_TASK: usize = 128;
/// Entries packed before any is written: what lies in memory at a time.
const ENTRIES_A_BATCH: usize = 64 * LEAVES_A_TASK;

/// Writes the values of all leaves of a grid whose leaves and tiles are sorted.
pub(super) fn put_leaves<V: StoredValue, W: Write + Seek>(
    grid: &SparseGrid<V>,
    entries: &[Entry],
    layout: &Layout,
    background: V,
    output: &mut Output<W>,
) -> io::Result<()> {
    for batch in entries.chunks(ENTRIES_A_BATCH) {
        let packed: Vec<Vec<u8>> = batch
            .par_chunks(LEAVES_A_TASK)
            .map_init(Packer::new, |packer, entries| {
                let mut bytes = Vec::new();
                for entry in entries {
                    if let Item::Leaf(index) = entry.item {
                        put_leaf(grid, index, layout, background, packer, &mut bytes);
                    }
                }
                bytes
            })
            .collect();
        packed.iter().try_for_each(|bytes| output.put(bytes))?;
    }
    Ok(())
}

/// Appends a leaf: its mask a second time, and its values.
fn put_leaf<V: StoredValue>(
    grid: &SparseGrid<V>,
    index: usize,
    layout: &Layout,
    background: V,
    packer: &mut Packer,
    bytes: &mut Vec<u8>,
) {
    let active = &grid.masks[index];
    put_mask(active, bytes);
    let values = &grid.values[LEAF_LEN * index..][..LEAF_LEN];
    NodeValues { values, active, children: &[], background }.put(layout, packer, bytes);
}
