//! Extinction from a density grid: sigma_t = density_scale * density, trilinear between voxels.
//!
//! [`DensityGrid`] holds the voxels of a [`SparseGrid`](crate::medium::vdb::SparseGrid) as bricks with aprons below a
//! sparse index. Rays walk its blocks: delta tracking with one majorant a block, or voxel cells for exact
//! optical depths. [`GridExtinction`] places a grid in the world; [`ColorGrid`] and [`ValueGrid`] are read at points.

mod active_voxels;
mod block_walk;
mod brick_atlas;
mod brick_index;
mod cell_walk;
mod color_grid;
pub(super) mod cubic;
mod delta_tracking;
mod density_grid;
mod extinction;
mod index_builder;
mod slot;
#[cfg(test)]
mod test_grids;
mod trilinear;
mod value_grid;
mod voxel_source;

pub use color_grid::ColorGrid;
pub use density_grid::{DensityGrid, GridStatistics};
pub use extinction::GridExtinction;
pub use value_grid::ValueGrid;
