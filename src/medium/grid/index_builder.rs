//! Builds the sampling structure from voxels, in parallel. What it samples to depends on the voxels alone.
//!
//! Only bricks that touch a leaf are stored in full: a brick with a leaf, and the up to seven below it
//! whose last layer of cells reaches into the leaf. Bricks, regions and roots that only touch constant
//! cubes keep the constants on their upper sides instead, which describe them exactly.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use super::{
    brick_atlas::{BRICK_EDGE, BRICK_VOXELS, BrickAtlas},
    brick_index::{
        BRICK_SHIFT, BrickIndex, COARSE_SHIFTS, Cell, REGION_SHIFT, ROOT_SHIFT, Regions, Root,
        TABLE_SLOTS, group_number,
    },
    slot::Slot,
    voxel_source::{Key, VoxelSource, Voxels, lower_neighbours, upper_neighbours},
};

/// What a brick holds, its values left out.
enum BrickContent {
    /// The brick and its seven upper neighbours are constant.
    Constants([f32; 8]),
    /// Values of its own, of which this is the largest.
    Values { max: f32 },
}

/// Builds index and atlas for the cells `first` to `last` (inclusive, local). `base` is the local origin in
/// voxels, a multiple of 4096.
pub(super) fn build(
    source: &VoxelSource,
    base: Cell,
    first: Cell,
    last: Cell,
) -> (BrickIndex, BrickAtlas) {
    let local = LocalKeys { base, first, last };
    let keys = brick_keys(source, &local);
    let contents: Vec<BrickContent> =
        keys.par_iter().map(|&key| BrickContent::of(source, key)).collect();
    let atlas = build_atlas(source, &keys, &contents);

    let mut builder = IndexBuilder { source, local, graded: Graded::default() };
    let (tables, table_regions) = builder.tables(&keys, &contents);
    let regions = builder.regions(&table_regions);
    let inhabited_groups = tables.chunks_exact(TABLE_SLOTS).map(inhabited_groups).collect();
    let index = BrickIndex { regions, tables, inhabited_groups, graded: builder.graded.blocks };
    (index, atlas)
}

/// Translates keys to local coordinates.
struct LocalKeys {
    base: Cell,
    first: Cell,
    last: Cell,
}

impl LocalKeys {
    fn local(&self, key: Key, shift: u32) -> Cell {
        std::array::from_fn(|axis| i64::from(key[axis]) - (self.base[axis] >> shift))
    }

    fn global(&self, local: Cell, shift: u32) -> Key {
        std::array::from_fn(|axis| (local[axis] + (self.base[axis] >> shift)) as i32)
    }

    /// Whether the cube has a cell in the grid's bounds.
    fn contains(&self, key: Key, shift: u32) -> bool {
        let local = self.local(key, shift);
        (0..3).all(|axis| {
            (self.first[axis] >> shift..=self.last[axis] >> shift).contains(&local[axis])
        })
    }
}

/// Bricks that hold or touch a leaf or tile of their own, grouped by region.
fn brick_keys(source: &VoxelSource, local: &LocalKeys) -> Vec<Key> {
    let mut keys: Vec<Key> = source
        .brick_keys()
        .flat_map(lower_neighbours)
        .filter(|&key| local.contains(key, BRICK_SHIFT))
        .collect();
    keys.par_sort_unstable_by_key(|&key| (region_of(key), key));
    keys.dedup();
    keys
}

fn region_of(brick: Key) -> Key {
    brick.map(|c| c >> (REGION_SHIFT - BRICK_SHIFT))
}

impl BrickContent {
    fn of(source: &VoxelSource, key: Key) -> Self {
        let neighbours = upper_neighbours(key).map(|neighbour| source.brick(neighbour));
        let constants = neighbours.map(|voxels| match voxels {
            Voxels::Constant(value) => Some(value),
            Voxels::Leaf(_) => None,
        });
        if constants.iter().all(Option::is_some) {
            return Self::Constants(constants.map(Option::unwrap_or_default));
        }
        let mut values = [0.0; BRICK_VOXELS];
        gather(&neighbours, &mut values);
        let (min, max) = values
            .iter()
            .fold((f32::INFINITY, 0.0_f32), |(min, max), &value| (min.min(value), max.max(value)));
        if min == max { Self::Constants([max; 8]) } else { Self::Values { max } }
    }
}

