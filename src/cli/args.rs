//! What can be typed: the commands, and what several of them have in common. What only one of them takes is in its own `args`.

use clap::{Args, Parser, Subcommand};
use photonvdb::medium::vdb::Limits;
use photonvdb::scene::Overrides;

use super::bake::args::BakeArguments;
use super::bias::args::BiasArguments;
use super::bytes::parse_bytes;
use super::compare::args::CompareArguments;
use super::completions::CompletionsArguments;
use super::convert::args::ConvertArguments;
use super::count::parse_count;
use super::inspect::args::InspectArguments;
use super::man::ManArguments;
use super::new::args::NewArguments;
use super::presets::PresetsArguments;
use super::reference::args::ReferenceArguments;
use super::render::args::RenderArguments;
use super::schema::SchemaArguments;
use super::sweep::args::SweepArguments;
use super::validate::ValidateArguments;

const EXAMPLES: &str = "\
Examples:
  photonvdb new plume.toml --from plume.vdb
      A scene around a volume, to start from.
  photonvdb render fog.toml -o fog.exr --preview fog.png
      Render a scene and look at it.
  photonvdb render cloud.toml -o cloud.exr --photons 1e7 --passes 16
      Sixteen independent passes of ten million photons, averaged.
  photonvdb reference fog.toml -o truth.exr --target-error 0.01
      The same image by path tracing, with its variance.
  photonvdb bake smoke.toml -o smoke_lit.vdb
      Its light as grids of an OpenVDB file, for renderers that show emissive volumes.
  photonvdb bias 3d-random 3d-jittered --k 10,50,100
      How far k-nearest estimates are off, exact and measured.
  photonvdb compare analytic:point-absorbing --k 10,50,100
      What stratified emission gains over random emission where the truth is known.
  photonvdb compare fog.toml
      What it gains in a scene: at points, and in pixels.
  photonvdb sweep fog.toml --plot sweep.svg
      Speed against error: photons, k, gathering and the path tracer.
  photonvdb inspect smoke.vdb
      The grids of an OpenVDB file: types, bounds, values, and whether they can be rendered.
  photonvdb inspect fog.toml
      What a scene needs, without rendering it.
  photonvdb convert smoke.vdb -o small.vdb --grid density --half
      One grid of an OpenVDB file, in half the space.
  photonvdb validate
      What the renderer measures, against exact answers.

Exit codes: 0 done, 1 a check asked for did not hold, 2 bad input or usage.";

/// Renders fog, smoke, clouds and fire, homogeneous or from OpenVDB files, by volumetric photon mapping.
#[derive(Debug, Parser)]
#[command(name = "photonvdb", version, after_help = EXAMPLES, max_term_width = 100)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Write a scene to start from: around a .vdb, or of a preset
    New(NewArguments),
    /// Render a scene to OpenEXR
    Render(Box<RenderArguments>),
    /// Write a scene's light to a .vdb: fluence, and in-scattered light as emission, on the tree of its density
    Bake(Box<BakeArguments>),
    /// Render a scene without photons and without bias, however long it takes: what others are compared with
    Reference(Box<ReferenceArguments>),
    /// Measure the bias of density estimates on models whose truth is known
    Bias(Box<BiasArguments>),
    /// Measure random against stratified emission, in a scene or where the power density is known
    Compare(Box<CompareArguments>),
    /// Measure speed against error: a scene in many settings, against one reference
    Sweep(Box<SweepArguments>),
    /// Show what is in a .vdb, a scene or an .exr
    Inspect(InspectArguments),
    /// Write grids of a .vdb to another: some of them, cropped, smaller
    Convert(ConvertArguments),
    /// Check what the renderer measures against exact answers
    Validate(ValidateArguments),
    /// List the media known by name
    Presets(PresetsArguments),
    /// Print what a scene file may say, as JSON Schema or in words
    Schema(SchemaArguments),
    /// Print a completion script for a shell
    Completions(CompletionsArguments),
    /// Write manual pages
    Man(ManArguments),
}

/// What reading a volume may cost.
#[derive(Args, Debug)]
pub struct VolumeArguments {
    /// Memory that reading a volume may take, like 512MiB or 20GB [default: 8GiB]
    #[arg(long, value_name = "SIZE", value_parser = parse_bytes)]
    pub max_volume_memory: Option<u64>,
}

impl VolumeArguments {
    /// The limit given, or the default.
    pub fn limits(&self) -> Limits {
        let default = Limits::default();
        Limits { max_bytes: self.max_volume_memory.unwrap_or(default.max_bytes) }
    }
}

/// How the volumes of a scene are read.
#[derive(Args, Debug)]
pub struct SceneVolumeArguments {
    /// What reading may cost
    #[command(flatten)]
    pub memory: VolumeArguments,

    /// Make it an error, not a warning, when a volume has NaN, infinite or negative densities
    #[arg(long)]
    pub strict: bool,

    /// Fill a level set with fog: density 0 on its surface, 1 inside [default: medium.sdf_to_fog of the scene]
    #[arg(long)]
    pub sdf_to_fog: bool,
}

impl SceneVolumeArguments {
    /// What replaces values of the scene file, and nothing else.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            sdf_to_fog: self.sdf_to_fog.then_some(true),
            max_volume_memory: self.memory.max_volume_memory,
            strict: self.strict,
            ..Overrides::default()
        }
    }
}

/// Parses a number of passes.
pub fn parse_passes(text: &str) -> Result<u32, String> {
    let count = parse_count(text)?;
    u32::try_from(count).map_err(|_| format!("`{text}` passes would never end"))
}
