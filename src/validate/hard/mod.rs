//! Numerically hard cases, each with its right answer: vanishing and enormous extinction, phase functions at their ends,
//! photons that coincide, scenes of any size and place, grids of any voxels, rays along faces and axes, needles of light,
//! underflow and long sums.

mod densities;
mod extinction;
mod lights;
mod map;
mod phase;
mod places;
mod rays;
mod sums;
mod voxels;

use super::check::{Batch, Check};
use super::error::ValidateError;
use super::report::{Report, Row};

/// Seed of what draws random numbers.
const SEED: u64 = 7;

/// Photons of cases that need but a few.
const FEW: Batch = Batch { seed: SEED, count: 5000 };

/// Measures every hard case, in seconds.
///
/// # Errors
/// The renderer refused a scene.
pub fn hard_cases() -> Result<Report, ValidateError> {
    let mut rows = Vec::new();
    rows.extend(extinction::rows()?);
    rows.extend(phase::rows()?);
    rows.extend(map::rows()?);
    rows.extend(places::rows()?);
    rows.extend(voxels::rows()?);
    rows.extend(densities::rows()?);
    rows.extend(rays::rows()?);
    rows.extend(lights::rows()?);
    rows.extend(sums::rows());
    Ok(Report { rows })
}

/// The rows of checks that have noise.
fn noisy(checks: &[Check]) -> Result<Vec<Row>, ValidateError> {
    let mut rows = Vec::new();
    for check in checks {
        rows.extend(check.rows(SEED)?);
    }
    Ok(rows)
}
