//! Scene files.

mod damage;
mod errors;
mod examples;
mod hash;
mod preset;
mod schema;
mod sky;
mod volume;
