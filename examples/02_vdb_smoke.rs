//! A density grid from an OpenVDB file: what the file holds, and a draft of it in evening light.
//!
//! ```sh
//! cargo run --release --example 02_vdb_smoke
//! ```

use std::path::Path;

use photonvdb::film::{ExrOptions, RenderMetadata, write_exr, write_preview_png};
use photonvdb::medium::vdb::{VdbFile, VolumeSource};
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::{Overrides, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for grid in VdbFile::open(Path::new("media/smoke_plume.vdb"))?.grids() {
        let voxels = grid.active_voxel_count;
        println!("grid {}: {}, {voxels} active voxels", grid.unique_name, grid.value_type);
    }

    // The scene file says how the grid becomes a medium: sigma_t = density_scale * density.
    let draft =
        Overrides { photons: Some(300_000), resolution: Some([180, 240]), ..Overrides::default() };
    let scene = Scene::load_with(Path::new("examples/scenes/smoke_sun.toml"), &draft)?;
    let rendering = render(&scene, &RenderOptions::passes(1), &Unobserved)?;
    println!("{} photons stored", rendering.report.stored_count);
    let seconds = rendering.report.seconds;
    println!("traced in {:.1} s, gathered in {:.1} s", seconds.trace, seconds.gather);

    std::fs::create_dir_all("output")?;
    let (image, preview) = (Path::new("output/vdb_smoke.exr"), Path::new("output/vdb_smoke.png"));
    write_exr(image, &rendering.film, &ExrOptions::default(), &RenderMetadata::new())?;
    write_preview_png(preview, &rendering.film, None)?;
    println!("wrote {} and {}", image.display(), preview.display());
    Ok(())
}
