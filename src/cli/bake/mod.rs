//! `photonvdb bake`: a scene in, an OpenVDB file of its light out.

pub mod args;

use std::collections::BTreeMap;

use photonvdb::math::{Rgb, mean_channel};
use photonvdb::medium::vdb::{
    GridClass, GridToWrite, MetadataValue, SparseGrid, WriteOptions, WrittenGrid, write_vdb,
};
use photonvdb::medium::{Medium, MediumExtinction};
use photonvdb::render::{
    BakeReport, Baked, Observer, RenderError, RenderOptions, bake, even_densities,
};
use photonvdb::scene::Scene;

use super::console::say;
use super::error::CliError;
use super::interrupt;
use super::outputs;
use super::progress::Progress;
use super::thread_pool;
use args::BakeArguments;

/// Bakes what the arguments ask for.
pub fn run(arguments: &BakeArguments) -> Result<(), CliError> {
    // What can fail must fail before the work, not after it.
    outputs::check(&[("--output", Some(&arguments.output))], &arguments.scene, &[])?;
    let overrides = arguments.overrides();
    let scene = Scene::load_with(&arguments.scene, &overrides)?;
    let options = arguments.options();
    let number = options.medium;
    let medium = scene.medium.volume(number).ok_or(RenderError::NoSuchMedium { number })?;
    let tell = |text: &str| {
        if !arguments.quiet {
            say(text);
        }
    };
    scene.warnings.iter().for_each(|warning| tell(&format!("warning: {warning}")));
    let pool = thread_pool(arguments.threads)?;
    let load = || Scene::load_densities(&arguments.scene, &overrides, number);
    let densities = match pool.install(load)? {
        Some(densities) => densities,
        None => even_densities(medium, arguments.voxels as usize, &options.limits)?,
    };
    let passes = RenderOptions::passes(options.passes);
    let progress = Progress::new(&passes, 0, arguments.quiet, interrupt::catch()?);
    let baked = pool.install(|| bake(&scene, &densities, &options, &progress))?;
    if progress.cancelled() {
        let done = baked.report.photons.passes_done;
        tell(&format!("interrupted after {done} of {} passes", options.passes));
    }
    let grids = Grids { scene: &scene, medium, densities: &densities, baked: &baked };
    let written = pool.install(|| grids.write(arguments))?;
    tell(&summary(&baked.report));
    let count = |grid: &WrittenGrid| grid.byte_count;
    let bytes: u64 = written.iter().map(count).sum();
    let names: Vec<&str> = written.iter().map(|grid| grid.unique_name.as_str()).collect();
    let path = arguments.output.display();
    tell(&format!("wrote {path}: {}, {bytes} bytes", names.join(", ")));
    Ok(())
}

/// `119778 voxels, mean fluence 1.234e0 W/m^2, scattered 5.678e0 W, absorbed 1.234e-1 W, 2.34 s`
fn summary(report: &BakeReport) -> String {
    let seconds = report.photons.seconds;
    let mean = |light: Rgb| mean_channel(light);
    format!(
        "{} voxels, mean fluence {:.3e} W/m^2, scattered {:.3e} W, absorbed {:.3e} W, {:.2} s",
        report.voxel_count,
        mean(report.mean_fluence),
        mean(report.scattered),
        mean(report.absorbed),
        seconds.trace + seconds.build + seconds.gather,
    )
}

/// What is written.
struct Grids<'a> {
    scene: &'a Scene,
    medium: &'a Medium,
    densities: &'a SparseGrid<f32>,
    baked: &'a Baked,
}

impl Grids<'_> {
    fn write(&self, arguments: &BakeArguments) -> Result<Vec<WrittenGrid>, CliError> {
        let density_scale = match &self.medium.extinction {
            MediumExtinction::Grid(grid) => grid.density_scale(),
            // The density of a homogeneous medium is its sigma_t; of a grid with scale 0 there is none.
            extinction
                if extinction.sigma_t(self.densities.index_to_world.translation) == Rgb::ZERO =>
            {
                0.0
            }
            _ => 1.0,
        };
        let albedo = self.medium.albedo.to_array().map(|channel| channel.to_string()).join(" ");
        let density = GridToWrite {
            class: GridClass::FogVolume,
            metadata: BTreeMap::from([
                ("density_scale".into(), MetadataValue::float(density_scale as f32)),
                ("albedo".into(), MetadataValue::text(&albedo)),
                ("creator".into(), creator()),
            ]),
            ..GridToWrite::new("density", self.densities)
        };
        let fluence = self.light("fluence", "W/m^2", &self.baked.fluence);
        let emission = self.light("emission", "W/(m^3 sr)", &self.baked.emission);
        let grids = [density, fluence, emission];
        Ok(write_vdb(&arguments.output, &grids, &WriteOptions::default())?)
    }

    /// A grid of light, and what repeats it.
    fn light<'a>(
        &self,
        name: &'a str,
        unit: &str,
        values: &'a SparseGrid<[f32; 3]>,
    ) -> GridToWrite<'a> {
        let made = &self.baked.report.photons;
        let entries = [
            ("unit", unit.to_string()),
            ("vector_type", "invariant".to_string()),
            ("scene_hash", format!("{:016x}", self.scene.hash)),
            ("seed", self.scene.photons.seed.to_string()),
            ("photons_emitted", made.emitted_count.to_string()),
            ("passes", made.passes_done.to_string()),
        ];
        let entries = entries.map(|(key, text)| (key.to_string(), MetadataValue::text(&text)));
        let mut metadata = BTreeMap::from(entries);
        metadata.insert("creator".into(), creator());
        GridToWrite { metadata, ..GridToWrite::new(name, values) }
    }
}

fn creator() -> MetadataValue {
    MetadataValue::text(concat!("photonvdb ", env!("CARGO_PKG_VERSION")))
}
