//! `photonvdb render`: a scene in, an image and a report out.

pub mod args;

use std::path::Path;
use std::time::Instant;

use photonvdb::film::{FilmError, RgbImage, compare, read_rgb};
use photonvdb::render::{
    Checkpoints, Observer, RenderOptions, RenderState, UsedSettings, photons_per_pass, render_from,
};
use photonvdb::scene::{Plan, Scene};

use super::error::CliError;
use super::image_files::write_images;
use super::interrupt;
use super::outputs;
use super::progress::Progress;
use super::report::{Comparison, Report};
use super::summary::Summary;
use super::text_file::write_json;
use super::thread_pool;
use args::RenderArguments;

/// Renders what the arguments ask for.
pub fn run(arguments: &RenderArguments) -> Result<(), CliError> {
    let started = Instant::now();
    let summary = Summary { quiet: arguments.quiet };
    // What can fail must fail before the work, not after it.
    check_outputs(arguments)?;
    let scene = load_scene(arguments)?;
    let reference = load_reference(arguments, &scene)?;
    let options = arguments.options(&scene);
    let resumed = load_checkpoint(arguments, &scene, &options)?;
    let plan = Plan { photons: photons_per_pass(&scene, &options), ..Plan::of(&scene) };
    let interrupted = interrupt::catch()?;
    summary.plan(&scene, &plan);
    summary.idle_flags(&arguments.idle_flags(&scene, &options));
    let load = started.elapsed().as_secs_f64();

    let pool = thread_pool(arguments.threads)?;
    let name = arguments.scene.file_name().unwrap_or(arguments.scene.as_os_str());
    let name = name.to_string_lossy().into_owned();
    let settings = UsedSettings::of(name, &scene, &options, pool.current_num_threads());
    let passes_before = resumed.as_ref().map_or(0, RenderState::passes_done);
    let seconds_before = resumed.as_ref().map_or(0.0, RenderState::seconds);
    if resumed.is_some() {
        summary.resumed(passes_before, seconds_before);
    }
    let progress = Progress::new(&options, passes_before, arguments.quiet, interrupted)
        .with_pictures(arguments.show);
    let save_to = arguments.checkpoint.as_deref();
    let checkpoints = Checkpoints { resume_from: resumed, save_to };
    let rendering = pool.install(|| render_from(&scene, &options, &progress, checkpoints))?;

    let made = &rendering.report;
    if progress.cancelled() {
        summary.interrupted(made.passes_done);
    }
    let write_started = Instant::now();
    let metadata = settings.metadata(&scene, made);
    let files = [Some(arguments.output.as_path()), arguments.preview.as_deref()];
    let (film, options) = (&rendering.film, arguments.exr_options());
    // What else was asked for is written all the same.
    let written = pool.install(|| write_images(files, film, &options, &metadata));
    let seconds = [load, write_started.elapsed().as_secs_f64()];
    let mut report = Report::of(made, plan, settings, scene.estimate.k, seconds);
    if let Some((path, reference)) = reference {
        let error = compare(&RgbImage::from(&rendering.film), &reference)?;
        report.comparison = Some(Comparison::new(path, error));
    }
    progress.show_finished(&rendering.film);
    report.seconds.total = seconds_before + started.elapsed().as_secs_f64();
    let report_to = arguments.report.as_deref();
    let reported = report_to.map_or(Ok(()), |path| write_json(path, &report));
    summary.report(made, &report, scene.photons.max_order);
    written.and(reported)?;
    summary.written(arguments);
    Ok(())
}

fn check_outputs(arguments: &RenderArguments) -> Result<(), CliError> {
    let files = [
        ("--output", Some(arguments.output.as_path())),
        ("--preview", arguments.preview.as_deref()),
        ("--checkpoint", arguments.checkpoint.as_deref()),
        ("--report", arguments.report.as_deref()),
    ];
    outputs::check(&files, &arguments.scene, &[("--reference", arguments.reference.as_deref())])
}

fn load_scene(arguments: &RenderArguments) -> Result<Scene, CliError> {
    Ok(Scene::load_with(&arguments.scene, &arguments.overrides())?)
}

fn load_checkpoint(
    arguments: &RenderArguments,
    scene: &Scene,
    options: &RenderOptions,
) -> Result<Option<RenderState>, CliError> {
    let path = arguments.resume.as_deref();
    Ok(path.map(|path| RenderState::load(path, scene, options)).transpose()?)
}

fn load_reference<'a>(
    arguments: &'a RenderArguments,
    scene: &Scene,
) -> Result<Option<(&'a Path, RgbImage)>, CliError> {
    let Some(path) = arguments.reference.as_deref() else { return Ok(None) };
    let reference = read_rgb(path)?;
    let image = [scene.camera.width, scene.camera.height];
    if image != [reference.width, reference.height] {
        let reference = [reference.width, reference.height];
        return Err(FilmError::SizeMismatch { image, reference }.into());
    }
    Ok(Some((path, reference)))
}
