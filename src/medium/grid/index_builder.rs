//! Builds the sampling structure from voxels, in parallel. What it samples to depends on the voxels alone, and
//! so does every byte of it.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use super::{
    brick_atlas::{BrickAtlas, BrickPrecision},
    brick_index::{
        BrickIndex, COARSE_SHIFTS, Cell, REGION_SHIFT, ROOT_SHIFT, Regions, Root, TABLE_SLOTS,
        group_number,
    },
    brick_plan::{BrickPlan, LocalKeys, PlannedRegion, constants},
    budget::{Budget, DensityGridError},
    slot::{MAX_CHILDREN, Slot},
    voxel_source::{Key, VoxelSource, lower_neighbours, upper_neighbours},
};

/// Regions whose constants are looked up at once.
const BATCH: usize = 1 << 16;

/// Builds index and atlas for the cells in the bounds.
pub(super) fn build(
    source: &VoxelSource,
    local: LocalKeys,
    precision: BrickPrecision,
    budget: &mut Budget,
) -> Result<(BrickIndex, BrickAtlas), DensityGridError> {
    let BrickPlan { regions: planned, mut tables, stored_count } =
        BrickPlan::new(source, &local, budget)?;
    if stored_count > MAX_CHILDREN || planned.len() > MAX_CHILDREN {
        budget.spend(u64::MAX)?;
    }
    let mut builder = IndexBuilder { source, local, graded: Graded::default(), budget };
    let mut stored: Vec<(u32, u16)> = builder.budget.vector(stored_count)?;
    for ((number, region), table) in (0..).zip(&planned).zip(tables.chunks_exact_mut(TABLE_SLOTS)) {
        builder.complete_table(region, table)?;
        for place in region.stored.places() {
            table[place] = Slot::child(stored.len());
            stored.push((number, place as u16));
        }
    }
    let regions = builder.regions(&planned)?;
    let mut groups = builder.budget.vector(planned.len())?;
    groups.extend(tables.chunks_exact(TABLE_SLOTS).map(inhabited_groups));
    let graded = builder.graded.blocks;
    let index = BrickIndex { regions, tables, inhabited_groups: groups, graded };

    let voxels_of = |brick: usize| {
        let (region, place) = stored[brick];
        planned[region as usize].neighbourhood.voxels(place.into())
    };
    let max_value = || source.max_leaf_value().max(source.max_constant());
    let atlas = BrickAtlas::new(stored_count, voxels_of, precision, max_value, budget)?;
    Ok((index, atlas))
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
    fn slot(&mut self, values: [f32; 8], budget: &mut Budget) -> Result<Slot, DensityGridError> {
        // A block and its number, in vectors and tables that may have room for as many again.
        const BLOCK_BYTES: usize = 2 * size_of::<[f32; 8]>() + 3 * size_of::<([u32; 8], usize)>();
        if values.iter().all(|&value| value == values[0]) {
            return Ok(Slot::uniform(values[0]));
        }
        let number = *self.numbers.entry(values.map(f32::to_bits)).or_insert(self.blocks.len());
        if number == self.blocks.len() {
            let is_too_many = number > MAX_CHILDREN;
            budget.spend(if is_too_many { u64::MAX } else { BLOCK_BYTES as u64 })?;
            self.blocks.push(values);
        }
        Ok(Slot::graded(number))
    }
}

struct IndexBuilder<'a> {
    source: &'a VoxelSource<'a>,
    local: LocalKeys,
    graded: Graded,
    budget: &'a mut Budget,
}

