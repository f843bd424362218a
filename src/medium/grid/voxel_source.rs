//! The voxels of a grid as read, found by brick, region and root: what the sampling structure is built from.
//!
//! A brick is 8^3 voxels, a region 128^3, a root 4096^3 (the levels of OpenVDB's 5-4-3 tree). Keys are
//! voxel coordinates shifted right by 3, 7 and 12. Leaves and tiles stand in sorted vectors; a leaf is found by
//! its rank among the bits of its region, without hashing.

use rayon::prelude::*;

use super::{
    budget::{Budget, DensityGridError},
    place_mask::PlaceMask,
};
use crate::medium::vdb::SparseGrid;

/// Integer coordinates of a brick, region or root.
pub(super) type Key = [i32; 3];

/// Voxels a leaf.
const LEAF_LEN: usize = 512;

/// The voxels of one brick.
#[derive(Clone, Copy)]
pub(super) enum Voxels<'a> {
    /// Voxel (x, y, z) is number 64x + 8y + z. Not sanitised.
    Leaf(&'a [f32; LEAF_LEN]),
    /// All 512 hold this value.
    Constant(f32),
}

impl Voxels<'_> {
    /// The values of voxels (x, y, 0) to (x, y, 7).
    #[inline(always)]
    pub(super) fn row(self, x: usize, y: usize) -> [f32; 8] {
        match self {
            Voxels::Leaf(values) => values.as_chunks::<8>().0[x << 3 | y].map(sanitised),
            Voxels::Constant(value) => [value; 8],
        }
    }

    /// The value of voxel (x, y, 0).
    #[inline(always)]
    pub(super) fn first_of_row(self, x: usize, y: usize) -> f32 {
        match self {
            Voxels::Leaf(values) => sanitised(values[x << 6 | y << 3]),
            Voxels::Constant(value) => value,
        }
    }
}

/// A density that can bound a free flight: an infinite or undefined majorant would never end one.
#[inline(always)]
pub(super) fn sanitised(value: f32) -> f32 {
    // The bits of finite values from 0 up are below those of infinity, all others above. Comparing floats instead
    // compiles to a dozen instructions a voxel, not to a vector of them.
    let bits = value.to_bits();
    f32::from_bits(if bits < f32::INFINITY.to_bits() { bits } else { 0 })
}

/// A leaf or a tile of 8^3 voxels.
#[derive(Clone, Copy)]
struct Entry {
    brick: Key,
    number: EntryNumber,
}

/// Number of a leaf, or of a tile with the highest bit set.
#[derive(Clone, Copy)]
struct EntryNumber(u32);

impl EntryNumber {
    const TILE: u32 = 1 << 31;
}

/// The leaves and 8^3 tiles of a region.
pub(super) struct SourceRegion {
    pub(super) key: Key,
    pub(super) present: PlaceMask,
    /// Places in the words of `present` before each.
    ranks: [u16; 64],
    /// Number of the first entry.
    first: usize,
}

/// Voxels by place.
pub(super) struct VoxelSource<'a> {
    grid: &'a SparseGrid<f32>,
    leaves: &'a [[f32; LEAF_LEN]],
    background: f32,
    /// In the order of regions, and of places within them.
    entries: Vec<Entry>,
    /// Those with entries, sorted.
    regions: Vec<SourceRegion>,
    region_tiles: Vec<(Key, f32)>,
    root_tiles: Vec<(Key, f32)>,
}

impl<'a> VoxelSource<'a> {
    /// Indexes a grid. Where leaves and tiles overlap, the finer one holds; of the same kind, the last.
    pub(super) fn new(
        grid: &'a SparseGrid<f32>,
        budget: &mut Budget,
    ) -> Result<Self, DensityGridError> {
        let (leaves, _) = grid.values.as_chunks();
        let leaf_count = grid.leaves.len().min(leaves.len());
        let is_countable = |len: usize| len < EntryNumber::TILE as usize;
        if !is_countable(leaf_count) || !is_countable(grid.tiles.len()) {
            budget.spend(u64::MAX)?;
        }
        let entries = entries(grid, leaf_count, budget)?;
        let regions = regions(&entries, budget)?;
        Ok(Self {
            grid,
            leaves,
            background: sanitised(grid.background),
            entries,
            regions,
            region_tiles: large_tiles(grid, 7, |dim| dim == 128, budget)?,
            root_tiles: large_tiles(grid, 12, |dim| dim != 8 && dim != 128, budget)?,
        })
    }

