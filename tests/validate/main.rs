//! The renderer against exact answers, its samplers against their densities, hard cases, grids against numbers, and rates of
//! convergence.

#[path = "../cli/run.rs"]
mod cli_run;
mod command;
mod constant_grid;
mod convergence;
mod emission_samplers;
mod hard_cases;
mod quick;
mod samplers;
#[path = "../support/transport.rs"]
mod transport_support;
