//! Extinction from a density grid: sigma_t = density_scale * density, trilinear between voxels.
//!
//! [`DensityGrid`] holds the voxels of a [`SparseGrid`](crate::medium::vdb::SparseGrid) as bricks with aprons below a
//! sparse index. Rays walk its blocks: delta tracking with one majorant a block, or voxel cells for exact
//! optical depths. [`GridExtinction`] places a grid in the world; [`ColorGrid`] and [`ValueGrid`] are read at points.
//!
//! # Memory
//!
//! A leaf of the sparse grid has 2124 bytes: 512 values, their mask and its origin. A brick has 2920 bytes, with 729 values,
//! or 1462 in [`BrickPrecision::Half`]; a region with bricks has a table of 16 KiB. There are as many bricks as
//! leaves, and those below leaves whose last layer of cells is not empty. Measured, in bytes an active voxel
//! (and a leaf):
//!
//! | file | active voxels | leaves | bricks | sparse grid | bricks | bricks in half | index |
//! |---|---|---|---|---|---|---|---|
//! | `smoke_plume.vdb` | 119,778 | 498 | 552 | 8.83 (2124) | 13.46 (3237) | 6.74 (1620) | 0.55 (133) |
//! | `cloud.vdb` | 235,542 | 791 | 835 | 7.13 (2124) | 10.35 (3082) | 5.18 (1543) | 0.42 (125) |
//! | a cloud of 512^3 | 37,785,869 | 89,552 | 91,981 | 5.03 (2124) | 7.11 (2999) | 3.56 (1502) | 0.03 (15) |
//!
//! While a grid is built the sparse grid exists, too, and some 40 bytes a leaf and 8 a brick to plan with. All of it
//! is counted before it is allocated and compared with [`Limits`](crate::medium::vdb::Limits).

mod active_voxels;
mod block_walk;
mod brick_atlas;
mod brick_index;
mod brick_plan;
mod budget;
mod cell_walk;
mod color_grid;
pub(super) mod cubic;
mod delta_tracking;
mod density_grid;
mod extinction;
mod half_scale;
mod index_builder;
mod place_mask;
mod ratio_tracking;
mod slot;
#[cfg(test)]
mod test_grids;
mod trilinear;
mod value_grid;
mod voxel_source;

pub use brick_atlas::BrickPrecision;
pub use budget::DensityGridError;
pub use color_grid::ColorGrid;
pub use density_grid::{DensityGrid, GridStatistics};
pub use extinction::GridExtinction;
pub use value_grid::ValueGrid;
