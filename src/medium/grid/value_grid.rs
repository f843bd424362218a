//! A grid of numbers that are not below 0, placed in the world and read at points: temperatures, flames, a channel of
//! colours. Trilinear between voxels, as densities are; beyond its active voxels the grid's background holds.

use std::sync::Arc;

use super::{BrickPrecision, DensityGrid, DensityGridError, extinction::Placement};
use crate::{
    math::{DAffine3, DVec3},
    medium::vdb::{Limits, SparseGrid},
};

/// Numbers by place.
#[derive(Clone, Debug)]
pub struct ValueGrid {
    /// Shared with other places of the same grid.
    grid: Arc<DensityGrid>,
    placement: Placement,
    background: f64,
    voxel_size: f64,
}

impl ValueGrid {
    /// Places a grid; `index_to_world` is the file's transform followed by the scene's. Values that are not finite or
    /// below 0 count as 0. `None` if no voxel is active, or the transform has no inverse.
    ///
    /// # Errors
    /// As [`DensityGrid::build`].
    pub fn new(
        sparse: &SparseGrid<f32>,
        index_to_world: DAffine3,
        limits: &Limits,
    ) -> Result<Option<Self>, DensityGridError> {
        let grid = DensityGrid::build(sparse, BrickPrecision::Single, limits)?;
        let background = f64::from(sparse.background);
        let background = if background.is_finite() { background.max(0.0) } else { 0.0 };
        Ok(Self::place(Arc::new(grid), background, &index_to_world))
    }

    /// The same values at another place, in the same memory; `None` if the transform has no inverse.
    pub fn moved(&self, index_to_world: DAffine3) -> Option<Self> {
        Self::place(Arc::clone(&self.grid), self.background, &index_to_world)
    }

    fn place(grid: Arc<DensityGrid>, background: f64, index_to_world: &DAffine3) -> Option<Self> {
        let placement = Placement::new(&grid, index_to_world)?;
        let axes = index_to_world.matrix3;
        let edges = [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::length);
        let voxel_size = edges.into_iter().fold(f64::INFINITY, f64::min);
        Some(Self { grid, placement, background, voxel_size })
    }

    /// The value at a place in world space.
    #[inline]
    pub fn value(&self, position: DVec3) -> f64 {
        self.local_value(self.local_point(position))
    }

    /// The corners of the box about its active voxels, in world space.
    pub fn active_corners(&self) -> [DVec3; 8] {
        let shape = self.placement.bounds;
        let [first, last] = self.grid.active_extent();
        std::array::from_fn(|corner| {
            let along =
                |axis: usize| if corner >> axis & 1 == 0 { first[axis] } else { last[axis] };
            let [u, v, w] = shape.edges();
            shape.corner() + u * along(0) + v * along(1) + w * along(2)
        })
    }

    /// The shortest edge of a voxel \[m\].
    pub fn voxel_size(&self) -> f64 {
        self.voxel_size
    }

    /// The largest value anywhere.
    pub fn max(&self) -> f64 {
        self.background.max(self.grid.statistics().max_density.into())
    }

    /// Memory held \[bytes\].
    pub fn bytes(&self) -> usize {
        self.grid.statistics().memory_bytes
    }

    /// Local coordinates of a place: those of every grid of the same topology and transform.
    #[inline]
    pub(super) fn local_point(&self, position: DVec3) -> [f64; 3] {
        self.placement.local_point(position).to_array()
    }

    #[inline]
    pub(super) fn local_value(&self, point: [f64; 3]) -> f64 {
        if self.background != 0.0 && !self.grid.bounds_hold(point) {
            return self.background;
        }
        self.grid.local_density(point)
    }
}
