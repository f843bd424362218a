//! The machine-readable report of a render.

use std::path::{Path, PathBuf};

use photonvdb::film::ImageError;
use photonvdb::render::{ErrorEstimate, RenderReport, StageSeconds};
use photonvdb::scene::Plan;
use serde::Serialize;

use super::resources::{cpu_seconds, peak_memory_bytes};
use super::settings::Settings;

/// What `--report` writes. Figures that are unknown are `null`.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Of the program.
    pub version: &'static str,
    /// What the scene needed.
    pub plan: Plan,
    /// What determines the image.
    pub settings: Settings,
    /// Passes completed: fewer than asked for if Ctrl-C was pressed.
    pub passes_done: u32,
    /// Over all passes.
    pub photons: PhotonCounts,
    /// Per channel \[W\].
    pub power: Power,
    /// The numerator of estimates, where it was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<CalibrationFigures>,
    /// Wall-clock time \[s\].
    pub seconds: Seconds,
    /// Processor time of all threads \[s\].
    pub cpu_seconds: Option<f64>,
    /// The most memory ever held \[bytes\].
    pub peak_memory_bytes: Option<u64>,
    /// Of the image, from how its passes differ: root mean square over the mean. Two passes at least.
    pub estimated_relative_error: Option<f64>,
    /// Radius of the window that multiple scattering was filtered in \[pixels\]: 0 where it was not.
    pub filter_radius: usize,
    /// What it is made of.
    pub estimated_error: Option<EstimatedError>,
    /// Against the reference, if one was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub comparison: Option<Comparison>,
}

impl Report {
    /// Of a render that took so many seconds to load and to write, with estimates from k photons; the total and a comparison are added
    /// later.
    pub fn of(
        made: &RenderReport,
        plan: Plan,
        settings: Settings,
        k: usize,
        [load, write]: [f64; 2],
    ) -> Self {
        let StageSeconds { trace, build, calibrate, gather } = made.seconds;
        Self {
            version: env!("CARGO_PKG_VERSION"),
            plan,
            settings,
            passes_done: made.passes_done,
            photons: made.into(),
            power: made.into(),
            calibration: CalibrationFigures::of(made, k),
            seconds: Seconds { load, trace, build, calibrate, gather, write, total: 0.0 },
            cpu_seconds: cpu_seconds(),
            peak_memory_bytes: peak_memory_bytes(),
            estimated_relative_error: made.error.map(|error| error.total()),
            filter_radius: made.filter_radius,
            estimated_error: made.error.map(Into::into),
            comparison: None,
        }
    }
}

/// Photons over all passes.
#[derive(Debug, Serialize)]
pub struct PhotonCounts {
    pub emitted: u64,
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

impl CalibrationFigures {
    /// The figures of a render with estimates from k photons, if it measured them.
    pub fn of(report: &RenderReport, k: usize) -> Option<Self> {
        report.calibration.map(|calibration| Self {
            k,
            constant: calibration.constant,
            std_error: calibration.std_error,
            count_variance: calibration.law.variance,
            count_exponent: calibration.law.exponent,
        })
    }
}

/// Where the power of the photons went, per channel \[W\]: emitted = absorbed + escaped + truncated + resampled.
#[derive(Debug, Serialize)]
pub struct Power {
    pub emitted: [f64; 3],
    pub absorbed: [f64; 3],
    pub escaped: [f64; 3],
    pub truncated: [f64; 3],
    pub resampled: [f64; 3],
}

/// Wall-clock time of each step \[s\], with that of the runs before where a render was resumed.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Seconds {
    pub load: f64,
    pub trace: f64,
    pub build: f64,
    pub calibrate: f64,
    pub gather: f64,
    pub write: f64,
    pub total: f64,
}

/// What the passes say of the image's error, as shares of its mean.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct EstimatedError {
    pub noise: f64,
    pub bias: f64,
}

impl From<ErrorEstimate> for EstimatedError {
    fn from(error: ErrorEstimate) -> Self {
        Self { noise: error.noise, bias: error.bias }
    }
}

/// How far the image is from a reference.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    pub reference: PathBuf,
    pub mean_ratio: f64,
    pub rel_rmse: f64,
    pub block_rel_rms: f64,
}

impl Comparison {
    /// The figures against the image at `reference`.
    pub fn new(reference: &Path, error: ImageError) -> Self {
        let ImageError { mean_ratio, rel_rmse, block_rel_rms } = error;
        Self { reference: reference.to_path_buf(), mean_ratio, rel_rmse, block_rel_rms }
    }
}

impl From<&RenderReport> for PhotonCounts {
    fn from(report: &RenderReport) -> Self {
        Self { emitted: report.emitted_count, stored: report.stored_count }
    }
}

impl From<&RenderReport> for Power {
    fn from(report: &RenderReport) -> Self {
        let power = &report.power;
        Self {
            emitted: power.emitted.to_array(),
            absorbed: power.absorbed.to_array(),
            escaped: power.escaped.to_array(),
            truncated: power.truncated.to_array(),
            resampled: power.resampled.to_array(),
        }
    }
}

/// Whether a path stands for stdout.
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}
