//! `photonvdb reference`: a scene in, its image without photons and without bias out.

pub mod args;
mod bar;

use photonvdb::film::{ExrOptions, RenderMetadata};
use photonvdb::reference::{Reference, render_reference};
use photonvdb::scene::Scene;

use super::console::say;
use super::error::CliError;
use super::image_files::write_images;
use super::interrupt;
use super::outputs;
use super::thread_pool;
use args::ReferenceArguments;
use bar::Bar;

/// Renders what the arguments ask for.
pub fn run(arguments: &ReferenceArguments) -> Result<(), CliError> {
    // What can fail must fail before the work, not after it.
    let files = [Some(arguments.output.as_path()), arguments.preview.as_deref()];
    outputs::check(&[("--output", files[0]), ("--preview", files[1])], &arguments.scene, &[])?;
    let scene = Scene::load_with(&arguments.scene, &arguments.overrides())?;
    let tell = |text: &str| {
        if !arguments.quiet {
            say(text);
        }
    };
    scene.warnings.iter().for_each(|warning| tell(&format!("warning: {warning}")));
    let pool = thread_pool(arguments.threads)?;
    let bar = Bar::new(arguments.quiet, interrupt::catch()?);
    let reference = pool.install(|| render_reference(&scene, &arguments.limits(), &bar));
    bar.finish();
    let reference = reference?;
    if reference.progress.share_done < 1.0 {
        tell("ended before a limit was reached");
    }
    let metadata = metadata(arguments, &scene, &reference);
    let options = ExrOptions { variance: true, ..ExrOptions::default() };
    pool.install(|| write_images(files, &reference.film, &options, &metadata))?;
    tell(&summary(&reference));
    let names: Vec<_> =
        files.into_iter().flatten().map(|path| path.display().to_string()).collect();
    tell(&format!("wrote {}", names.join(", ")));
    Ok(())
}

/// `256 spp, mean 5.637e-2, estimated relative error 0.0117, 12.40 s`
fn summary(reference: &Reference) -> String {
    let progress = &reference.progress;
    format!(
        "{} spp, mean {:.6e}, estimated relative error {:.3e}, {:.2} s",
        progress.samples, reference.mean, progress.relative_error, progress.seconds
    )
}

/// What repeats the image. The time it took stays out: equal images are equal files.
fn metadata(
    arguments: &ReferenceArguments,
    scene: &Scene,
    reference: &Reference,
) -> RenderMetadata {
    let name = arguments.scene.file_name().unwrap_or(arguments.scene.as_os_str());
    let mut metadata = RenderMetadata::new();
    metadata.set("version", env!("CARGO_PKG_VERSION"));
    metadata.set("method", "reference path tracer");
    metadata.set("scene", name.to_string_lossy());
    metadata.set("scene_hash", format!("{:016x}", scene.hash));
    metadata.set("photons.seed", scene.photons.seed);
    metadata.set("samples_per_pixel", reference.progress.samples);
    metadata.set("camera.resolution", format!("{}x{}", scene.camera.width, scene.camera.height));
    metadata.set("estimated_relative_error", reference.progress.relative_error);
    metadata
}
