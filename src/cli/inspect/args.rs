//! What can be typed after `photonvdb inspect`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::args::VolumeArguments;

const EXAMPLES: &str = "\
Examples:
  photonvdb inspect smoke.vdb
  photonvdb inspect smoke.vdb --json | jq '.grids[].name'
  photonvdb inspect fog.toml
  photonvdb inspect fog.exr";

/// `photonvdb inspect`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct InspectArguments {
    /// A .vdb (its grids), a scene (its plan) or an .exr (its layers and metadata)
    pub file: PathBuf,

    /// Machine-readable, on stdout
    #[arg(long)]
    pub json: bool,

    /// Reading volumes
    #[command(flatten)]
    pub volume: VolumeArguments,
}