impl IndexBuilder<'_> {
    fn slot(&mut self, values: [f32; 8]) -> Result<Slot, DensityGridError> {
        self.graded.slot(values, self.budget)
    }

    /// Enters the graded bricks in a region's table.
    fn complete_table(
        &mut self,
        region: &PlannedRegion,
        table: &mut [Slot],
    ) -> Result<(), DensityGridError> {
        let by_neighbour = region.neighbourhood.constants;
        if by_neighbour.iter().any(|&value| value != by_neighbour[0]) {
            // Untouched bricks differ only by which of the region's upper faces they touch.
            let mut by_faces = [Slot::EMPTY; 8];
            for (faces, slot) in by_faces.iter_mut().enumerate() {
                *slot = self.slot(std::array::from_fn(|corner| by_neighbour[corner & faces]))?;
            }
            for place in region.untouched() {
                let [x, y, z] =
                    [place >> 8, place >> 4 & 15, place & 15].map(|c| usize::from(c == 15));
                table[place] = by_faces[x << 2 | y << 1 | z];
            }
        }
        for place in region.graded.places() {
            let values = constants(&region.neighbourhood.voxels(place));
            table[place] = self.slot(values.unwrap_or_default())?;
        }
        Ok(())
    }

    fn region_constants(&self, region: Key) -> [f32; 8] {
        upper_neighbours(region).map(|neighbour| self.source.region(neighbour))
    }

    /// The slots of all regions; those planned have tables of their own, in order.
    fn regions(&mut self, planned: &[PlannedRegion]) -> Result<Regions, DensityGridError> {
        let first = self.local.first.map(|c| c >> REGION_SHIFT);
        let last = self.local.last.map(|c| c >> REGION_SHIFT);
        let extent: [i64; 3] = std::array::from_fn(|axis| last[axis] - first[axis] + 1);
        let volume: i128 = extent.iter().map(|&edge| i128::from(edge)).product();
        // A slot has 4 bytes where a table has 16 KiB: 64 slots a region with one are no burden. A tile has hardly more
        // than a slot.
        let burden = 64 * planned.len() + 8 * self.source.region_tiles().len();
        if volume <= 4096.max(burden as i128) {
            self.dense_regions(planned, first, extent)
        } else {
            self.sparse_regions(planned)
        }
    }

    fn dense_regions(
        &mut self,
        planned: &[PlannedRegion],
        first: Cell,
        extent: Cell,
    ) -> Result<Regions, DensityGridError> {
        let volume = extent.iter().product::<i64>() as usize;
        let mut slots = self.budget.vector(volume)?;
        slots.resize(volume, Slot::uniform(self.source.background()));
        if !self.source.region_tiles().is_empty() || !self.source.root_tiles().is_empty() {
            let place = |number: i64| {
                let [x, y] = [number / (extent[1] * extent[2]), number / extent[2] % extent[1]];
                [first[0] + x, first[1] + y, first[2] + number % extent[2]]
            };
            // A batch at a time: the constants of all regions would take eight times the memory of their slots.
            for (batch, slots) in slots.chunks_mut(BATCH).enumerate() {
                let begin = (batch * BATCH) as i64;
                let constants: Vec<[f32; 8]> = (begin..begin + slots.len() as i64)
                    .into_par_iter()
                    .map(|number| self.local.global(place(number), REGION_SHIFT))
                    .map(|region| self.region_constants(region))
                    .collect();
                for (slot, constants) in slots.iter_mut().zip(constants) {
                    *slot = self.slot(constants)?;
                }
            }
        }
        for (table, region) in planned.iter().enumerate() {
            let place = self.local.local(region.key, REGION_SHIFT);
            let [x, y, z]: [i64; 3] = std::array::from_fn(|axis| place[axis] - first[axis]);
            slots[((x * extent[1] + y) * extent[2] + z) as usize] = Slot::child(table);
        }
        Ok(Regions::Dense { first, extent, slots })
    }

    fn sparse_regions(&mut self, planned: &[PlannedRegion]) -> Result<Regions, DensityGridError> {
        let slot_count = planned.len() + 8 * self.source.region_tiles().len();
        let root_count = slot_count + 8 * self.source.root_tiles().len();
        self.budget.spend_table::<(Key, Slot)>(slot_count)?;
        self.budget.spend_table::<Key>(slot_count)?;
        self.budget.spend_table::<(Key, Root)>(root_count)?;
        self.budget.spend_table::<(u32, Key)>(COARSE_SHIFTS.len() * root_count)?;

        let mut slots = HashMap::new();
        for region in self.source.region_tiles().iter().flat_map(|(key, _)| lower_neighbours(*key))
        {
            let slot = self.slot(self.region_constants(region))?;
            slots.insert(self.local_key(region, REGION_SHIFT), slot);
        }
        for (table, region) in planned.iter().enumerate() {
            slots.insert(self.local_key(region.key, REGION_SHIFT), Slot::child(table));
        }
        let divided: HashSet<Key> =
            slots.keys().map(|region| region.map(|c| c >> (ROOT_SHIFT - REGION_SHIFT))).collect();

        let mut roots = HashMap::new();
        for root in self.source.root_tiles().iter().flat_map(|(key, _)| lower_neighbours(*key)) {
            let slot = self.root_slot(root)?;
            roots.insert(self.local_key(root, ROOT_SHIFT), Root { slot, is_divided: false });
        }
        for &key in &divided {
            let slot = self.root_slot(self.local.global(key.map(i64::from), ROOT_SHIFT))?;
            roots.insert(key, Root { slot, is_divided: true });
        }
        let inhabited = roots
            .keys()
            .flat_map(|root| {
                COARSE_SHIFTS.map(|shift| (shift, root.map(|c| c >> (shift - ROOT_SHIFT))))
            })
            .collect();
        Ok(Regions::Sparse { slots, roots, inhabited, background: self.source.background() })
    }

    fn root_slot(&mut self, root: Key) -> Result<Slot, DensityGridError> {
        self.slot(upper_neighbours(root).map(|neighbour| self.source.root(neighbour)))
    }

    fn local_key(&self, key: Key, shift: u32) -> Key {
        self.local.local(key, shift).map(|c| c as i32)
    }
}