    /// The voxels of a brick of a region, where it has some of its own.
    #[inline]
    fn brick(&self, region: &SourceRegion, place: usize) -> Option<Voxels<'a>> {
        let (is_present, before) = region.present.find(place);
        if !is_present {
            return None;
        }
        let entry = region.first + usize::from(region.ranks[place >> 6]) + before;
        let number = self.entries[entry].number.0;
        Some(if number & EntryNumber::TILE == 0 {
            Voxels::Leaf(&self.leaves[number as usize])
        } else {
            let tile = (number & !EntryNumber::TILE) as usize;
            Voxels::Constant(sanitised(self.grid.tiles[tile].value))
        })
    }

    /// A region and its seven upper neighbours.
    pub(super) fn neighbourhood(&self, region: Key) -> Neighbourhood<'_> {
        let keys = upper_neighbours(region);
        let find = |key: &Key| self.regions.binary_search_by_key(key, |region| region.key).ok();
        Neighbourhood {
            source: self,
            regions: std::array::from_fn(|n| find(&keys[n]).map(|found| &self.regions[found])),
            constants: keys.map(|key| self.region(key)),
        }
    }

    /// The value of a region where no brick says otherwise.
    pub(super) fn region(&self, key: Key) -> f32 {
        find_tile(&self.region_tiles, key).unwrap_or_else(|| self.root(key.map(|c| c >> 5)))
    }

    /// The value of a root where no region or brick says otherwise.
    pub(super) fn root(&self, key: Key) -> f32 {
        find_tile(&self.root_tiles, key).unwrap_or(self.background)
    }

    /// The value of what holds no leaf or tile.
    pub(super) fn background(&self) -> f32 {
        self.background
    }

    /// The regions with leaves or tiles of 8^3 voxels, sorted.
    pub(super) fn regions(&self) -> &[SourceRegion] {
        &self.regions
    }

    /// The regions that are tiles, sorted, and their values.
    pub(super) fn region_tiles(&self) -> &[(Key, f32)] {
        &self.region_tiles
    }

    /// The roots that are tiles, sorted, and their values.
    pub(super) fn root_tiles(&self) -> &[(Key, f32)] {
        &self.root_tiles
    }

    /// The largest value of tiles and background.
    pub(super) fn max_constant(&self) -> f32 {
        let tiles = self.grid.tiles.iter().map(|tile| sanitised(tile.value));
        tiles.fold(self.background, f32::max)
    }

    /// The largest value of any voxel of a leaf.
    pub(super) fn max_leaf_value(&self) -> f32 {
        let max = |leaf: &[f32; LEAF_LEN]| {
            let mut lanes = [0.0; 8];
            for row in leaf.as_chunks::<8>().0 {
                raise(&mut lanes, &row.map(sanitised));
            }
            lanes.into_iter().fold(0.0, f32::max)
        };
        self.leaves.par_iter().with_min_len(256).map(max).reduce(|| 0.0, f32::max)
    }
}

/// Lane by lane, the larger value.
#[inline(always)]
pub(super) fn raise(lanes: &mut [f32; 8], values: &[f32; 8]) {
    for (lane, value) in lanes.iter_mut().zip(values) {
        *lane = if *value > *lane { *value } else { *lane };
    }
}

