//! Figures of a render.

use crate::render::Calibration;
use crate::render::ErrorEstimate;
use crate::trace::PowerBalance;

/// Figures of a render, summed over its passes.
#[derive(Clone, Copy, Debug, Default)]
pub struct RenderReport {
    /// Photons emitted.
    pub emitted_count: u64,
    /// Photons stored.
    pub stored_count: u64,
    /// Bytes a photon of the map takes.
    pub bytes_per_photon: usize,
    /// Where the power went: the mean over passes \[W\].
    pub power: PowerBalance,
    /// Time of each stage \[s\].
    pub seconds: StageSeconds,
    /// The numerator of estimates, where it is measured: before the first pass is read, and for all of them.
    pub calibration: Option<Calibration>,
    /// Passes completed.
    pub passes_done: u32,
    /// Radius of the window that multiple scattering is filtered in \[pixels\]: 0 where it is not.
    pub filter_radius: usize,
    /// What the passes say of the image's error; `None` from fewer than two.
    pub error: Option<ErrorEstimate>,
}

impl RenderReport {
    /// Adds what another render, or a part of this one, took; its power, means and passes are the caller's.
    pub(super) fn add_costs(&mut self, part: &Self) {
        self.emitted_count += part.emitted_count;
        self.stored_count += part.stored_count;
        self.bytes_per_photon = part.bytes_per_photon;
        self.calibration = part.calibration;
        self.seconds.trace += part.seconds.trace;
        self.seconds.build += part.seconds.build;
        self.seconds.gather += part.seconds.gather;
        self.seconds.calibrate += part.seconds.calibrate;
    }
}

/// Time of each stage \[s\].
#[derive(Clone, Copy, Debug, Default)]
pub struct StageSeconds {
    /// Emitting and tracing photons.
    pub trace: f64,
    /// Building the photon map.
    pub build: f64,
    /// Reading it along the camera's rays.
    pub gather: f64,
    /// Measuring the numerator of estimates.
    pub calibrate: f64,
}
