//! The plain form of a grid as read from a file: leaves, tiles and a background.

use crate::math::DAffine3;

/// A sparse grid of values at integer index coordinates, background elsewhere.
#[derive(Clone, Debug)]
pub struct SparseGrid<T> {
    /// Value of everything not covered by a leaf or a tile.
    pub background: T,
    /// Index to world: column-vector convention, `world = index_to_world * index`.
    pub index_to_world: DAffine3,
    /// Origins of the 8^3 leaves, multiples of 8.
    pub leaves: Vec<[i32; 3]>,
    /// Active voxels of each leaf; voxel offset (x << 6) | (y << 3) | z is bit `offset & 63` of
    /// word `offset >> 6`.
    pub masks: Vec<[u64; 8]>,
    /// All 512 values of each leaf, inactive ones included, in voxel-offset order.
    pub values: Vec<T>,
    /// Constant cubes above the leaves, active or inactive with a value other than the background.
    pub tiles: Vec<Tile<T>>,
}

impl<T> SparseGrid<T> {
    /// Memory held \[bytes\].
    pub fn memory_bytes(&self) -> u64 {
        let leaves = self.leaves.capacity() * size_of::<[i32; 3]>()
            + self.masks.capacity() * size_of::<[u64; 8]>()
            + self.values.capacity() * size_of::<T>();
        (leaves + self.tiles.capacity() * size_of::<Tile<T>>()) as u64
    }
}

impl<T: Copy> SparseGrid<T> {
    /// The grid with every value converted.
    pub fn map<U>(&self, convert: impl Fn(T) -> U) -> SparseGrid<U> {
        let tile = |tile: &Tile<T>| Tile {
            origin: tile.origin,
            dim: tile.dim,
            value: convert(tile.value),
            active: tile.active,
        };
        SparseGrid {
            background: convert(self.background),
            index_to_world: self.index_to_world,
            leaves: self.leaves.clone(),
            masks: self.masks.clone(),
            values: self.values.iter().map(|&value| convert(value)).collect(),
            tiles: self.tiles.iter().map(tile).collect(),
        }
    }
}

/// A constant cube of voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile<T> {
    /// Lowest voxel, a multiple of `dim`.
    pub origin: [i32; 3],
    /// Edge in voxels: 8, 128 or 4096.
    pub dim: u32,
    /// Value of all its voxels.
    pub value: T,
    /// Whether the tile is active.
    pub active: bool,
}
