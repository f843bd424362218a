//! Figures of a render, and as reports write them.

use serde::Serialize;

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
    /// The figures for a report, of estimates from `k` photons.
    pub fn figures(&self, k: usize) -> RenderFigures {
        RenderFigures {
            passes_done: self.passes_done,
            photons: self.photon_counts(),
            power: self.power,
            calibration: self.calibration_figures(k),
            estimated_relative_error: self.error.map(|error| error.total()),
            filter_radius: self.filter_radius,
            estimated_error: self.error,
        }
    }

    /// Photons over all passes.
    pub fn photon_counts(&self) -> PhotonCounts {
        PhotonCounts { emitted: self.emitted_count, stored: self.stored_count }
    }

    /// The numerator of estimates from `k` photons, if it was measured.
    pub fn calibration_figures(&self, k: usize) -> Option<CalibrationFigures> {
        self.calibration.map(|calibration| CalibrationFigures {
            k,
            constant: calibration.constant,
            std_error: calibration.std_error,
            count_variance: calibration.law.variance,
            count_exponent: calibration.law.exponent,
        })
    }

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

/// Figures of a render, under the names that they have in reports. What is unknown is `null` there.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct RenderFigures {
    /// Passes completed: fewer than asked for if the render was cancelled.
    pub passes_done: u32,
    /// Over all passes.
    pub photons: PhotonCounts,
    /// Where the power of the photons went, per channel \[W\].
    pub power: PowerBalance,
    /// The numerator of estimates, where it was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<CalibrationFigures>,
    /// Of the image, from how its passes differ: root mean square over the mean. Two passes at least.
    pub estimated_relative_error: Option<f64>,
    /// Radius of the window that multiple scattering was filtered in \[pixels\]: 0 where it was not.
    pub filter_radius: usize,
    /// What the error is made of.
    pub estimated_error: Option<ErrorEstimate>,
}

/// Photons over all passes.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PhotonCounts {
    /// Sent by lights and media.
    pub emitted: u64,
    /// Kept in photon maps: none where they are gathered in a lattice.
    pub stored: u64,
}

/// The divisor `calibrated` as measured.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CalibrationFigures {
    /// Photons of an estimate.
    pub k: usize,
    /// What they count as.
    pub constant: f64,
    /// Its standard error.
    pub std_error: f64,
    /// Variance of the number of photons in a ball where k are expected.
    pub count_variance: f64,
    /// The power of the expected number with which it grows.
    pub count_exponent: f64,
}

/// Time of each stage \[s\].
#[derive(Clone, Copy, Debug, Default, Serialize)]
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
