//! The topology of a 5-4-3 tree: root, nodes of 32^3, nodes of 16^3, leaves of 8^3 voxels.
//!
//! Nodes lie in the file depth first. [`walk`] shows each to a [`TreeVisitor`]; the values of
//! leaves come after the whole topology, in the same order.

use std::collections::HashSet;

use super::block::{Block, Layout};
use super::cursor::Cursor;
use super::fault::Fault;
use super::value::ValueType;

/// Voxels of a leaf.
pub(super) const LEAF_LEN: usize = 512;
/// Edge of a child of the root, and of a tile at the root \[voxels\].
pub(super) const ROOT_DIM: i32 = 4096;
const LEAF_MASK_BYTES: usize = LEAF_LEN / 8;
const WHAT: &str = "the tree";

/// Sees the nodes of a tree go by. An error stops the walk.
pub(super) trait TreeVisitor {
    /// The value of what is not in the tree; comes first.
    fn background(&mut self, value: &[u8]) -> Result<(), Fault>;
    /// A tile of 4096^3 voxels.
    fn root_tile(&mut self, origin: [i32; 3], value: &[u8], active: bool) -> Result<(), Fault>;
    /// A node between root and leaves.
    fn node(&mut self, node: &Node<'_>) -> Result<(), Fault>;
    /// A leaf and its active voxels.
    fn leaf(&mut self, origin: [i32; 3], mask: [u64; 8]) -> Result<(), Fault>;
}

/// The two kinds of node between root and leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    /// Binary logarithm of the children along an edge.
    log2: u32,
    /// Edge of a child or a tile \[voxels\].
    pub child_dim: i32,
}

/// Children of the root.
pub(super) const UPPER: Level = Level { log2: 5, child_dim: 128 };
/// Parents of leaves.
pub(super) const LOWER: Level = Level { log2: 4, child_dim: 8 };

impl Level {
    /// Children and tiles of a node.
    pub(super) fn len(self) -> usize {
        1 << (3 * self.log2)
    }
}

/// A node between root and leaves: where a bit of `children` is not set, there is a tile.
#[derive(Clone, Debug)]
pub(super) struct Node<'a> {
    pub level: Level,
    origin: [i32; 3],
    /// Which of the places have a child node.
    pub children: Vec<u64>,
    /// Which of the tiles are active.
    pub active: Vec<u64>,
    /// Values of the tiles.
    pub block: Block<'a>,
}

impl<'a> Node<'a> {
    fn read(
        cursor: &mut Cursor<'a>,
        layout: &Layout,
        level: Level,
        origin: [i32; 3],
    ) -> Result<Self, Fault> {
        let children = words(cursor.take(level.len() / 8, WHAT)?);
        let active = words(cursor.take(level.len() / 8, WHAT)?);
        let block = Block::read(cursor, layout, level.len(), count_ones(&active))?;
        Ok(Self { level, origin, children, active, block })
    }

    /// Lowest voxel of the child or tile at an offset, x slowest.
    pub(super) fn child_origin(&self, offset: usize) -> [i32; 3] {
        let Level { log2, child_dim } = self.level;
        let edge_mask = (1 << log2) - 1;
        let along = |axis: u32| ((offset >> (log2 * (2 - axis))) & edge_mask) as i32 * child_dim;
        [self.origin[0] + along(0), self.origin[1] + along(1), self.origin[2] + along(2)]
    }

    /// Offsets of the active tiles.
    pub(super) fn active_tiles(&self) -> impl Iterator<Item = usize> {
        bits(self.active.iter().zip(&self.children).map(|(active, child)| active & !child))
    }

    /// Offsets of the inactive tiles.
    pub(super) fn inactive_tiles(&self) -> impl Iterator<Item = usize> {
        bits(self.active.iter().zip(&self.children).map(|(active, child)| !active & !child))
    }
}

