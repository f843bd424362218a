//! From the bytes of a tree to a [`SparseGrid`].
//!
//! Where a leaf's values are is known only from the lengths of those before, so one thread runs ahead to find
//! them, a batch at a time, while the others unpack the batch before straight to its place.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::block::{Block, Layout};
use super::codec::Scratch;
use super::cursor::Cursor;
use super::fault::Fault;
use super::sparse::{SparseGrid, Tile};
use super::summary::{Census, memory_bytes};
use super::tree::{LEAF_LEN, Node, ROOT_DIM, TreeVisitor, leaf_block, walk};
use super::value::{GridValue, ValueType};
use crate::math::DAffine3;

/// Where a grid's tree lies in the file and how it is stored.
#[derive(Clone, Debug)]
pub(super) struct StoredTree {
    pub value_type: ValueType,
    pub layout: Layout,
    /// Offset of the topology.
    pub start: usize,
    /// Offset behind the grid.
    pub end: usize,
    pub census: Census,
}

impl StoredTree {
    /// Memory of the grid when its values are converted to some of `value_size` bytes.
    pub(super) fn memory_bytes(&self, value_size: usize) -> u64 {
        memory_bytes(self.census.leaf_count(), self.census.tile_count(), value_size)
    }
}

/// What a grid may take.
#[derive(Clone, Copy, Debug)]
pub(super) struct Memory {
    /// Bytes taken already.
    pub held: u64,
    /// Bytes allowed, those taken included.
    pub limit: u64,
}

/// Leaves found ahead of their unpacking.
const LEAVES_A_BATCH: usize = 4096;
/// Leaves a thread takes at once: one alone is too little work.
const LEAVES_A_TASK: usize = 64;

/// Reads the tree, whose values must be of type `V`, converting every value.
pub(super) fn load<V: GridValue, O: Copy + Default + Send + Sync>(
    bytes: &[u8],
    tree: &StoredTree,
    index_to_world: DAffine3,
    memory: Memory,
    convert: impl Fn(V) -> O + Copy + Sync,
) -> Result<SparseGrid<O>, Fault> {
    let needed = memory.held.saturating_add(tree.memory_bytes(size_of::<O>()));
    if needed > memory.limit {
        return Err(Fault::TooLarge { needed, limit: memory.limit });
    }
    let leaf_count = tree.census.leaf_count();
    let mut builder = Builder {
        layout: &tree.layout,
        convert,
        background: V::default(),
        grid: SparseGrid {
            background: O::default(),
            index_to_world,
            leaves: with_room(leaf_count, needed)?,
            masks: with_room(leaf_count, needed)?,
            values: Vec::new(),
            tiles: with_room(tree.census.tile_count(), needed)?,
        },
        node_values: Vec::new(),
        scratch: Scratch::default(),
    };
    let bytes = bytes.get(..tree.end).unwrap_or(bytes);
    let mut cursor = Cursor::new(bytes, tree.start);
    walk(&mut cursor, &tree.layout, &mut builder)?;
    let Builder { mut grid, background, .. } = builder;

    let unpacking = Unpacking { layout: &tree.layout, masks: &grid.masks, background, convert };
    let mut values = with_room(leaf_count, needed)?;
    unpacking.unpack_all(cursor, &mut values)?;
    grid.values = values.into_flattened();
    Ok(grid)
}

/// An empty vector with room for `len` elements, or the error that there is none.
fn with_room<T>(len: u64, needed: u64) -> Result<Vec<T>, Fault> {
    let mut vector = Vec::new();
    match usize::try_from(len).map(|len| vector.try_reserve_exact(len)) {
        Ok(Ok(())) => Ok(vector),
        _ => Err(Fault::OutOfMemory { needed }),
    }
}

/// What the values of all leaves have in common.
struct Unpacking<'a, V, C> {
    layout: &'a Layout,
    masks: &'a [[u64; 8]],
    background: V,
    convert: C,
}

