//! The settings of a render, once for the report and once for the image's metadata.

use serde::Serialize;

use crate::film::RenderMetadata;
use crate::render::{RenderOptions, RenderReport};
use crate::scene::{EstimateSettings, PhotonSettings, RenderSettings, Scene};

/// Everything that determines the image, and the number of threads, which does not.
#[derive(Clone, Debug, Serialize)]
pub struct UsedSettings {
    /// Name of the scene file, without its directory, or what else it is called.
    pub scene: String,
    /// Of all values and files of the scene, in hexadecimal.
    pub scene_hash: String,
    /// Passes asked for, if so many were.
    pub passes: Option<u32>,
    /// Relative error asked for.
    pub target_error: Option<f64>,
    /// Seconds allowed.
    pub time_budget: Option<f64>,
    /// Threads used.
    pub threads: usize,
    /// Width and height \[pixels\].
    pub resolution: [usize; 2],
    /// `[photons]` of the scene, overrides applied.
    pub photons: PhotonSettings,
    /// `[estimate]`
    pub estimate: EstimateSettings,
    /// `[render]`
    pub render: RenderSettings,
}

impl UsedSettings {
    /// The settings of a scene called `name` as it is rendered.
    pub fn of(name: String, scene: &Scene, options: &RenderOptions, threads: usize) -> Self {
        Self {
            scene: name,
            scene_hash: format!("{:016x}", scene.hash),
            passes: (options.passes != u32::MAX).then_some(options.passes),
            target_error: options.target_error,
            time_budget: options.seconds,
            threads,
            resolution: [scene.camera.width, scene.camera.height],
            photons: scene.photons,
            estimate: scene.estimate,
            render: scene.render,
        }
    }

    /// The settings as attributes of the image, named as in the scene file (`photons.seed`). The number
    /// of threads stays out: images are the same for any.
    pub fn metadata(&self, scene: &Scene, report: &RenderReport) -> RenderMetadata {
        let mut metadata = RenderMetadata::new();
        metadata.set("version", env!("CARGO_PKG_VERSION"));
        metadata.set("scene", &self.scene);
        metadata.set("scene_hash", &self.scene_hash);
        metadata.set("passes", report.passes_done);
        metadata.set("photons_emitted", report.emitted_count);
        for (name, value) in scene.settings() {
            metadata.set(&name, value);
        }
        metadata
    }
}
