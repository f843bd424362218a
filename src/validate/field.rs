//! Density grids written from a field.

use std::collections::BTreeMap;

use super::error::ValidateError;
use crate::math::{DAffine3, DVec3};
use crate::medium::grid::{BrickPrecision, DensityGrid};
use crate::medium::vdb::{Limits, SparseGrid};
use crate::medium::{GridExtinction, ValueGrid};

/// The values of a field on the integer points of a box, both corners included, and `background` elsewhere.
pub(super) fn sparse(
    min: [i32; 3],
    max: [i32; 3],
    background: f32,
    field: impl Fn([i32; 3]) -> f64,
) -> SparseGrid<f32> {
    let mut leaves: BTreeMap<[i32; 3], ([u64; 8], [f32; 512])> = BTreeMap::new();
    for x in min[0]..=max[0] {
        for y in min[1]..=max[1] {
            for z in min[2]..=max[2] {
                let voxel = [x, y, z];
                let leaf = leaves.entry(voxel.map(|c| c & !7));
                let (mask, values) = leaf.or_insert_with(|| ([0; 8], [background; 512]));
                let [i, j, k] = voxel.map(|c| (c & 7) as usize);
                mask[i] |= 1 << (j << 3 | k);
                values[i << 6 | j << 3 | k] = field(voxel) as f32;
            }
        }
    }
    SparseGrid {
        background,
        index_to_world: DAffine3::IDENTITY,
        leaves: leaves.keys().copied().collect(),
        masks: leaves.values().map(|leaf| leaf.0).collect(),
        values: leaves.values().flat_map(|leaf| leaf.1).collect(),
        tiles: Vec::new(),
    }
}

/// That grid, placed in the world.
pub(super) fn extinction(
    grid: &SparseGrid<f32>,
    place: DAffine3,
    density_scale: f64,
) -> Result<GridExtinction, ValidateError> {
    let grid = DensityGrid::build(grid, BrickPrecision::Single, &Limits::default())?;
    Ok(GridExtinction::new(grid, place, density_scale))
}

/// The same value everywhere, in voxels of edge 0.1.
pub(super) fn everywhere(value: f32) -> Result<ValueGrid, ValidateError> {
    let grid = sparse([0; 3], [0; 3], value, |_| f64::from(value));
    let place = DAffine3::from_scale(DVec3::splat(0.1));
    ValueGrid::new(&grid, place, &Limits::default())?.ok_or(ValidateError::Scene)
}

/// A cloud of steep edges within radius 1: bricks full, sparse and empty.
pub(super) struct Cloud {
    grid: SparseGrid<f32>,
}

impl Cloud {
    /// Voxels along a radius.
    const RADIUS: i32 = 10;

    /// Edge of a voxel.
    const EDGE: f64 = 0.1;

    /// Edge of its bounds, which reach a voxel further.
    pub const BOUNDS: f64 = 2.2;

    pub fn new() -> Self {
        let radius = f64::from(Self::RADIUS);
        let grid = sparse([-Self::RADIUS; 3], [Self::RADIUS; 3], 0.0, |voxel| {
            let [x, y, z] = voxel.map(f64::from);
            let r = (x * x + y * y + z * z).sqrt() / radius;
            let wave = (0.9 * x).sin() * (0.7 * y).cos() + (0.5 * z).sin();
            (1.0 - r).max(0.0) * (1.0 + 0.5 * wave).max(0.0)
        });
        Self { grid }
    }

    /// The cloud in the world.
    pub fn extinction(&self, density_scale: f64) -> Result<GridExtinction, ValidateError> {
        self.extinction_at(DAffine3::IDENTITY, density_scale)
    }

    /// The cloud in a world that `place` carries it to.
    pub fn extinction_at(
        &self,
        place: DAffine3,
        density_scale: f64,
    ) -> Result<GridExtinction, ValidateError> {
        let voxels = DAffine3::from_scale(DVec3::splat(Self::EDGE));
        extinction(&self.grid, place * voxels, density_scale)
    }

    /// Integral of the density over its bounds: trilinear interpolation spreads each voxel over one voxel's volume.
    pub fn mass(&self) -> f64 {
        self.grid.values.iter().map(|value| f64::from(*value)).sum::<f64>() * Self::EDGE.powi(3)
    }
}
