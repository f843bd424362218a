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
