//! How a render tells of its progress, and how it is asked to stop.

use crate::files::WriteFailure;
use crate::film::Film;
use crate::render::ErrorEstimate;

/// A stage of one pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Photons are emitted and followed through the medium; steps are photons.
    Trace,
    /// The photon map is built; steps are photons.
    Build,
    /// The camera's rays read the photon map, and steps are pixels; or voxels do that are to bear their light.
    Gather,
}

/// Watches a render. Calls come from any thread.
pub trait Observer: Sync {
    /// A stage begins that consists of `total` steps.
    fn stage_started(&self, stage: Stage, total: u64);

    /// The current stage is further on by `steps`.
    fn advanced(&self, steps: u64);

    /// The stage is complete.
    fn stage_finished(&self, stage: Stage);

    /// A pass is complete: the mean of `passes` has that error.
    fn pass_finished(&self, _passes: u32, _error: Option<ErrorEstimate>) {}

    /// The mean of the passes so far, as it is: not filtered.
    fn image(&self, _film: &Film) {}

    /// The checkpoint of a pass could not be written; the render goes on.
    fn checkpoint_failed(&self, _failure: &WriteFailure) {}

    /// Whether to end after the pass in flight.
    fn cancelled(&self) -> bool;
}

/// Watches nothing and never stops a render.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn stage_started(&self, _: Stage, _: u64) {}

    fn advanced(&self, _: u64) {}

    fn stage_finished(&self, _: Stage) {}

    fn cancelled(&self) -> bool {
        false
    }
}
