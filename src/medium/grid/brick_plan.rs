//! Which bricks there are, what kind each is, and in which order those with values are stored.
//!
//! Only bricks that touch a leaf are stored in full: a brick with a leaf, and the up to seven below it
//! whose last layer of cells reaches into the leaf. Bricks, regions and roots that only touch constant
//! cubes keep the constants on their upper sides instead, which describe them exactly.

use std::collections::HashMap;

use rayon::prelude::*;

use super::{
    brick_atlas::is_uniform,
    brick_index::{BRICK_SHIFT, Cell, REGION_SHIFT, TABLE_SLOTS},
    budget::{Budget, DensityGridError},
    place_mask::PlaceMask,
    slot::Slot,
    voxel_source::{Key, Neighbourhood, VoxelSource, Voxels},
};

/// Translates keys to local coordinates.
#[derive(Clone, Copy)]
pub(super) struct LocalKeys {
    /// The local origin in voxels, a multiple of 4096.
    pub(super) base: Cell,
    /// First and last cell in the grid's bounds, local.
    pub(super) first: Cell,
    pub(super) last: Cell,
}

impl LocalKeys {
    pub(super) fn local(&self, key: Key, shift: u32) -> Cell {
        std::array::from_fn(|axis| i64::from(key[axis]) - (self.base[axis] >> shift))
    }

    pub(super) fn global(&self, local: Cell, shift: u32) -> Key {
        std::array::from_fn(|axis| (local[axis] + (self.base[axis] >> shift)) as i32)
    }

    /// Removes the places of a region's bricks that have no cell in the grid's bounds.
    fn clip(&self, region: Key, places: &mut PlaceMask) {
        let origin = self.local(region, REGION_SHIFT).map(|c| c << (REGION_SHIFT - BRICK_SHIFT));
        let bounds: [_; 3] = std::array::from_fn(|axis| {
            self.first[axis] >> BRICK_SHIFT..=self.last[axis] >> BRICK_SHIFT
        });
        let is_inside = |axis: usize| {
            bounds[axis].contains(&origin[axis]) && bounds[axis].contains(&(origin[axis] + 15))
        };
        if !(0..3).all(is_inside) {
            places.retain(|place| {
                let place = [place >> 8, place >> 4 & 15, place & 15];
                (0..3).all(|axis| bounds[axis].contains(&(origin[axis] + place[axis] as i64)))
            });
        }
    }
}

/// The regions that have a table of bricks.
pub(super) struct BrickPlan<'a> {
    /// In ascending order of their keys.
    pub(super) regions: Vec<PlannedRegion<'a>>,
    /// `TABLE_SLOTS` a region, filled in where bricks are uniform.
    pub(super) tables: Vec<Slot>,
    /// Number of bricks stored with their values.
    pub(super) stored_count: usize,
}

/// The bricks of a region.
pub(super) struct PlannedRegion<'a> {
    pub(super) key: Key,
    pub(super) neighbourhood: Neighbourhood<'a>,
    /// Bricks that hold or touch a leaf or tile of their own.
    touched: PlaceMask,
    /// Of those, bricks with values of their own.
    pub(super) stored: PlaceMask,
    /// Of those, constant bricks that blend into other constants.
    pub(super) graded: PlaceMask,
}

impl<'a> BrickPlan<'a> {
    pub(super) fn new(
        source: &'a VoxelSource<'a>,
        local: &LocalKeys,
        budget: &mut Budget,
    ) -> Result<Self, DensityGridError> {
        let touched = touched_places(source, local, budget)?;
        let slot_count = touched.len().saturating_mul(TABLE_SLOTS);
        let mut tables = budget.vector(slot_count)?;
        tables.resize(slot_count, Slot::EMPTY);
        let mut regions = budget.vector(touched.len())?;
        regions.par_extend(tables.par_chunks_exact_mut(TABLE_SLOTS).zip(touched).map(
            |(table, (key, touched))| {
                let neighbourhood = source.neighbourhood(key);
                let (stored, graded) = (PlaceMask::EMPTY, PlaceMask::EMPTY);
                let mut region = PlannedRegion { key, neighbourhood, touched, stored, graded };
                region.sort_bricks(table);
                region
            },
        ));
        let stored_count = regions.iter().map(|region| region.stored.len()).sum();
        Ok(Self { regions, tables, stored_count })
    }
}

impl PlannedRegion<'_> {
    /// Tells the kinds of bricks apart, and enters those that are uniform in the region's table.
    fn sort_bricks(&mut self, table: &mut [Slot]) {
        table.fill(Slot::uniform(self.neighbourhood.constants[0]));
        for place in self.touched.places() {
            let voxels = self.neighbourhood.voxels(place);
            match constants(&voxels) {
                Some(values) if values.iter().all(|&value| value == values[0]) => {
                    table[place] = Slot::uniform(values[0]);
                }
                Some(_) => self.graded.insert(place),
                None => match is_uniform(&voxels) {
                    Some(value) => table[place] = Slot::uniform(value),
                    None => self.stored.insert(place),
                },
            }
        }
    }

    /// The places of the bricks that touch nothing but the constants of regions.
    pub(super) fn untouched(&self) -> impl Iterator<Item = usize> {
        (0..TABLE_SLOTS).filter(|&place| !self.touched.find(place).0)
    }
}

/// The values of a brick and its seven upper neighbours, if all are constant.
pub(super) fn constants(voxels: &[Voxels; 8]) -> Option<[f32; 8]> {
    let mut values = [0.0; 8];
    for (value, voxels) in values.iter_mut().zip(voxels) {
        match voxels {
            Voxels::Constant(constant) => *value = *constant,
            Voxels::Leaf(_) => return None,
        }
    }
    Some(values)
}

/// The bricks that hold or touch a leaf or tile of their own, in ascending order of their regions.
fn touched_places(
    source: &VoxelSource,
    local: &LocalKeys,
    budget: &mut Budget,
) -> Result<Vec<(Key, PlaceMask)>, DensityGridError> {
    // What a region with a table costs while all is built, beyond the table and its `PlannedRegion`.
    const REGION_BYTES: usize = 2 * size_of::<(Key, PlaceMask)>() + 2 * size_of::<(Key, usize)>();
    budget.spend((source.regions().len() * REGION_BYTES) as u64)?;
    let mut regions: Vec<(Key, PlaceMask)> =
        source.regions().iter().map(|region| (region.key, region.present)).collect();
    let mut numbers: HashMap<Key, usize> =
        (0..).zip(&regions).map(|(n, (key, _))| (*key, n)).collect();
    // A brick touches its upper neighbours: lowered along one axis after the other, an entry reaches all
    // seven bricks below it.
    for axis in 0..3 {
        let mut leaving = Vec::new();
        for (key, places) in &mut regions {
            let (inner, outer) = places.lowered(axis);
            places.unite(&inner);
            if !outer.is_empty() {
                let mut lower = *key;
                lower[axis] -= 1;
                leaving.push((lower, outer));
            }
        }
        for (key, places) in leaving {
            let number = *numbers.entry(key).or_insert(regions.len());
            if number == regions.len() {
                budget.spend(REGION_BYTES as u64)?;
                regions.push((key, PlaceMask::EMPTY));
            }
            regions[number].1.unite(&places);
        }
    }
    regions.par_iter_mut().for_each(|(key, places)| local.clip(*key, places));
    regions.retain(|(_, places)| !places.is_empty());
    regions.sort_unstable_by_key(|(key, _)| *key);
    Ok(regions)
}
