//! `photonvdb sweep`: speed against error, as a table, CSV, JSON or chart.

pub mod args;
mod chart;
mod grid;
mod list;
mod summary;

use std::path::Path;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use photonvdb::film::{FilmError, read_rgb, read_variance};
use photonvdb::lab::{KnownImage, Sweep};
use photonvdb::scene::{Overrides, Scene, SceneFile};

use super::console::say;
use super::error::CliError;
use super::resources::cpu_seconds;
use super::thread_pool;
use args::SweepArguments;

/// Width of images where nothing says another \[pixels\].
const WIDTH: u64 = 64;

/// Measures what the arguments ask for.
pub fn run(arguments: &SweepArguments) -> Result<(), CliError> {
    // What can fail must fail before the work, not after it.
    arguments.outputs.check()?;
    let sweep = Sweep {
        settings: grid::settings(arguments)?,
        runs: arguments.runs,
        seed: arguments.seed,
        reference_paths: arguments.reference_spp,
    };
    let reference = arguments.reference.as_deref().map(read_reference).transpose()?;
    let mut scene = load_scene(arguments, reference.as_ref())?;
    let pool = thread_pool(arguments.threads)?;
    let bar = progress_bar(sweep.step_count(reference.is_some()), arguments.quiet);
    let swept =
        pool.install(|| sweep.tabulate(&mut scene, reference.as_ref(), cpu_seconds, || bar.inc(1)));
    bar.finish_and_clear();
    let table = swept.map_err(|source| CliError::Sweep {
        path: arguments.scene.clone(),
        source: Box::new(source),
    })?;
    let csv = if arguments.outputs.timing { table.to_csv_with_times() } else { table.to_csv() };
    let name = arguments.scene.file_name().unwrap_or(arguments.scene.as_os_str());
    let name = name.to_string_lossy();
    let (chart, summary) = (chart::of(&table, &name), summary::of(&table, &name));
    arguments.outputs.write(&csv, &table, &chart, &summary)
}

fn read_reference(path: &Path) -> Result<KnownImage, FilmError> {
    Ok(KnownImage { image: read_rgb(path)?, variance: read_variance(path)? })
}

/// At the size asked for, or that of the reference, or small and of the scene's shape.
fn load_scene(
    arguments: &SweepArguments,
    reference: Option<&KnownImage>,
) -> Result<Scene, CliError> {
    let of_reference = reference.map(|known| [known.image.width as u64, known.image.height as u64]);
    let resolution = match arguments.resolution.or(of_reference) {
        Some(resolution) => resolution,
        None => {
            let camera = SceneFile::load(&arguments.scene, &Overrides::default())?.camera;
            let [width, height] = camera.resolution.map(|side| side as f64);
            [WIDTH, ((WIDTH as f64 * height / width).round() as u64).max(1)]
        }
    };
    let overrides = Overrides {
        resolution: Some(resolution),
        max_volume_memory: arguments.volume.max_volume_memory,
        ..Overrides::default()
    };
    let scene = Scene::load_with(&arguments.scene, &overrides)?;
    if !arguments.quiet {
        scene.warnings.iter().for_each(|warning| say(&format!("warning: {warning}")));
    }
    Ok(scene)
}

fn progress_bar(steps: u64, quiet: bool) -> ProgressBar {
    // `stderr` draws nothing where it is no terminal.
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let style = ProgressStyle::with_template("images [{wide_bar}] {pos}/{len} {elapsed:>4}");
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> ");
    let bar = ProgressBar::with_draw_target(Some(steps), target).with_style(style);
    bar.tick();
    bar
}