/// Copies a brick's 9^3 voxels from it and its seven upper neighbours.
fn gather(neighbours: &[Voxels; 8], values: &mut [f32]) {
    let rows = values.chunks_exact_mut(BRICK_EDGE + 1);
    for (number, row) in rows.enumerate() {
        let (x, y) = (number / (BRICK_EDGE + 1), number % (BRICK_EDGE + 1));
        let neighbour = (x / BRICK_EDGE) << 2 | (y / BRICK_EDGE) << 1;
        let (x, y) = (x % BRICK_EDGE, y % BRICK_EDGE);
        for (z, value) in row[..BRICK_EDGE].iter_mut().enumerate() {
            *value = neighbours[neighbour].value([x, y, z]);
        }
        row[BRICK_EDGE] = neighbours[neighbour | 1].value([x, y, 0]);
    }
}

fn build_atlas(source: &VoxelSource, keys: &[Key], contents: &[BrickContent]) -> BrickAtlas {
    let (stored, maxima): (Vec<Key>, Vec<f32>) = keys
        .iter()
        .zip(contents)
        .filter_map(|(&key, content)| match *content {
            BrickContent::Values { max } => Some((key, max)),
            BrickContent::Constants(_) => None,
        })
        .unzip();
    let mut values = vec![0.0; stored.len() * BRICK_VOXELS];
    values.par_chunks_exact_mut(BRICK_VOXELS).zip(&stored).for_each(|(values, &key)| {
        gather(&upper_neighbours(key).map(|neighbour| source.brick(neighbour)), values);
    });
    BrickAtlas::new(values, maxima)
}

/// Which groups of 4^3 bricks in a table are not all empty.
fn inhabited_groups(table: &[Slot]) -> u64 {
    table
        .iter()
        .enumerate()
        .filter(|(_, slot)| **slot != Slot::EMPTY)
        .fold(0, |groups, (brick, _)| groups | 1 << group_number(brick))
}

/// The graded blocks, each kept once.
#[derive(Default)]
struct Graded {
    blocks: Vec<[f32; 8]>,
    numbers: HashMap<[u32; 8], usize>,
}

impl Graded {
    /// The slot of a constant block with these values on its upper sides.
    fn slot(&mut self, values: [f32; 8]) -> Slot {
        if values.iter().all(|&value| value == values[0]) {
            return Slot::uniform(values[0]);
        }
        let number = *self.numbers.entry(values.map(f32::to_bits)).or_insert_with(|| {
            self.blocks.push(values);
            self.blocks.len() - 1
        });
        Slot::graded(number)
    }
}

struct IndexBuilder<'a> {
    source: &'a VoxelSource<'a>,
    local: LocalKeys,
    graded: Graded,
}

