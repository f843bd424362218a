//! Speed against error: a scene rendered in many ways, each several times, against one reference.
//!
//! ```text
//! settings ──render, runs times──▶ images ──split by the reference──▶ error, bias, noise ─┐
//!                  └──processor time───────────────────────────────▶ efficiency, front ───┴──▶ table ──▶ CSV, JSON, SVG
//! ```
//! Of R independent images x of a truth t, with s^2 their variance in a pixel and v that of the reference r, all as means over
//! pixels and channels:
//!
//! - error^2 = mean (x - r)^2 - v,
//! - noise^2 = s^2,
//! - bias^2 = (mean x - r)^2 - s^2 / R - v,
//!
//! so that error^2 = bias^2 + noise^2; each without bias itself. Where chance makes bias^2 negative, it counts as 0. All are told relative to the mean of the reference.

mod csv;
mod error;
mod front;
mod request;
mod row;
mod setting;
mod split;
mod truth;

pub use error::SweepError;
pub use front::pareto_front;
pub use request::{Sweep, SweepReference, SweepTable};
pub use row::SweepRow;
pub use setting::SweepSetting;
pub use split::ErrorSplit;
pub use truth::KnownImage;
