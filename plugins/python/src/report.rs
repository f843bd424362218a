//! Reports as JSON, with the keys of `photonvdb render --report`.

use photonvdb::render::{RenderFigures, RenderReport, StageSeconds, UsedSettings};
use photonvdb::scene::Plan;
use serde::Serialize;
use serde_json::{Value, json};

/// How an image was made.
#[derive(Serialize)]
pub struct Report {
    /// Of the module.
    pub version: &'static str,
    /// What the scene needed.
    pub plan: Plan,
    /// What determines the image.
    pub settings: UsedSettings,
    /// Passes, photons, power, estimated error.
    #[serde(flatten)]
    pub figures: RenderFigures,
    /// Wall-clock time [s].
    pub seconds: Seconds,
}

/// Wall-clock time of each step [s].
#[derive(Serialize)]
pub struct Seconds {
    pub load: f64,
    #[serde(flatten)]
    pub stages: StageSeconds,
    pub total: f64,
}

/// How a photon map was made.
pub fn map_report(report: &RenderReport, k: usize) -> Value {
    let StageSeconds { trace, build, calibrate, .. } = report.seconds;
    let mut all = json!({
        "photons": report.photon_counts(),
        "power": report.power,
        "seconds": { "trace": trace, "build": build, "calibrate": calibrate },
    });
    if let Some(calibration) = report.calibration_figures(k) {
        all["calibration"] = json!(calibration);
    }
    all
}
