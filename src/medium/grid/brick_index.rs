//! Where the bricks are: regions of 128^3 cells, each uniform, graded, or a table of 16^3 bricks.
//!
//! Coordinates are local: relative to the lower corner of a 4096^3 root below the grid's bounds, so they
//! are never negative. Regions stand in a dense table where their bounding box is small; otherwise, for
//! grids whose parts lie far apart, in a hash map, below roots of 4096^3 and coarser cubes known to be
//! empty. Nothing is sized by a bounding box alone.

use std::collections::{HashMap, HashSet};

use super::{
    slot::{Node, Slot},
    trilinear::Corners,
    voxel_source::Key,
};

/// log2 of the cells along a brick, a region and a root.
pub(super) const BRICK_SHIFT: u32 = 3;
pub(super) const REGION_SHIFT: u32 = 7;
pub(super) const ROOT_SHIFT: u32 = 12;
/// log2 of the cells along the cubes above roots, coarsest first, whose emptiness is recorded.
pub(super) const COARSE_SHIFTS: [u32; 2] = [28, 20];
/// log2 of the cells along a group of bricks, whose emptiness is recorded.
const GROUP_SHIFT: u32 = 5;
/// Bricks in a region's table.
pub(super) const TABLE_SLOTS: usize = 1 << (3 * (REGION_SHIFT - BRICK_SHIFT));

/// Local integer coordinates of a cell, the cube from there to there + 1.
pub(super) type Cell = [i64; 3];

/// What the index finds at a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Content {
    /// The same density at every point of the block.
    Uniform(f64),
    /// One cell, possibly stretched along axes on which its corners are equal.
    Corners(Corners),
    /// The brick of this number.
    Brick(usize),
}

/// A box of cells that one content describes: `lower` to `upper`, half-open.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub(super) lower: Cell,
    pub(super) upper: Cell,
    pub(super) content: Content,
}

/// The index of bricks.
#[derive(Debug)]
pub(super) struct BrickIndex {
    pub(super) regions: Regions,
    /// `TABLE_SLOTS` a table; brick (x, y, z) of a region is number 256x + 16y + z.
    pub(super) tables: Vec<Slot>,
    /// One word a table; group (x, y, z) of 4^3 bricks is bit 16x + 4y + z, set if not all are empty.
    pub(super) inhabited_groups: Vec<u64>,
    /// Values of a graded block and of its seven upper neighbours, in the order of [`Corners`].
    pub(super) graded: Vec<[f32; 8]>,
}

/// The slots of regions.
#[derive(Debug)]
pub(super) enum Regions {
    /// All regions from `first` on; region (x, y, z) is number (x extent_y + y) extent_z + z.
    Dense { first: [i64; 3], extent: [i64; 3], slots: Vec<Slot> },
    /// Regions that differ from their root, and roots that differ from the background.
    Sparse {
        slots: HashMap<Key, Slot>,
        roots: HashMap<Key, Root>,
        inhabited: HashSet<(u32, Key)>,
        background: f32,
    },
}

/// A cube of 4096^3 cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    /// What fills it where no region says otherwise.
    pub(super) slot: Slot,
    /// Whether any of its regions has a slot of its own.
    pub(super) is_divided: bool,
}

/// A node, the cube (by log2 of its edge) it describes, and the cube around the cell within it that
/// nothing else describes.
struct Found {
    node: Node,
    node_shift: u32,
    free_shift: u32,
}

impl BrickIndex {
    /// What holds the density in a cell within the grid's bounds.
    #[inline(always)]
    pub(super) fn content_at(&self, cell: Cell) -> Content {
        let found = self.find(cell);
        match found.node {
            Node::Uniform(density) => Content::Uniform(density.into()),
            Node::Child(brick) => Content::Brick(brick),
            Node::Graded(number) => {
                self.graded_content(number, last_layers(cell, found.node_shift))
            }
        }
    }

    /// The largest box known around a cell within the grid's bounds that one content describes.
    #[inline]
    pub(super) fn block_at(&self, cell: Cell) -> Block {
        let found = self.find(cell);
        let mut free_shift = found.free_shift;
        let content = match found.node {
            Node::Uniform(density) => {
                if density == 0.0 && free_shift == BRICK_SHIFT && !self.is_group_inhabited(cell) {
                    free_shift = GROUP_SHIFT;
                }
                Content::Uniform(density.into())
            }
            Node::Child(brick) => Content::Brick(brick),
            Node::Graded(number) => return self.graded_block(number, cell, &found),
        };
        let lower = cell.map(|c| (c >> free_shift) << free_shift);
        Block { lower, upper: lower.map(|c| c + (1 << free_shift)), content }
    }

    #[inline(always)]
    fn find(&self, cell: Cell) -> Found {
        let region = match &self.regions {
            Regions::Dense { first, extent, slots } => {
                let [x, y, z]: [i64; 3] =
                    std::array::from_fn(|axis| (cell[axis] >> REGION_SHIFT) - first[axis]);
                slots[((x * extent[1] + y) * extent[2] + z) as usize]
            }
            Regions::Sparse { slots, roots, inhabited, background } => {
                match slots.get(&key_of(cell, REGION_SHIFT)) {
                    Some(&slot) => slot,
                    None => return find_above_regions(cell, roots, inhabited, *background),
                }
            }
        };
        match region.node() {
            Node::Child(table) => {
                let slot = self.tables[table * TABLE_SLOTS + brick_number(cell)];
                Found { node: slot.node(), node_shift: BRICK_SHIFT, free_shift: BRICK_SHIFT }
            }
            node => Found { node, node_shift: REGION_SHIFT, free_shift: REGION_SHIFT },
        }
    }

