//! From the bytes of a tree to a [`SparseGrid`].

use rayon::prelude::*;

use super::Limits;
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
        memory_bytes(self.census.leaf_count(), self.census.active_tile_count, value_size)
    }
}

/// Leaves a thread takes at once: one alone is too little work.
const LEAVES_A_TASK: usize = 64;

/// Reads the tree, whose values must be of type `V`, converting every value.
pub(super) fn load<V: GridValue, O: Copy + Default + Send + Sync>(
    bytes: &[u8],
    tree: &StoredTree,
    index_to_world: DAffine3,
    limits: &Limits,
    convert: impl Fn(V) -> O + Copy + Sync,
) -> Result<SparseGrid<O>, Fault> {
    let needed = tree.memory_bytes(size_of::<O>());
    let mut builder = Builder {
        layout: &tree.layout,
        budget: Budget::new(needed, limits)?,
        convert,
        background: V::default(),
        grid: SparseGrid {
            background: O::default(),
            index_to_world,
            leaves: Vec::new(),
            masks: Vec::new(),
            values: Vec::new(),
            tiles: Vec::new(),
        },
        node_values: Vec::new(),
        scratch: Scratch::default(),
    };
    builder.reserve(&tree.census)?;

    let bytes = bytes.get(..tree.end).unwrap_or(bytes);
    let mut cursor = Cursor::new(bytes, tree.start);
    walk(&mut cursor, &tree.layout, &mut builder)?;
    let Builder { mut grid, background, .. } = builder;

    // Where each leaf's values are is known only from the lengths of those before: find all, then
    // unpack in parallel.
    let blocks = grid
        .masks
        .iter()
        .map(|mask| leaf_block(&mut cursor, &tree.layout, mask))
        .collect::<Result<Vec<Block<'_>>, Fault>>()?;
    grid.values.resize(grid.leaves.len() * LEAF_LEN, O::default());
    grid.values
        .par_chunks_exact_mut(LEAF_LEN)
        .zip(&grid.masks)
        .zip(&blocks)
        .with_min_len(LEAVES_A_TASK)
        .try_for_each_init(Scratch::default, |scratch, ((values, mask), block)| {
            block.unpack(&tree.layout, mask, background, convert, values, scratch)
        })?;
    Ok(grid)
}

/// Memory promised and memory allowed.
#[derive(Debug)]
struct Budget {
    needed: u64,
    limit: u64,
}

impl Budget {
    fn new(needed: u64, limits: &Limits) -> Result<Self, Fault> {
        let mut budget = Self { needed: 0, limit: limits.max_bytes };
        budget.spend(needed)?;
        Ok(budget)
    }

    fn spend(&mut self, bytes: u64) -> Result<(), Fault> {
        self.needed = self.needed.saturating_add(bytes);
        if self.needed > self.limit {
            return Err(Fault::TooLarge { needed: self.needed, limit: self.limit });
        }
        Ok(())
    }

    /// Room for more in a vector, or the error that there is none.
    fn reserve<T>(&self, vector: &mut Vec<T>, additional: u64) -> Result<(), Fault> {
        let out_of_memory = Fault::OutOfMemory { needed: self.needed };
        match usize::try_from(additional).map(|additional| vector.try_reserve(additional)) {
            Ok(Ok(())) => Ok(()),
            _ => Err(out_of_memory),
        }
    }
}

/// Collects leaves and tiles.
struct Builder<'l, V, O, C> {
    layout: &'l Layout,
    budget: Budget,
    convert: C,
    background: V,
    grid: SparseGrid<O>,
    node_values: Vec<V>,
    scratch: Scratch,
}

impl<V, O, C> Builder<'_, V, O, C> {
    fn reserve(&mut self, census: &Census) -> Result<(), Fault> {
        let Self { grid, budget, .. } = self;
        let leaf_count = census.leaf_count();
        budget.reserve(&mut grid.leaves, leaf_count)?;
        budget.reserve(&mut grid.masks, leaf_count)?;
        budget.reserve(&mut grid.values, leaf_count.saturating_mul(LEAF_LEN as u64))?;
        budget.reserve(&mut grid.tiles, census.active_tile_count)
    }
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
        if !active {
            if value.is_same(self.background) {
                return Ok(());
            }
            self.budget.spend(size_of::<Tile<O>>() as u64)?;
        }
        self.push_tile(origin, ROOT_DIM, value, active);
        Ok(())
    }

    fn node(&mut self, node: &Node<'_>) -> Result<(), Fault> {
        let all_inactive_are_background = node.block.has_only_background_inactive(self.layout);
        if all_inactive_are_background && node.active_tiles().next().is_none() {
            return Ok(());
        }
        let mut values = std::mem::take(&mut self.node_values);
        values.resize(node.level.len(), V::default());
        let background = self.background;
        node.block.unpack(
            self.layout,
            &node.active,
            background,
            |value| value,
            &mut values,
            &mut self.scratch,
        )?;

        for offset in node.active_tiles() {
            self.push_tile(node.child_origin(offset), node.level.child_dim, values[offset], true);
        }
        if !all_inactive_are_background {
            let inactive =
                || node.inactive_tiles().filter(|&offset| !values[offset].is_same(background));
            let count = inactive().count() as u64;
            self.budget.spend(count * size_of::<Tile<O>>() as u64)?;
            self.budget.reserve(&mut self.grid.tiles, count)?;
            for offset in inactive() {
                self.push_tile(
                    node.child_origin(offset),
                    node.level.child_dim,
                    values[offset],
                    false,
                );
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
