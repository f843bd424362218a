//! Random against stratified emission in a user's scene, whose truth is not known but measured.
//!
//! ```text
//! scene ──prepare──▶ photon maps ──k nearest at the same places──▶ errors a place ──over maps──▶ point rows
//! scene ──render───▶ small images ──against a reference image────▶ errors a pixel ──over runs──▶ pixel rows
//! ```
//! The power that a ball is expected to hold is the mean of what all other maps hold there: powers in fixed balls are
//! unbiased for every way of emission. Pixels are held against a given image, or against the mean of renders with
//! more photons.

mod csv;
mod error;
mod pixels;
mod place;
mod points;
mod request;
mod row;

pub use error::SceneComparisonError;
pub use request::{SceneComparison, SceneCost, SceneReference, SceneTable};
pub use row::{PixelRow, PointRow};
