//! Why a validation could not be carried out.

use crate::map::MapError;
use crate::medium::grid::DensityGridError;
use crate::render::RenderError;

/// Why a validation could not be carried out.
#[derive(Debug, thiserror::Error)]
pub enum ValidateError {
    /// The exact answers cannot be read.
    #[error("the exact answers in {file} cannot be read: {source}")]
    Truth {
        /// Name of the file.
        file: &'static str,
        /// What is wrong with it.
        source: serde_json::Error,
    },
    /// A scene could not be set up.
    #[error("a scene of the validation could not be set up")]
    Scene,
    /// A scene could not be lit.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A photon map could not be built.
    #[error(transparent)]
    Map(#[from] MapError),
    /// A grid could not be built.
    #[error(transparent)]
    Grid(#[from] DensityGridError),
}
