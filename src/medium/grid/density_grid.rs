//! The sampling structure of a sparse density grid, in index space.
//!
//! Voxels are point samples at integer index coordinates, trilinear in between (OpenVDB's BoxSampler), and
//! nothing lies outside the render bounds \[min - 1, max + 1\] of the active voxels.

use std::alloc::{Layout, handle_alloc_error};

use super::{
    active_voxels::ActiveVoxels,
    brick_atlas::{BRICK_EDGE, BrickAtlas, BrickPrecision},
    brick_index::{BrickIndex, Cell, Content, ROOT_SHIFT},
    brick_plan::LocalKeys,
    budget::{Budget, DensityGridError},
    index_builder::build,
    trilinear::blend,
    voxel_source::VoxelSource,
};
use crate::{
    math::DVec3,
    medium::vdb::{Limits, SparseGrid},
};

/// A density field ready for Monte Carlo: lookups, majorants and optical depths.
#[derive(Debug)]
pub struct DensityGrid {
    active: Option<ActiveVoxels>,
    /// Index coordinates of the local origin, a multiple of 4096 below the bounds.
    base: Cell,
    /// First and last cell in the bounds, local.
    pub(super) first: Cell,
    pub(super) last: Cell,
    pub(super) index: BrickIndex,
    pub(super) atlas: BrickAtlas,
    max_density: f32,
}

/// What a [`DensityGrid`] holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridStatistics {
    /// Active voxels, those of tiles included; saturates.
    pub active_voxel_count: u64,
    /// Bricks of 9^3 values stored.
    pub brick_count: usize,
    /// Largest density.
    pub max_density: f32,
    /// Memory held \[bytes\].
    pub memory_bytes: usize,
}

impl DensityGrid {
    /// Builds the sampling structure of a grid whose size the caller knows: as [`DensityGrid::build`] with single
    /// precision and no limit.
    ///
    /// As a [`Vec`] does, it aborts the process where memory runs out.
    pub fn from_sparse(grid: &SparseGrid<f32>) -> Self {
        let limits = Limits { max_bytes: u64::MAX };
        Self::build(grid, BrickPrecision::Single, &limits)
            .unwrap_or_else(|_| handle_alloc_error(Layout::new::<SparseGrid<f32>>()))
    }

    /// Builds the sampling structure. Values that are not finite or below 0 count as 0.
    ///
    /// Memory is proportional to the leaves and tiles of `grid`, whatever their size or distance, with a large
    /// factor if they are scattered: a lone leaf has up to eight bricks in as many tables. All of it is counted
    /// before it is allocated, `grid` included.
    ///
    /// # Errors
    /// When `grid` and the structure together need more memory than `limits` allows or there is.
    pub fn build(
        grid: &SparseGrid<f32>,
        precision: BrickPrecision,
        limits: &Limits,
    ) -> Result<Self, DensityGridError> {
        let mut budget = Budget::new(grid.memory_bytes(), limits)?;
        let active = ActiveVoxels::of(grid);
        let (min, max) = active.map_or(([0; 3], [0; 3]), |active| (active.min, active.max));
        let base = min.map(|c| ((c - 1) >> ROOT_SHIFT) << ROOT_SHIFT);
        let first = std::array::from_fn(|axis| min[axis] - 1 - base[axis]);
        let last = std::array::from_fn(|axis| max[axis] - base[axis]);
        let source = VoxelSource::new(grid, &mut budget)?;
        let local = LocalKeys { base, first, last };
        let (index, atlas) = build(&source, local, precision, &mut budget)?;
        let max_density = source.max_constant().max(atlas.max());
        Ok(Self { active, base, first, last, index, atlas, max_density })
    }

    /// Density at a point given in index space; 0 outside the render bounds.
    pub fn density(&self, index_point: DVec3) -> f64 {
        self.local_density((index_point - self.local_origin()).to_array())
    }

    /// The render bounds in index space, lowest and highest corner; `None` if no voxel is active.
    pub fn render_bounds(&self) -> Option<(DVec3, DVec3)> {
        let corner = |c: [i64; 3]| DVec3::from_array(c.map(|c| c as f64));
        let ActiveVoxels { min, max, .. } = self.active?;
        Some((corner(min.map(|c| c - 1)), corner(max.map(|c| c + 1))))
    }

    /// First and last active voxel on each axis, as shares of the render bounds.
    pub(super) fn active_extent(&self) -> [[f64; 3]; 2] {
        let cells: [f64; 3] =
            std::array::from_fn(|axis| (self.last[axis] - self.first[axis] + 1) as f64);
        [cells.map(|count| 1.0 / count), cells.map(|count| 1.0 - 1.0 / count)]
    }

    /// Counts, extremes and memory.
    pub fn statistics(&self) -> GridStatistics {
        GridStatistics {
            active_voxel_count: self.active.map_or(0, |active| active.count),
            brick_count: self.atlas.len(),
            max_density: self.max_density,
            memory_bytes: size_of::<Self>() + self.index.bytes() + self.atlas.bytes(),
        }
    }

    /// Index coordinates of the origin of local coordinates, in which all of the grid is positive.
    pub(super) fn local_origin(&self) -> DVec3 {
        DVec3::from_array(self.base.map(|c| c as f64))
    }

    /// Whether there is any density.
    pub(super) fn is_empty(&self) -> bool {
        self.active.is_none() || self.max_density == 0.0
    }

    /// The cell around a local point, the nearest in the bounds if there is none.
    #[inline(always)]
    pub(super) fn cell_at(&self, point: [f64; 3]) -> Cell {
        std::array::from_fn(|axis| (point[axis] as i64).clamp(self.first[axis], self.last[axis]))
    }

    /// Whether a point in local coordinates lies inside the render bounds.
    #[inline]
    pub(super) fn bounds_hold(&self, point: [f64; 3]) -> bool {
        self.active.is_some()
            && (0..3).all(|axis| {
                point[axis] >= self.first[axis] as f64
                    && point[axis] <= (self.last[axis] + 1) as f64
            })
    }

    /// Density at a point in local coordinates; 0 outside the render bounds.
    #[inline]
    pub(super) fn local_density(&self, point: [f64; 3]) -> f64 {
        if !self.bounds_hold(point) {
            return 0.0;
        }
        let cell = self.cell_at(point);
        let weight = std::array::from_fn(|axis| point[axis] - cell[axis] as f64);
        match self.index.content_at(cell) {
            Content::Uniform(density) => density,
            Content::Corners(corners) => blend(&corners, weight),
            Content::Brick(brick) => {
                let place = cell.map(|c| c as usize % BRICK_EDGE);
                blend(&self.atlas.corners(brick, place), weight)
            }
        }
    }
}
