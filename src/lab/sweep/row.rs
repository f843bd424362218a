//! One setting, its error and its cost.

use serde::Serialize;

use super::setting::SweepSetting;
use super::split::ErrorSplit;
use crate::lab::compare::emission_name;

/// One setting: what it is, how far from the reference, and how long it takes. Errors are relative to the mean of the reference.
#[derive(Clone, Debug, Serialize)]
pub struct SweepRow {
    /// `knn`, `lattice`, `target` (as planned, until the estimated error is reached) or `paths` (the reference path tracer).
    pub mode: &'static str,
    /// Photons emitted, where the setting says so.
    pub photons: Option<u64>,
    /// How they are sampled.
    pub emission: Option<&'static str>,
    /// Photons of one estimate.
    pub k: Option<usize>,
    /// Numerator of the estimate.
    pub divisor: Option<&'static str>,
    /// Cells of the lattice along its longest side, where the setting says so.
    pub cells: Option<usize>,
    /// Rays or paths a pixel, where the setting says so.
    pub samples: Option<u64>,
    /// Error asked for.
    pub target_error: Option<f64>,
    /// Independent images.
    pub runs: u64,
    /// Root mean squared error of an image, the reference's own noise taken off.
    pub error: f64,
    /// Its standard error.
    pub error_std_error: f64,
    /// Part of the error that no number of runs averages out.
    pub bias: f64,
    /// The largest bias that is credible, to 95 %; `None` of fewer than 3 runs.
    pub bias_high: Option<f64>,
    /// Mean of all pixels over that of the reference, less 1.
    pub mean_bias: f64,
    /// Its standard error.
    pub mean_bias_std_error: f64,
    /// Standard deviation of a pixel.
    pub noise: f64,
    /// Its square.
    pub variance: f64,
    /// The error that images estimate of themselves, root mean square; `None` where they cannot.
    pub estimated_error: Option<f64>,
    /// Processor time of an image \[s\]; `None` where the system does not tell. The scene is loaded already.
    pub cpu_seconds: Option<f64>,
    /// 1 / (error^2 x processor time).
    pub efficiency: Option<f64>,
    /// Whether no other setting is as good in both error and processor time, and better in one.
    pub is_on_front: bool,
}

impl SweepRow {
    pub(super) fn new(
        setting: &SweepSetting,
        runs: u64,
        split: ErrorSplit,
        estimated_error: Option<f64>,
        cpu_seconds: Option<f64>,
    ) -> Self {
        let mut row = Self {
            mode: setting.mode(),
            photons: None,
            emission: None,
            k: None,
            divisor: None,
            cells: None,
            samples: None,
            target_error: None,
            runs,
            error: split.error,
            error_std_error: split.error_std_error,
            bias: split.bias,
            bias_high: split.bias_high,
            mean_bias: split.mean_bias,
            mean_bias_std_error: split.mean_bias_std_error,
            noise: split.noise,
            variance: split.noise * split.noise,
            estimated_error,
            cpu_seconds,
            efficiency: cpu_seconds.map(|seconds| 1.0 / (split.error * split.error * seconds)),
            is_on_front: false,
        };
        match *setting {
            SweepSetting::Knn { photons, emission, k, divisor, rays } => {
                (row.photons, row.emission) = (Some(photons), Some(emission_name(emission)));
                (row.k, row.divisor) = (Some(k), Some(divisor.name()));
                row.samples = Some(rays as u64);
            }
            SweepSetting::Lattice { photons, emission, cells, rays } => {
                (row.photons, row.emission) = (Some(photons), Some(emission_name(emission)));
                (row.cells, row.samples) = (cells, Some(rays as u64));
            }
            SweepSetting::Target { error, emission } => {
                (row.target_error, row.emission) = (Some(error), Some(emission_name(emission)));
            }
            SweepSetting::Paths { paths } => row.samples = Some(paths),
        }
        row
    }
}
