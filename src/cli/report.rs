//! The machine-readable report of a render.

use std::path::{Path, PathBuf};

use photonvdb::film::ImageError;
use photonvdb::render::{RenderFigures, RenderReport, StageSeconds, UsedSettings};
use photonvdb::scene::Plan;
use serde::Serialize;

use super::resources::{cpu_seconds, peak_memory_bytes};

/// What `--report` writes. Figures that are unknown are `null`.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Of the program.
    pub version: &'static str,
    /// What the scene needed.
    pub plan: Plan,
    /// What determines the image.
    pub settings: UsedSettings,
    /// Passes, photons, power, estimated error.
    #[serde(flatten)]
    pub figures: RenderFigures,
    /// Wall-clock time \[s\].
    pub seconds: Seconds,
    /// Processor time of all threads \[s\].
    pub cpu_seconds: Option<f64>,
    /// The most memory ever held \[bytes\].
    pub peak_memory_bytes: Option<u64>,
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
        settings: UsedSettings,
        k: usize,
        [load, write]: [f64; 2],
    ) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            plan,
            settings,
            figures: made.figures(k),
            seconds: Seconds { load, stages: made.seconds, write, total: 0.0 },
            cpu_seconds: cpu_seconds(),
            peak_memory_bytes: peak_memory_bytes(),
            comparison: None,
        }
    }
}

/// Wall-clock time of each step \[s\], with that of the runs before where a render was resumed.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Seconds {
    pub load: f64,
    #[serde(flatten)]
    pub stages: StageSeconds,
    pub write: f64,
    pub total: f64,
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

/// Whether a path stands for stdout.
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}