/// The leaves and 8^3 tiles in the order of regions and places, each brick once.
fn entries(
    grid: &SparseGrid<f32>,
    leaf_count: usize,
    budget: &mut Budget,
) -> Result<Vec<Entry>, DensityGridError> {
    let is_brick = |(_, tile): &(u32, &crate::medium::vdb::Tile<f32>)| tile.dim == 8;
    let tile_count = grid.tiles.iter().filter(|tile| tile.dim == 8).count();
    let mut entries = budget.vector(leaf_count + tile_count)?;
    // Sorting takes as much again.
    budget.spend((entries.capacity() * size_of::<Entry>()) as u64)?;
    let entry =
        |origin: Key, number| Entry { brick: origin.map(|c| c >> 3), number: EntryNumber(number) };
    let tiles = (0..).zip(&grid.tiles).filter(is_brick);
    entries.extend(tiles.map(|(number, tile)| entry(tile.origin, number | EntryNumber::TILE)));
    let leaves = (0..).zip(&grid.leaves[..leaf_count]);
    entries.extend(leaves.map(|(number, &origin)| entry(origin, number)));
    entries.par_sort_by_key(|entry| (region_of(entry.brick), place_of(entry.brick)));
    // Of the same brick the last holds; what is removed is the second of two.
    entries.dedup_by(|next, kept| {
        let is_same = next.brick == kept.brick;
        if is_same {
            *kept = *next;
        }
        is_same
    });
    Ok(entries)
}

fn regions(entries: &[Entry], budget: &mut Budget) -> Result<Vec<SourceRegion>, DensityGridError> {
    let of_one_region =
        || entries.chunk_by(|entry, next| region_of(entry.brick) == region_of(next.brick));
    let mut regions = budget.vector(of_one_region().count())?;
    let mut first = 0;
    for entries in of_one_region() {
        let mut present = PlaceMask::EMPTY;
        entries.iter().for_each(|entry| present.insert(place_of(entry.brick)));
        let key = region_of(entries[0].brick);
        regions.push(SourceRegion { key, present, ranks: present.ranks(), first });
        first += entries.len();
    }
    Ok(regions)
}

/// The tiles of some sizes, sorted by their keys, each key once.
fn large_tiles(
    grid: &SparseGrid<f32>,
    shift: u32,
    is_of_size: impl Fn(u32) -> bool,
    budget: &mut Budget,
) -> Result<Vec<(Key, f32)>, DensityGridError> {
    let of_size = || grid.tiles.iter().filter(|tile| is_of_size(tile.dim));
    let mut tiles: Vec<(Key, f32)> = budget.vector(of_size().count())?;
    tiles.extend(of_size().map(|tile| (tile.origin.map(|c| c >> shift), sanitised(tile.value))));
    tiles.sort_by_key(|(key, _)| *key);
    tiles.dedup_by(|next, kept| {
        let is_same = next.0 == kept.0;
        if is_same {
            *kept = *next;
        }
        is_same
    });
    Ok(tiles)
}

fn find_tile(tiles: &[(Key, f32)], key: Key) -> Option<f32> {
    tiles.binary_search_by_key(&key, |(key, _)| *key).ok().map(|found| tiles[found].1)
}

/// The region a brick is in.
fn region_of(brick: Key) -> Key {
    brick.map(|c| c >> 4)
}

/// The place of a brick in its region.
fn place_of(brick: Key) -> usize {
    let [x, y, z] = brick.map(|c| c as usize & 15);
    x << 8 | y << 4 | z
}

/// A region and its seven upper neighbours.
pub(super) struct Neighbourhood<'a> {
    source: &'a VoxelSource<'a>,
    regions: [Option<&'a SourceRegion>; 8],
    /// The value of each where no brick says otherwise.
    pub(super) constants: [f32; 8],
}

impl<'a> Neighbourhood<'a> {
    /// The voxels of a brick of the region and of its seven upper neighbours.
    #[inline]
    pub(super) fn voxels(&self, place: usize) -> [Voxels<'a>; 8] {
        let place = [place >> 8, place >> 4 & 15, place & 15];
        std::array::from_fn(|n| {
            let [x, y, z] = [place[0] + (n >> 2), place[1] + (n >> 1 & 1), place[2] + (n & 1)];
            let region = x >> 4 << 2 | y >> 4 << 1 | z >> 4;
            let place = (x & 15) << 8 | (y & 15) << 4 | z & 15;
            self.regions[region]
                .and_then(|region| self.source.brick(region, place))
                .unwrap_or(Voxels::Constant(self.constants[region]))
        })
    }
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
