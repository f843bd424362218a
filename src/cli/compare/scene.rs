//! `photonvdb compare SCENE`: in a scene file.

use std::path::{Path, PathBuf};

use indicatif::ProgressBar;
use photonvdb::film::{RgbImage, read_rgb};
use photonvdb::lab::{SceneComparison, SceneComparisonError};
use photonvdb::scene::{Overrides, Scene};

use super::args::CompareArguments;
use super::{chart, emissions, scene_summary};
use crate::cli::console::say;
use crate::cli::error::CliError;
use crate::cli::resources::cpu_seconds;
use crate::cli::thread_pool;

/// Photons of a run by default: every map and image takes them anew.
const PHOTONS: u64 = 100_000;

/// Photons of a render of the reference over those of a run.
const REFERENCE_FACTOR: u64 = 8;

/// Width of images by default, and of those that a reference is averaged to at most twice that \[pixels\].
const WIDTH: usize = 32;

/// Whether the name is that of a scene file.
pub fn is_file(name: &str) -> bool {
    let extension = Path::new(name).extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|e| e.eq_ignore_ascii_case("toml") || e.eq_ignore_ascii_case("json"))
}

/// Measures what the arguments ask for.
pub fn run(arguments: &CompareArguments) -> Result<(), CliError> {
    let n = arguments.n.unwrap_or(PHOTONS);
    let request = SceneComparison {
        emissions: emissions(&arguments.emission),
        ks: arguments.k.0.clone(),
        n,
        runs: arguments.runs,
        queries: arguments.queries,
        reference_photons: arguments.reference_photons.unwrap_or(REFERENCE_FACTOR * n),
        seed: arguments.seed,
    };
    let pool = thread_pool(arguments.threads)?;
    arguments.outputs.check()?;
    let path = PathBuf::from(&arguments.scene);
    let overrides = Overrides {
        photons: Some(n),
        photons_only: arguments.photons_only.then_some(true),
        max_volume_memory: arguments.volume.max_volume_memory,
        ..Overrides::default()
    };
    let mut scene = Scene::load_with(&path, &overrides)?;
    scene.warnings.iter().for_each(|warning| say(&format!("warning: {warning}")));
    let reference = arguments.reference.as_deref().map(read_rgb).transpose()?;
    let [width, height] = size(arguments, &scene, reference.as_ref());
    (scene.camera.width, scene.camera.height) = (width, height);

    // Draws nothing where stderr is no terminal.
    let bar = ProgressBar::new(request.step_count(reference.is_some()));
    let compared = pool
        .install(|| request.tabulate(&mut scene, reference.as_ref(), cpu_seconds, || bar.inc(1)));
    bar.finish_and_clear();
    let table = compared.map_err(|source: SceneComparisonError| CliError::SceneComparison {
        path,
        source: Box::new(source),
    })?;
    let csv = if arguments.outputs.timing { table.to_csv_with_times() } else { table.to_csv() };
    let summary = scene_summary::of(&table, &arguments.scene);
    arguments.outputs.write(&csv, &table, &chart::scene_bias(&table), &summary)
}

/// Width and height of images: as asked for, or those of the reference over the least whole number that makes them small,
/// or small and of the scene's shape.
fn size(arguments: &CompareArguments, scene: &Scene, reference: Option<&RgbImage>) -> [usize; 2] {
    if let Some(pixels) = arguments.pixels {
        return pixels.map(|side| usize::try_from(side).unwrap_or(usize::MAX));
    }
    if let Some(RgbImage { width, height, .. }) = reference {
        let is_whole = |step: &usize| width.is_multiple_of(*step) && height.is_multiple_of(*step);
        let step = (1..=*width).filter(is_whole).find(|step| width / step <= 2 * WIDTH);
        let step = step.unwrap_or(1);
        return [width / step, height / step];
    }
    let shape = scene.camera.height as f64 / scene.camera.width as f64;
    [WIDTH, ((WIDTH as f64 * shape).round() as usize).max(1)]
}
