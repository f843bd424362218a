//! The lab: models, experiments and comparisons.

mod compare;
mod compare_scene;
mod experiments;
mod models;
mod sweep;
