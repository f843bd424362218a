//! Images: against exact answers, against the path tracer, and against themselves.

#[path = "../support/grid.rs"]
mod grid_support;
#[path = "../support/transport.rs"]
mod transport_support;

mod airlight;
mod bake;
mod calibrated;
mod channels;
mod furnace;
mod glow;
mod lattice;
mod layers;
mod reference;
mod resume;
mod scales;
mod visible;
