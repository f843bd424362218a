//! The voxels of a grid as read, found by brick, region and root: what the sampling structure is built from.
//!
//! A brick is 8^3 voxels, a region 128^3, a root 4096^3 (the levels of OpenVDB's 5-4-3 tree). Keys are
//! voxel coordinates shifted right by 3, 7 and 12.

use std::collections::HashMap;

use crate::medium::vdb::SparseGrid;

/// Integer coordinates of a brick, region or root.
pub(super) type Key = [i32; 3];

/// The voxels of one brick.
#[derive(Clone, Copy)]
pub(super) enum Voxels<'a> {
    /// 512 values; voxel (x, y, z) is number 64x + 8y + z.
    Leaf(&'a [f32]),
    /// All 512 hold this value.
    Constant(f32),
}

impl Voxels<'_> {
    /// The value of voxel (x, y, z), each in 0..8.
    #[inline]
    pub(super) fn value(self, [x, y, z]: [usize; 3]) -> f32 {
        match self {
            Voxels::Leaf(values) => sanitised(values[(x << 6) | (y << 3) | z]),
            Voxels::Constant(value) => value,
        }
    }
}

/// Voxels by place.
pub(super) struct VoxelSource<'a> {
    background: f32,
    bricks: HashMap<Key, Voxels<'a>>,
    region_tiles: HashMap<Key, f32>,
    root_tiles: HashMap<Key, f32>,
}

impl<'a> VoxelSource<'a> {
    /// Indexes a grid. Where leaves and tiles overlap, the finer one holds.
    pub(super) fn new(grid: &'a SparseGrid<f32>) -> Self {
        let mut source = Self {
            background: sanitised(grid.background),
            bricks: HashMap::with_capacity(grid.leaves.len()),
            region_tiles: HashMap::new(),
            root_tiles: HashMap::new(),
        };
        for tile in &grid.tiles {
            let value = sanitised(tile.value);
            match tile.dim {
                8 => {
                    source.bricks.insert(tile.origin.map(|c| c >> 3), Voxels::Constant(value));
                }
                128 => {
                    source.region_tiles.insert(tile.origin.map(|c| c >> 7), value);
                }
                _ => {
                    source.root_tiles.insert(tile.origin.map(|c| c >> 12), value);
                }
            }
        }
        for (origin, values) in grid.leaves.iter().zip(grid.values.chunks_exact(512)) {
            source.bricks.insert(origin.map(|c| c >> 3), Voxels::Leaf(values));
        }
        source
    }

    /// The voxels of a brick.
    pub(super) fn brick(&self, key: Key) -> Voxels<'a> {
        match self.bricks.get(&key) {
            Some(&voxels) => voxels,
            None => Voxels::Constant(self.region(key.map(|c| c >> 4))),
        }
    }

    /// The value of a region where no brick says otherwise.
    pub(super) fn region(&self, key: Key) -> f32 {
        match self.region_tiles.get(&key) {
            Some(&value) => value,
            None => self.root(key.map(|c| c >> 5)),
        }
    }

    /// The value of a root where no region or brick says otherwise.
    pub(super) fn root(&self, key: Key) -> f32 {
        self.root_tiles.get(&key).copied().unwrap_or(self.background)
    }

    /// The value of what holds no leaf or tile.
    pub(super) fn background(&self) -> f32 {
        self.background
    }

    /// Keys of the bricks with leaves or tiles of their own, in no particular order.
    pub(super) fn brick_keys(&self) -> impl Iterator<Item = Key> {
        self.bricks.keys().copied()
    }

    /// Keys of the regions that are tiles, in no particular order.
    pub(super) fn region_keys(&self) -> impl Iterator<Item = Key> {
        self.region_tiles.keys().copied()
    }

    /// Keys of the roots that are tiles, in no particular order.
    pub(super) fn root_keys(&self) -> impl Iterator<Item = Key> {
        self.root_tiles.keys().copied()
    }

    /// The largest value of tiles and background.
    pub(super) fn max_constant(&self) -> f32 {
        let bricks = self.bricks.values().filter_map(|voxels| match voxels {
            Voxels::Constant(value) => Some(value),
            Voxels::Leaf(_) => None,
        });
        bricks
            .chain(self.region_tiles.values())
            .chain(self.root_tiles.values())
            .fold(self.background, |max, &value| max.max(value))
    }

    /// Whether any tile is larger than a brick.
    pub(super) fn has_large_tiles(&self) -> bool {
        !self.region_tiles.is_empty() || !self.root_tiles.is_empty()
    }
}

/// A density that can bound a free flight: an infinite or undefined majorant would never end one.
fn sanitised(value: f32) -> f32 {
    if value.is_finite() && value > 0.0 { value } else { 0.0 }
}

/// A key and its seven upper neighbours; number 4x + 2y + z is offset by (x, y, z).
pub(super) fn upper_neighbours(key: Key) -> [Key; 8] {
    std::array::from_fn(|n| {
        let offset = [n >> 2, (n >> 1) & 1, n & 1];
        std::array::from_fn(|axis| key[axis].saturating_add(offset[axis] as i32))
    })
}

/// A key and its seven lower neighbours.
pub(super) fn lower_neighbours(key: Key) -> [Key; 8] {
    std::array::from_fn(|n| {
        let offset = [n >> 2, (n >> 1) & 1, n & 1];
        std::array::from_fn(|axis| key[axis].saturating_sub(offset[axis] as i32))
    })
}