/// Shows every node of the tree at the cursor to the visitor, and leaves the cursor behind the
/// topology.
pub(super) fn walk(
    cursor: &mut Cursor<'_>,
    layout: &Layout,
    visitor: &mut impl TreeVisitor,
) -> Result<(), Fault> {
    let buffer_count = cursor.i32(WHAT)?;
    if buffer_count != 1 {
        return Err(Fault::invalid(format!("{buffer_count} buffers a leaf")));
    }
    visitor.background(cursor.take(layout.value_size, "the background value")?)?;
    let tile_count = cursor.u32(WHAT)?;
    let child_count = cursor.u32(WHAT)?;

    let mut regions = HashSet::new();
    for _ in 0..tile_count {
        let origin = root_origin(cursor, &mut regions)?;
        let value = cursor.take(layout.value_size, WHAT)?;
        visitor.root_tile(origin, value, cursor.u8(WHAT)? != 0)?;
    }
    for _ in 0..child_count {
        let origin = root_origin(cursor, &mut regions)?;
        let upper = Node::read(cursor, layout, UPPER, origin)?;
        visitor.node(&upper)?;
        for offset in bits(upper.children.iter().copied()) {
            let lower = Node::read(cursor, layout, LOWER, upper.child_origin(offset))?;
            visitor.node(&lower)?;
            for offset in bits(lower.children.iter().copied()) {
                let mask = leaf_mask(cursor)?;
                visitor.leaf(lower.child_origin(offset), mask)?;
            }
        }
    }
    Ok(())
}

/// Reads the lowest voxel of a region of the root: none may come twice.
fn root_origin(
    cursor: &mut Cursor<'_>,
    regions: &mut HashSet<[i32; 3]>,
) -> Result<[i32; 3], Fault> {
    let origin = cursor.coordinates(WHAT)?;
    if origin.iter().any(|along| along % ROOT_DIM != 0) {
        return Err(Fault::invalid(format!("a node out of place at {origin:?}")));
    }
    if !regions.insert(origin) {
        return Err(Fault::invalid(format!("two nodes at {origin:?}")));
    }
    Ok(origin)
}

fn leaf_mask(cursor: &mut Cursor<'_>) -> Result<[u64; 8], Fault> {
    let bytes = cursor.take(LEAF_MASK_BYTES, WHAT)?;
    let mut mask = [0; 8];
    for (word, bytes) in mask.iter_mut().zip(bytes.chunks_exact(8)) {
        *word = bytes.first_chunk().copied().map_or(0, u64::from_le_bytes);
    }
    Ok(mask)
}

/// Reads the values of a leaf without unpacking them. They follow its mask, which comes a second
/// time.
pub(super) fn leaf_block<'a>(
    cursor: &mut Cursor<'a>,
    layout: &Layout,
    active_count: usize,
) -> Result<Block<'a>, Fault> {
    cursor.take(LEAF_MASK_BYTES, "the values of a leaf")?;
    Block::read(cursor, layout, LEAF_LEN, active_count)
}

/// Passes over the values of a leaf of any type.
pub(super) fn skip_leaf(
    cursor: &mut Cursor<'_>,
    value_type: ValueType,
    layout: &Layout,
    active_count: usize,
) -> Result<(), Fault> {
    const ORIGIN_BYTES: usize = 12;
    let len = match value_type {
        // Mask and origin; for bool the values too, a bit each.
        ValueType::Mask => LEAF_MASK_BYTES + ORIGIN_BYTES,
        ValueType::Bool => 2 * LEAF_MASK_BYTES + ORIGIN_BYTES,
        _ => return leaf_block(cursor, layout, active_count).map(drop),
    };
    cursor.take(len, "the values of a leaf").map(drop)
}

fn words(bytes: &[u8]) -> Vec<u64> {
    bytes
        .chunks_exact(8)
        .map(|word| word.first_chunk().copied().map_or(0, u64::from_le_bytes))
        .collect()
}

/// Number of bits set.
pub(super) fn count_ones(words: &[u64]) -> usize {
    words.iter().map(|word| word.count_ones() as usize).sum()
}

/// Places of the bits set.
fn bits(words: impl Iterator<Item = u64>) -> impl Iterator<Item = usize> {
    words.enumerate().flat_map(|(index, word)| {
        std::iter::successors((word != 0).then_some(word), |rest| {
            let rest = rest & (rest - 1);
            (rest != 0).then_some(rest)
        })
        .map(move |rest| 64 * index + rest.trailing_zeros() as usize)
    })
}
