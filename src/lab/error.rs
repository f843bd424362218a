//! What the lab cannot compute, as one sentence.

use thiserror::Error;

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum LabError {
    /// No such photon.
    #[error("k = {k} is out of range; it must be from 1 to 10^15")]
    KOutOfRange {
        /// The k asked for.
        k: u64,
    },
    /// There is no k-th photon of the kind the model tells of.
    #[error(
        "{model} has no photon number {k} among n = {n}: it needs {needed} photons; raise --n or lower --k"
    )]
    TooFewPhotons {
        /// The model.
        model: &'static str,
        /// Photons there are.
        n: u64,
        /// The k asked for.
        k: u64,
        /// Photons there must be.
        needed: u64,
    },
    /// 1 / u has no mean.
    #[error("k = {k}: the mean of its estimate is infinite among random photons; take k from 2 on")]
    InfiniteMean {
        /// The k asked for.
        k: u64,
    },
    /// The ball that holds so many photons would reach the light, a face or half of the medium.
    #[error(
        "balls that hold k = {k} of n = {n} photons would be as large as the scene; raise --n or lower --k"
    )]
    BallTooLarge {
        /// The k asked for.
        k: u64,
        /// Photons emitted.
        n: u64,
    },
    /// A photon map cannot be built.
    #[error("{0}")]
    Map(String),
    /// A chart cannot be drawn.
    #[error("the chart {title:?} cannot be drawn: {reason}")]
    Plot {
        /// Its title.
        title: String,
        /// Why.
        reason: String,
    },
}