impl IndexBuilder<'_> {
    /// The tables of regions that hold bricks of their own, and those regions' keys.
    fn tables(&mut self, keys: &[Key], contents: &[BrickContent]) -> (Vec<Slot>, Vec<Key>) {
        let mut tables = Vec::new();
        let mut regions: Vec<Key> = Vec::new();
        let mut stored_count = 0;
        for (&key, content) in keys.iter().zip(contents) {
            if regions.last() != Some(&region_of(key)) {
                regions.push(region_of(key));
                self.push_constant_table(region_of(key), &mut tables);
            }
            let slot = match *content {
                BrickContent::Constants(values) => self.graded.slot(values),
                BrickContent::Values { .. } => {
                    stored_count += 1;
                    Slot::child(stored_count - 1)
                }
            };
            let [x, y, z] = key.map(|c| c as usize & 15);
            let table = tables.len() - TABLE_SLOTS;
            tables[table + (x << 8 | y << 4 | z)] = slot;
        }
        (tables, regions)
    }

    /// A table of bricks that hold the region's constant and touch its neighbours'.
    fn push_constant_table(&mut self, region: Key, tables: &mut Vec<Slot>) {
        let constants = self.region_constants(region);
        // Bricks differ only by which of the region's upper faces they touch.
        let by_faces: [Slot; 8] = std::array::from_fn(|faces| {
            self.graded.slot(std::array::from_fn(|corner| constants[corner & faces]))
        });
        tables.extend((0..TABLE_SLOTS).map(|brick| {
            let [x, y, z] = [brick >> 8, brick >> 4 & 15, brick & 15].map(|c| usize::from(c == 15));
            by_faces[x << 2 | y << 1 | z]
        }));
    }

    fn region_constants(&self, region: Key) -> [f32; 8] {
        upper_neighbours(region).map(|neighbour| self.source.region(neighbour))
    }

    /// The slots of all regions; `table_regions` have the tables of their own, in order.
    fn regions(&mut self, table_regions: &[Key]) -> Regions {
        let first = self.local.first.map(|c| c >> REGION_SHIFT);
        let last = self.local.last.map(|c| c >> REGION_SHIFT);
        let extent: [i64; 3] = std::array::from_fn(|axis| last[axis] - first[axis] + 1);
        let volume: i128 = extent.iter().map(|&edge| i128::from(edge)).product();
        let own_count = table_regions.len() + self.source.region_keys().count();
        // A slot has 4 bytes where a table has 16 KiB: 64 slots a region are no burden.
        if volume <= 4096.max(64 * own_count as i128) {
            self.dense_regions(table_regions, first, extent)
        } else {
            self.sparse_regions(table_regions)
        }
    }

    fn dense_regions(&mut self, table_regions: &[Key], first: Cell, extent: Cell) -> Regions {
        let volume = extent.iter().product::<i64>();
        let mut slots = vec![Slot::uniform(self.source.background()); volume as usize];
        if self.source.has_large_tiles() {
            for (number, slot) in (0..).zip(&mut slots) {
                let place = [
                    first[0] + number / (extent[1] * extent[2]),
                    first[1] + number / extent[2] % extent[1],
                    first[2] + number % extent[2],
                ];
                let constants = self.region_constants(self.local.global(place, REGION_SHIFT));
                *slot = self.graded.slot(constants);
            }
        }
        for (table, &region) in table_regions.iter().enumerate() {
            let place = self.local.local(region, REGION_SHIFT);
            let [x, y, z]: [i64; 3] = std::array::from_fn(|axis| place[axis] - first[axis]);
            slots[((x * extent[1] + y) * extent[2] + z) as usize] = Slot::child(table);
        }
        Regions::Dense { first, extent, slots }
    }

    fn sparse_regions(&mut self, table_regions: &[Key]) -> Regions {
        let mut slots = HashMap::new();
        for region in self.source.region_keys().flat_map(lower_neighbours) {
            let slot = self.graded.slot(self.region_constants(region));
            slots.insert(self.local_key(region, REGION_SHIFT), slot);
        }
        for (table, &region) in table_regions.iter().enumerate() {
            slots.insert(self.local_key(region, REGION_SHIFT), Slot::child(table));
        }
        let divided: HashSet<Key> =
            slots.keys().map(|region| region.map(|c| c >> (ROOT_SHIFT - REGION_SHIFT))).collect();

        let mut roots = HashMap::new();
        for root in self.source.root_keys().flat_map(lower_neighbours) {
            let slot = self.root_slot(root);
            roots.insert(self.local_key(root, ROOT_SHIFT), Root { slot, is_divided: false });
        }
        for &key in &divided {
            let slot = self.root_slot(self.local.global(key.map(i64::from), ROOT_SHIFT));
            roots.insert(key, Root { slot, is_divided: true });
        }
        let inhabited = roots
            .keys()
            .flat_map(|root| {
                COARSE_SHIFTS.map(|shift| (shift, root.map(|c| c >> (shift - ROOT_SHIFT))))
            })
            .collect();
        Regions::Sparse { slots, roots, inhabited, background: self.source.background() }
    }

    fn root_slot(&mut self, root: Key) -> Slot {
        let constants = upper_neighbours(root).map(|neighbour| self.source.root(neighbour));
        self.graded.slot(constants)
    }

    fn local_key(&self, key: Key, shift: u32) -> Key {
        self.local.local(key, shift).map(|c| c as i32)
    }
}
