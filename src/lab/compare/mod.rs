//! Random against stratified emission where the power density is known (and, in `scene`, where it is measured): the renderer's own photons, map and search.
//!
//! ```text
//! analytic scene ──emission, tracing──▶ photon maps ──k nearest──▶ errors a query ──over maps──▶ rows
//! ```
//! Photons are emitted and traced as for a render, in as many independent maps as runs. At every query the ball out to
//! the k-th nearest photon has radius R and is expected to hold u photons. Three errors are told apart:
//!
//! - intrinsic, k / u - 1: what is wrong even where the power density is the same all over the ball;
//! - smoothing, its mean over the ball / its value at the query - 1;
//! - total, k / (n V(R) p) - 1: what a render sees.
//!
//! Where photons differ in power, power found over power expected stands for k / u.
//!
//! Queries of one map share its photons, so that standard errors come from the means of maps.

mod analytic;
mod csv;
mod law;
mod photon_maps;
mod point_scene;
mod query_errors;
mod request;
mod row;
mod saving;
mod scattering;
mod scene;

pub(super) use law::student_quantile;
pub(super) use request::emission_name;

pub use analytic::AnalyticScene;
pub use request::{CompareRequest, CompareTable, EmissionCost};
pub use row::CompareRow;
pub use saving::Saving;
pub use scene::{
    PixelRow, PointRow, SceneComparison, SceneComparisonError, SceneCost, SceneReference,
    SceneTable,
};
