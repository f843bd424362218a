//! Validation: what the renderer measures, against exact answers of radiative transfer.
//!
//! Every quantity is measured by the renderer's own emission, tracing, media, photon map and estimators, in 32 independent
//! batches with seeds of their own, and held against the exact answer:
//! z = (measured - exact) / standard error, what lies within an allowed bias (that of kernels, said row by row) not counted.
//! It passes with |z| < 4; from 4 to 6 it is measured once more with other seeds and four times the photons; from 6 on, or if
//! it fails again, it fails. Quantities without noise must agree to rounding.
//!
//! ```text
//! truth ──┐
//! scene ──┴─check──batches──▶ row: exact, measured, standard error, z, verdict ──▶ report
//! ```
//! The exact answers stand in `truth/`, closed forms beside what they are compared with. [`hard_cases`] are the numerically
//! hard ones: vanishing and enormous extinction, coincident photons, axis-parallel rays, and so on.

mod airlight;
mod ball;
mod check;
mod error;
mod field;
mod furnace;
mod glow;
mod hard;
mod hetero;
mod identities;
mod infinite;
mod kernel;
mod neighbors;
mod report;
mod slab;
mod stage;
mod truth;

pub use error::ValidateError;
pub use hard::hard_cases;
pub use report::{Report, Row, Verdict};
pub use truth::{
    AirlightRay, BallTruth, Depth, FluenceByRadius, FreeFlight, GlowSeen, GlowingBall, Hetero,
    Infinite, SlabFluence, SlabTruth, Tracking, Truth,
};

use check::Check;

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Some of every kind, in seconds; what is too rare for that is left out.
    Quick,
    /// Every answer there is, in minutes.
    Full,
}

impl Extent {
    /// The one of two values that this extent takes.
    fn pick<T>(self, quick: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }

    fn is_full(self) -> bool {
        self == Self::Full
    }
}

/// Measures all quantities of an extent, with random numbers from `seed`. `advanced` is told of each check done, of so many.
///
/// # Errors
/// The renderer refused a scene.
pub fn validate(
    extent: Extent,
    truth: &Truth,
    seed: u64,
    advanced: impl Fn(usize, usize),
) -> Result<Report, ValidateError> {
    let mut rows = hetero::depths(truth)?;
    rows.extend(identities::exact_rows()?);
    let checks = checks(extent, truth)?;
    let count = checks.len();
    for (done, check) in checks.iter().enumerate() {
        rows.extend(check.rows(seed)?);
        advanced(done + 1, count);
    }
    if extent == Extent::Quick {
        rows.retain(|row| row.verdict != Verdict::Rare);
    }
    Ok(Report { rows })
}

fn checks(extent: Extent, truth: &Truth) -> Result<Vec<Check<'_>>, ValidateError> {
    let mut checks = infinite::checks(extent, &truth.infinite);
    checks.extend(ball::checks(extent, &truth.ball));
    checks.extend(slab::checks(extent, truth));
    checks.extend(glow::checks(extent, truth));
    checks.extend(airlight::checks(extent, &truth.airlight));
    checks.extend(hetero::checks(extent, &truth.hetero)?);
    checks.extend(identities::checks(extent));
    checks.extend(furnace::checks(extent));
    checks.extend(neighbors::checks(extent));
    Ok(checks)
}
