//! Grids for tests: written voxel by voxel, and looked up the slow way.
#![allow(dead_code)]

use std::collections::BTreeMap;

use photonvdb::{
    math::{DAffine3, DVec3},
    medium::{
        GridExtinction,
        grid::DensityGrid,
        vdb::{SparseGrid, Tile},
    },
};

/// Leaves and tiles to come.
#[derive(Clone, Debug, Default)]
pub struct Voxels {
    pub background: f32,
    pub leaves: BTreeMap<[i32; 3], ([u64; 8], Vec<f32>)>,
    pub tiles: Vec<Tile<f32>>,
}

impl Voxels {
    /// Values of a field on the integer points of a box, both corners included.
    pub fn of_field(min: [i32; 3], max: [i32; 3], field: impl Fn([i32; 3]) -> f64) -> Self {
        let mut voxels = Self::default();
        for x in min[0]..=max[0] {
            for y in min[1]..=max[1] {
                for z in min[2]..=max[2] {
                    voxels.set([x, y, z], field([x, y, z]) as f32);
                }
            }
        }
        voxels
    }

    fn leaf(&mut self, voxel: [i32; 3]) -> &mut ([u64; 8], Vec<f32>) {
        let background = self.background;
        self.leaves.entry(voxel.map(|c| c & !7)).or_insert_with(|| ([0; 8], vec![background; 512]))
    }

    pub fn set(&mut self, voxel: [i32; 3], value: f32) {
        let [x, y, z] = voxel.map(|c| (c & 7) as usize);
        let (mask, values) = self.leaf(voxel);
        mask[x] |= 1 << (y << 3 | z);
        values[x << 6 | y << 3 | z] = value;
    }

    pub fn set_inactive(&mut self, voxel: [i32; 3], value: f32) {
        let [x, y, z] = voxel.map(|c| (c & 7) as usize);
        self.leaf(voxel).1[x << 6 | y << 3 | z] = value;
    }

    pub fn tile(&mut self, origin: [i32; 3], dim: u32, value: f32, active: bool) {
        self.tiles.push(Tile { origin, dim, value, active });
    }

    pub fn sparse(&self) -> SparseGrid<f32> {
        SparseGrid {
            background: self.background,
            index_to_world: DAffine3::IDENTITY,
            leaves: self.leaves.keys().copied().collect(),
            masks: self.leaves.values().map(|leaf| leaf.0).collect(),
            values: self.leaves.values().flat_map(|leaf| leaf.1.clone()).collect(),
            tiles: self.tiles.clone(),
        }
    }

    pub fn grid(&self) -> DensityGrid {
        DensityGrid::from_sparse(&self.sparse())
    }

    pub fn extinction(&self, index_to_world: DAffine3, density_scale: f64) -> GridExtinction {
        GridExtinction::new(self.grid(), index_to_world, density_scale)
    }

    /// The value of one voxel: the finest leaf or tile that covers it.
    pub fn value(&self, voxel: [i64; 3]) -> f32 {
        let inside = |tile: &&Tile<f32>| {
            (0..3).all(|a| {
                let low = i64::from(tile.origin[a]);
                (low..low + i64::from(tile.dim)).contains(&voxel[a])
            })
        };
        let leaf = voxel.map(|c| i32::try_from(c & !7).unwrap_or(i32::MAX));
        if let Some((_, values)) = self.leaves.get(&leaf) {
            let [x, y, z] = voxel.map(|c| (c & 7) as usize);
            return values[x << 6 | y << 3 | z];
        }
        let tile = self.tiles.iter().filter(inside).min_by_key(|tile| tile.dim);
        tile.map_or(self.background, |tile| tile.value)
    }

    /// OpenVDB's BoxSampler, clipped to the render bounds.
    pub fn density(&self, bounds: (DVec3, DVec3), point: DVec3) -> f64 {
        if !(point.cmpge(bounds.0) & point.cmple(bounds.1)).all() {
            return 0.0;
        }
        let base = point.floor();
        let weight = point - base;
        let mut sum = 0.0;
        for corner in 0..8_i64 {
            let offset = [corner >> 2, corner >> 1 & 1, corner & 1];
            let mut share = 1.0;
            for axis in 0..3 {
                share *= if offset[axis] == 1 { weight[axis] } else { 1.0 - weight[axis] };
            }
            let voxel = std::array::from_fn(|axis| base[axis] as i64 + offset[axis]);
            sum += share * f64::from(self.value(voxel));
        }
        sum
    }
}

/// A fog of steep edges: a few random voxels, constant bricks and empty space.
pub fn cloud(radius: i32) -> Voxels {
    Voxels::of_field([-radius; 3], [radius; 3], |[x, y, z]| {
        let r = f64::from(x * x + y * y + z * z).sqrt() / f64::from(radius);
        let wave =
            (0.9 * f64::from(x)).sin() * (0.7 * f64::from(y)).cos() + (0.5 * f64::from(z)).sin();
        (1.0 - r).max(0.0) * (1.0 + 0.5 * wave).max(0.0)
    })
}
