//! Why a scene cannot be compared, as one sentence that says the way out.

use thiserror::Error;

use crate::lab::error::LabError;
use crate::render::RenderError;

/// Why a scene cannot be compared.
#[derive(Debug, Error)]
pub enum SceneComparisonError {
    /// It cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A k that no comparison has.
    #[error(transparent)]
    Lab(#[from] LabError),
    /// The reference does not fit.
    #[error(
        "the reference image has {} x {} pixels, no multiple of {} x {}; give --pixels that divide it",
        reference[0], reference[1], image[0], image[1]
    )]
    ReferenceSize {
        /// Width and height of the reference.
        reference: [usize; 2],
        /// Width and height of the images.
        image: [usize; 2],
    },
    /// Its map is too small.
    #[error("of {n} photons the map holds {stored} and k = {k} takes {needed}: {way_out}")]
    TooFewPhotons {
        /// Photons emitted.
        n: u64,
        /// Photons stored.
        stored: usize,
        /// The largest k asked for.
        k: u64,
        /// Photons it takes.
        needed: u64,
        /// What to do.
        way_out: &'static str,
    },
    /// More than memory allows.
    #[error("{values} values would be kept of {what} and {limit} can be; lower {flags}")]
    TooMuch {
        /// Of what.
        what: &'static str,
        /// How many.
        values: u128,
        /// Most that can be kept.
        limit: u128,
        /// What to lower.
        flags: &'static str,
    },
    /// Nothing to compare with.
    #[error("the reference image is black, or not finite: no error can be relative to it")]
    BlackReference,
}