impl<V: GridValue, C> Unpacking<'_, V, C> {
    /// Unpacks the leaves whose values begin at the cursor.
    fn unpack_all<'f, O: Copy + Default + Send + Sync>(
        &self,
        mut cursor: Cursor<'f>,
        values: &mut Vec<[O; LEAF_LEN]>,
    ) -> Result<(), Fault>
    where
        C: Fn(V) -> O + Copy + Sync,
    {
        let mut find = |masks: &[[u64; 8]], batch: &mut Vec<Block<'f>>| {
            batch.clear();
            for mask in masks {
                batch.push(leaf_block(&mut cursor, self.layout, mask)?);
            }
            Ok(())
        };
        let mut ahead = self.masks.chunks(LEAVES_A_BATCH);
        let (mut batch, mut next) = (Vec::new(), Vec::new());
        find(ahead.next().unwrap_or(&[]), &mut batch)?;
        while !batch.is_empty() {
            let (found, unpacked) = rayon::join(
                || find(ahead.next().unwrap_or(&[]), &mut next),
                || self.unpack_batch(&batch, values),
            );
            unpacked?;
            found?;
            std::mem::swap(&mut batch, &mut next);
        }
        Ok(())
    }

    /// Unpacks the leaves that follow those unpacked. The fault, if any, is that of the first leaf that has one.
    fn unpack_batch<O: Copy + Default + Send + Sync>(
        &self,
        batch: &[Block<'_>],
        values: &mut Vec<[O; LEAF_LEN]>,
    ) -> Result<(), Fault>
    where
        C: Fn(V) -> O + Copy + Sync,
    {
        let masks = &self.masks[values.len()..][..batch.len()];
        let unpack = |block: &Block<'_>, mask: &[u64; 8], scratch: &mut Scratch| {
            let mut leaf = [O::default(); LEAF_LEN];
            block
                .unpack(self.layout, mask, self.background, self.convert, &mut leaf, scratch)
                .map(|()| leaf)
        };
        let first_fault = AtomicUsize::new(usize::MAX);
        let leaves = batch.par_iter().zip(masks).enumerate().with_min_len(LEAVES_A_TASK);
        values.par_extend(leaves.map_init(Scratch::default, |scratch, (number, (block, mask))| {
            unpack(block, mask, scratch).unwrap_or_else(|_| {
                first_fault.fetch_min(number, Ordering::Relaxed);
                [O::default(); LEAF_LEN]
            })
        }));
        match first_fault.into_inner() {
            usize::MAX => Ok(()),
            number => unpack(&batch[number], &masks[number], &mut Scratch::default()).map(drop),
        }
    }
}

/// Collects leaves and tiles.
struct Builder<'l, V, O, C> {
    layout: &'l Layout,
    convert: C,
    background: V,
    grid: SparseGrid<O>,
    node_values: Vec<V>,
    scratch: Scratch,
}

impl<V: GridValue, O: Copy, C: Fn(V) -> O> Builder<'_, V, O, C> {
    fn push_tile(&mut self, origin: [i32; 3], dim: i32, value: V, active: bool) {
        self.grid.tiles.push(Tile {
            origin,
            dim: dim.unsigned_abs(),
            value: (self.convert)(value),
            active,
        });
    }
}

impl<V: GridValue, O: Copy, C: Fn(V) -> O> TreeVisitor for Builder<'_, V, O, C> {
    fn background(&mut self, value: &[u8]) -> Result<(), Fault> {
        self.background = V::from_bytes(value);
        self.grid.background = (self.convert)(self.background);
        Ok(())
    }

    fn root_tile(&mut self, origin: [i32; 3], value: &[u8], active: bool) -> Result<(), Fault> {
        let value = V::from_bytes(value);
        if !active && value.is_same(self.background) {
            return Ok(());
        }
        self.push_tile(origin, ROOT_DIM, value, active);
        Ok(())
    }

    fn node(&mut self, node: &Node<'_>) -> Result<(), Fault> {
        let mut values = std::mem::take(&mut self.node_values);
        let background = self.background;
        if node.unpack_tiles(self.layout, background, &mut values, &mut self.scratch)? {
            for (offset, active) in node.tiles_beside(background, &values) {
                let origin = node.child_origin(offset);
                self.push_tile(origin, node.level.child_dim, values[offset], active);
            }
        }
        self.node_values = values;
        Ok(())
    }

    fn leaf(&mut self, origin: [i32; 3], mask: [u64; 8]) -> Result<(), Fault> {
        self.grid.leaves.push(origin);
        self.grid.masks.push(mask);
        Ok(())
    }
}
