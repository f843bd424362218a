//! The bias lab: what k-nearest estimates of power density get wrong, exact and measured.
//!
//! ```text
//! model ──law──▶ exact mean and variance ─┐
//! model ──experiment──▶ moments ──────────┴─bias──▶ table ──▶ CSV, JSON, SVG
//!
//! analytic scene ──emission, trace, map──▶ errors of queries ──compare──▶ table ──▶ CSV, JSON, SVG
//! scene ──settings──▶ images ──reference──▶ error and time ──sweep──▶ table ──▶ CSV, JSON, SVG
//! ```
//! The models are those of K. Hartmann, "Theoretical study of photon mapping with stratification" (LMU 2020), made exact,
//! and jittered grids, which are what stratified emission is.

mod bias;
mod compare;
mod constant;
mod csv;
mod error;
mod experiment;
pub mod figures;
mod jitter;
mod model;
mod plot;
mod sweep;
mod thread_clock;

pub use bias::{BiasRequest, BiasRow, BiasTable, ExperimentCost};
pub use compare::{
    AnalyticScene, CompareRequest, CompareRow, CompareTable, EmissionCost, PixelRow, PointRow,
    Saving, SceneComparison, SceneComparisonError, SceneCost, SceneReference, SceneTable,
};
pub use constant::Constant;
pub use error::LabError;
pub use experiment::{Experiment, Measured, Method, Moments};
pub use model::{Law, Model, ShellLaw, law};
pub use plot::{Chart, Scale, Series};
pub use sweep::{
    ErrorSplit, KnownImage, Sweep, SweepError, SweepReference, SweepRow, SweepSetting, SweepTable,
    pareto_front,
};
