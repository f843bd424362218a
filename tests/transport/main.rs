//! Photons and paths on their way through media, against exact answers.

#[path = "../support/grid.rs"]
mod grid_support;
#[path = "../support/transport.rs"]
mod transport_support;

mod balance;
mod furnace;
mod point;
mod reference_agreement;
mod reference_scenes;
mod reference_truth;
mod repeat;
