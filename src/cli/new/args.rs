//! What can be typed after `photonvdb new`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use photonvdb::math::DVec3;
use photonvdb::scene::Preset;

use crate::cli::args::VolumeArguments;
use crate::cli::count::parse_positive;
use crate::cli::file_names::toml_name;
use crate::cli::presets::parse_preset;

const EXAMPLES: &str = "\
The scene renders as it is: the camera frames the volume, a sun and a sky light it, and the density is scaled so that the
medium is neither thin nor opaque. It is commented, and meant to be changed.

Examples:
  photonvdb new plume.toml --from plume.vdb
      A scene around a volume.
  photonvdb new plume.toml --from plume.vdb --optical-depth 12 --grid soot --up z
      Denser, of another grid, of a program whose z axis points up.
  photonvdb new fog.toml --preset fog
      A block of fog; `photonvdb presets` lists what there is.
  photonvdb new plume.toml --from plume.vdb --preset steam
      A volume with albedo and phase function of steam.
  photonvdb render plume.toml -o plume.exr --resolution 160x120 --photons 1e5 --show
      And a look at it.";

/// `photonvdb new`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct NewArguments {
    /// Scene file to write; `-` is stdout
    #[arg(value_name = "SCENE.toml", value_parser = toml_name())]
    pub scene: PathBuf,

    /// Volume to make it around
    #[arg(long, value_name = "FILE.vdb", required_unless_present = "preset")]
    pub from: Option<PathBuf>,

    /// Medium to make it of; with --from, its albedo and phase function
    #[arg(long, value_name = "NAME", value_parser = parse_preset)]
    pub preset: Option<Preset>,

    /// Mean optical depth of the camera's rays through the medium: 1 is thin, 4 smoke, 30 a cloud
    #[arg(long, value_name = "DEPTH", default_value_t = 4.0, value_parser = parse_positive)]
    pub optical_depth: f64,

    /// Density grid [default: `density`, or what looks most like one]
    #[arg(long, value_name = "NAME", requires = "from")]
    pub grid: Option<String>,

    /// The axis that points up in the volume
    #[arg(long, value_name = "AXIS", value_enum, default_value = "y")]
    pub up: UpAxis,

    /// Replace the scene file if there is one
    #[arg(long)]
    pub force: bool,

    /// Reading volumes
    #[command(flatten)]
    pub volume: VolumeArguments,
}

/// The axis that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum UpAxis {
    /// As in Houdini and Maya
    Y,
    /// As in Blender
    Z,
}

impl UpAxis {
    /// Its direction.
    pub fn direction(self) -> DVec3 {
        match self {
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }
}
