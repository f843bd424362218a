//! What can be typed after `photonvdb reference`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use photonvdb::reference::Limits;
use photonvdb::scene::Overrides;

use crate::cli::args::SceneVolumeArguments;
use crate::cli::count::{parse_count, parse_positive, parse_resolution};
use crate::cli::file_names::{exr_name, png_name};

const EXAMPLES: &str = "\
Examples:
  photonvdb reference fog.toml -o truth.exr --spp 256
      So many paths a pixel.
  photonvdb reference fog.toml -o truth.exr --target-error 0.01 --time-budget 600
      Until the image is good to 1 %, but no longer than ten minutes.
  photonvdb render fog.toml -o fog.exr --reference truth.exr
      How far the photon mapper is from it.

The layers are those of `render`, and `variance`, the square of each pixel's standard error, and `sample_count`. Several
limits may be given: the first one reached ends the image. Equal seeds and --spp give equal images, byte for byte, for any number of
threads. Ctrl-C ends it after the pass in flight and writes what there is; a second one ends it at once.";

/// `photonvdb reference`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
#[command(group(ArgGroup::new("limit").required(true).multiple(true).args(["spp", "time_budget", "target_error"])))]
pub struct ReferenceArguments {
    /// Scene file, .toml or .json
    pub scene: PathBuf,

    /// Image to write: linear 32-bit OpenEXR with all layers, variance and sample_count
    #[arg(short, long, value_name = "OUT.exr", value_parser = exr_name())]
    pub output: PathBuf,

    /// Paths a pixel, at least 2
    #[arg(long, value_name = "N", value_parser = parse_samples)]
    pub spp: Option<u64>,

    /// Wall-clock time to stay within; the first pass, of 2 paths a pixel, is always made
    #[arg(long, value_name = "SECONDS", value_parser = parse_positive)]
    pub time_budget: Option<f64>,

    /// Relative error to reach: root of the mean variance of a pixel, over the image's mean
    #[arg(long, value_name = "REL", value_parser = parse_positive)]
    pub target_error: Option<f64>,

    /// Seed of every random number [default: photons.seed of the scene]
    #[arg(long, value_name = "S")]
    pub seed: Option<u64>,

    /// Threads to use [default: one a core]; the image does not depend on it
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// Image size in pixels [default: camera.resolution of the scene]
    #[arg(long, value_name = "WxH", value_parser = parse_resolution)]
    pub resolution: Option<[u64; 2]>,

    /// Tone-mapped picture for a quick look
    #[arg(long, value_name = "OUT.png", value_parser = png_name())]
    pub preview: Option<PathBuf>,

    /// Reading volumes
    #[command(flatten)]
    pub volume: SceneVolumeArguments,

    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

impl ReferenceArguments {
    /// What replaces values of the scene file.
    pub fn overrides(&self) -> Overrides {
        Overrides { seed: self.seed, resolution: self.resolution, ..self.volume.overrides() }
    }

    /// When the image is done.
    pub fn limits(&self) -> Limits {
        Limits { samples: self.spp, seconds: self.time_budget, relative_error: self.target_error }
    }
}

fn parse_samples(text: &str) -> Result<u64, String> {
    match parse_count(text)? {
        1 => Err("one path a pixel tells nothing of its variance; take 2 or more".into()),
        count => Ok(count),
    }
}
