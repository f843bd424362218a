//! The shortest way from a scene file to an image: fog with a spot light.
//!
//! ```sh
//! cargo run --release --example 01_fog_spot
//! ```

use std::path::Path;

use photonvdb::film::{ExrOptions, RenderMetadata, write_exr, write_preview_png};
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::{Plan, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::load(Path::new("examples/scenes/fog_spot.toml"))?;
    println!("{}", Plan::of(&scene));

    let rendering = render(&scene, &RenderOptions::passes(1), &Unobserved)?;
    let report = &rendering.report;
    println!("{} photons emitted, {} stored", report.emitted_count, report.stored_count);
    println!("power into the fog, per channel: {:.4} W", report.power.emitted);
    println!("of which it absorbs:             {:.4} W", report.power.absorbed);

    std::fs::create_dir_all("output")?;
    let (image, preview) = (Path::new("output/fog_spot.exr"), Path::new("output/fog_spot.png"));
    write_exr(image, &rendering.film, &ExrOptions::default(), &RenderMetadata::new())?;
    write_preview_png(preview, &rendering.film, None)?;
    println!("wrote {} and {}", image.display(), preview.display());
    Ok(())
}