    /// Whether any brick in the group around a cell, of a region that has a table, holds density.
    fn is_group_inhabited(&self, cell: Cell) -> bool {
        let slot = match &self.regions {
            Regions::Dense { first, extent, slots } => {
                let [x, y, z]: [i64; 3] =
                    std::array::from_fn(|axis| (cell[axis] >> REGION_SHIFT) - first[axis]);
                slots[((x * extent[1] + y) * extent[2] + z) as usize]
            }
            Regions::Sparse { slots, .. } => match slots.get(&key_of(cell, REGION_SHIFT)) {
                Some(&slot) => slot,
                None => return true,
            },
        };
        match slot.node() {
            Node::Child(table) => {
                self.inhabited_groups[table] >> group_number(brick_number(cell)) & 1 != 0
            }
            _ => true,
        }
    }

    /// The corners of the part of a graded block that is in the last layer of cells on the given axes.
    /// Across that layer the block's value goes over to its neighbours'; along the other axes it is
    /// constant.
    fn graded_content(&self, number: usize, is_last: [bool; 3]) -> Content {
        let values = &self.graded[number];
        let mask = (is_last[0] as usize) << 2 | (is_last[1] as usize) << 1 | is_last[2] as usize;
        let corners: Corners = std::array::from_fn(|corner| values[corner & mask].into());
        if corners.iter().all(|&corner| corner == corners[0]) {
            Content::Uniform(corners[0])
        } else {
            Content::Corners(corners)
        }
    }

    fn graded_block(&self, number: usize, cell: Cell, found: &Found) -> Block {
        let is_last = last_layers(cell, found.node_shift);
        let free = 1 << found.free_shift;
        let mut lower = cell.map(|c| (c >> found.free_shift) << found.free_shift);
        let mut upper = lower.map(|c| c + free);
        for axis in 0..3 {
            let last = cell[axis] | ((1 << found.node_shift) - 1);
            if is_last[axis] {
                lower[axis] = last;
            } else {
                upper[axis] = upper[axis].min(last);
            }
        }
        Block { lower, upper, content: self.graded_content(number, is_last) }
    }

    /// Memory held by the index \[bytes\], hash maps by estimate.
    pub(super) fn bytes(&self) -> usize {
        let regions = match &self.regions {
            Regions::Dense { slots, .. } => slots.capacity() * size_of::<Slot>(),
            Regions::Sparse { slots, roots, inhabited, .. } => {
                slots.capacity() * (size_of::<(Key, Slot)>() + 1)
                    + roots.capacity() * (size_of::<(Key, Root)>() + 1)
                    + inhabited.capacity() * (size_of::<(u32, Key)>() + 1)
            }
        };
        regions
            + self.tables.capacity() * size_of::<Slot>()
            + self.inhabited_groups.capacity() * size_of::<u64>()
            + self.graded.capacity() * size_of::<[f32; 8]>()
    }
}

fn find_above_regions(
    cell: Cell,
    roots: &HashMap<Key, Root>,
    inhabited: &HashSet<(u32, Key)>,
    background: f32,
) -> Found {
    if let Some(root) = roots.get(&key_of(cell, ROOT_SHIFT)) {
        let free_shift = if root.is_divided { REGION_SHIFT } else { ROOT_SHIFT };
        return Found { node: root.slot.node(), node_shift: ROOT_SHIFT, free_shift };
    }
    let empty = COARSE_SHIFTS
        .into_iter()
        .find(|&shift| !inhabited.contains(&(shift, key_of(cell, shift))))
        .unwrap_or(ROOT_SHIFT);
    Found { node: Node::Uniform(background), node_shift: empty, free_shift: empty }
}

/// Whether a cell is in the last layer of its node, a cube of edge 2^`shift`.
fn last_layers(cell: Cell, shift: u32) -> [bool; 3] {
    let mask = (1 << shift) - 1;
    cell.map(|c| c & mask == mask)
}

/// The cube of edge 2^`shift` around a cell. Local coordinates stay below 2^33, a region's below 2^26.
fn key_of(cell: Cell, shift: u32) -> Key {
    cell.map(|c| (c >> shift) as i32)
}

/// The number in its region's table of the brick around a cell.
#[inline(always)]
fn brick_number(cell: Cell) -> usize {
    let [x, y, z] = cell.map(|c| (c >> BRICK_SHIFT) as usize & 15);
    x << 8 | y << 4 | z
}

/// The bit of a brick's group, from the brick's number in its table.
pub(super) fn group_number(brick: usize) -> usize {
    let [x, y, z] = [brick >> 8, brick >> 4 & 15, brick & 15].map(|c| c >> 2);
    x << 4 | y << 2 | z
}
