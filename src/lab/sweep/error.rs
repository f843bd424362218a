//! Why settings cannot be compared, as one sentence that says the way out.

use thiserror::Error;

use crate::film::FilmError;
use crate::reference::ReferenceError;
use crate::render::RenderError;

/// Why settings cannot be compared.
#[derive(Debug, Error)]
pub enum SweepError {
    /// The scene cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The reference cannot be rendered.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// The reference is of another size.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// Bias and noise cannot be told apart.
    #[error("{runs} runs do not tell bias from noise; take 2 or more")]
    TooFewRuns {
        /// Runs asked for.
        runs: u64,
    },
    /// More than memory allows.
    #[error(
        "{values} values of images would be kept and {limit} can be; lower --resolution or --runs"
    )]
    TooMuch {
        /// Channels of all pixels of all runs of a setting.
        values: u128,
        /// Most that can be kept.
        limit: u128,
    },
    /// Nothing to be relative to.
    #[error("the reference image is black, or not finite: no error can be relative to it")]
    BlackReference,
}
