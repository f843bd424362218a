//! The report of a render as a dict, with the keys of `photonvdb render --report`.

use photonvdb::film::RenderMetadata;
use photonvdb::render::{RenderOptions, RenderReport};
use photonvdb::scene::{Plan, Scene};
use serde_json::{Value, json};

/// How a render was made.
pub struct Made<'a> {
    /// What reports call the scene.
    pub name: &'a str,
    /// The scene.
    pub scene: &'a Scene,
    /// What it needed.
    pub plan: &'a Plan,
    /// When it was to end.
    pub options: &'a RenderOptions,
    /// Threads used.
    pub threads: usize,
    /// Its figures.
    pub report: &'a RenderReport,
    /// Loading and all \[s\].
    pub seconds: [f64; 2],
}

impl Made<'_> {
    /// The report.
    pub fn to_json(&self) -> Value {
        let Self { scene, options, report, .. } = *self;
        let mut all = map_report(report, scene.estimate.k);
        let [load, total] = self.seconds;
        all["version"] = json!(env!("CARGO_PKG_VERSION"));
        all["plan"] = json!(self.plan);
        all["settings"] = json!({
            "scene": self.name,
            "scene_hash": format!("{:016x}", scene.hash),
            "passes": (options.passes != u32::MAX).then_some(options.passes),
            "target_error": options.target_error,
            "time_budget": options.seconds,
            "threads": self.threads,
            "resolution": [scene.camera.width, scene.camera.height],
            "photons": scene.photons,
            "estimate": scene.estimate,
            "render": scene.render,
        });
        all["passes_done"] = json!(report.passes_done);
        all["seconds"]["gather"] = json!(report.seconds.gather);
        all["seconds"]["load"] = json!(load);
        all["seconds"]["total"] = json!(total);
        all["estimated_relative_error"] = json!(report.error.map(|error| error.total()));
        all["estimated_error"] =
            json!(report.error.map(|error| json!({ "noise": error.noise, "bias": error.bias })));
        all["filter_radius"] = json!(report.filter_radius);
        all
    }

    /// What the image's file says, as the command line writes it.
    pub fn metadata(&self) -> RenderMetadata {
        let mut metadata = RenderMetadata::new();
        metadata.set("version", env!("CARGO_PKG_VERSION"));
        metadata.set("scene", self.name);
        metadata.set("scene_hash", format!("{:016x}", self.scene.hash));
        metadata.set("passes", self.report.passes_done);
        metadata.set("photons_emitted", self.report.emitted_count);
        for (name, value) in self.scene.settings() {
            metadata.set(&name, value);
        }
        metadata
    }
}

/// How a photon map was made.
pub fn map_report(report: &RenderReport, k: usize) -> Value {
    let RenderReport { power, seconds, .. } = report;
    let mut all = json!({
        "photons": { "emitted": report.emitted_count, "stored": report.stored_count },
        "power": {
            "emitted": power.emitted.to_array(),
            "absorbed": power.absorbed.to_array(),
            "escaped": power.escaped.to_array(),
            "truncated": power.truncated.to_array(),
            "resampled": power.resampled.to_array(),
        },
        "seconds": {
            "trace": seconds.trace,
            "build": seconds.build,
            "calibrate": seconds.calibrate,
        },
    });
    if let Some(calibration) = report.calibration {
        all["calibration"] = json!({
            "k": k,
            "constant": calibration.constant,
            "std_error": calibration.std_error,
            "count_variance": calibration.law.variance,
            "count_exponent": calibration.law.exponent,
        });
    }
    all
}
