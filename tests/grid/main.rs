//! Media of voxels.

#[path = "../support/grid.rs"]
mod grid_support;
#[path = "../support/transport.rs"]
mod transport_support;

mod color;
mod emission;
mod precision;
mod sampling;
mod several_volumes;
mod transport;
mod volume_limits;
