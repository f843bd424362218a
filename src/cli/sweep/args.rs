//! What can be typed after `photonvdb sweep`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;

use super::list::{List, parse_counts, parse_errors, parse_path_count, parse_paths};
use crate::cli::args::VolumeArguments;
use crate::cli::count::{parse_count, parse_resolution};
use crate::cli::table_outputs::TableOutputs;

const EXAMPLES: &str = "\
One row is one setting. Modes: `knn` and `lattice` are one pass of so many photons, gathered so; `target` is the scene as `render`
plans it, until its own estimate of its error is low enough; `paths` is the reference path tracer. --k and --divisor are for knn, --lattice is for
lattices; every combination of the values given is measured.

  error       root mean squared error of an image, the noise of the reference taken off in quadrature where it is known
  bias        what is left of it in the mean of infinitely many runs; in brackets, the most that is credible to 95 %
  mean        all pixels together over the reference, less 1
  noise       what runs differ by: error^2 = bias^2 + noise^2
  estimated   the error as the image estimates it itself
  CPU s       processor time of an image; the scene is loaded once, before
  efficiency  1 / (error^2 x processor time)

All errors are relative to the mean of the reference. Stars mark the Pareto front: what nothing beats in both error and
processor time. The CSV is the same, byte for byte, for equal requests; --timing adds times, efficiency and front.

Examples:
  photonvdb sweep fog.toml --plot sweep.svg
      Defaults: the reference is made by 8192 paths a pixel, the image is 64 pixels wide.
  photonvdb reference fog.toml -o truth.exr --resolution 128x128 --target-error 0.005
  photonvdb sweep fog.toml --reference truth.exr --csv sweep.csv --timing
      Against a reference made before, at its size.
  photonvdb sweep fog.toml --gather knn --k 10,50 --divisor k,k-1 --spp none --target-error none
      Nothing but k-nearest estimates.
  photonvdb sweep fog.toml --gather lattice --lattice 16,32,64 --samples 1,4 --emission random,sobol
      Cells, rays a pixel and emission of the lattice.";

/// `photonvdb sweep`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct SweepArguments {
    /// Scene file, .toml or .json
    pub scene: PathBuf,

    /// Image to hold all others against; its layer `variance`, if it has one, tells its own noise [default: made by the path
    /// tracer]
    #[arg(long, value_name = "REF.exr")]
    pub reference: Option<PathBuf>,

    /// Paths a pixel of the reference, where none is given
    #[arg(long, value_name = "N", default_value = "8192", value_parser = parse_path_count, conflicts_with = "reference")]
    pub reference_spp: u64,

    /// Photons emitted an image
    #[arg(long, value_name = "LIST", default_value = "1e4,1e5,1e6", value_parser = parse_counts)]
    pub photons: List<u64>,

    /// Photons of one estimate
    #[arg(long, value_name = "LIST", default_value = "10,50,200", value_parser = parse_counts)]
    pub k: List<u64>,

    /// What the k nearest photons count as [default: estimate.divisor of the scene]
    #[arg(long, value_name = "D", value_delimiter = ',',
        value_parser = PossibleValuesParser::new(["k", "k-1", "k-1/2", "calibrated"]))]
    pub divisor: Vec<String>,

    /// How photons are sampled at the lights [default: photons.emission of the scene]
    #[arg(long, value_name = "E", value_delimiter = ',',
        value_parser = PossibleValuesParser::new(["random", "stratified", "sobol"]))]
    pub emission: Vec<String>,

    /// How light scattered twice or more is gathered from photons
    #[arg(long, value_name = "G", value_delimiter = ',', default_value = "knn,lattice",
        value_parser = PossibleValuesParser::new(["knn", "lattice", "none"]))]
    pub gather: Vec<String>,

    /// Cells of lattices along their longest side [default: by the number of photons]
    #[arg(long, value_name = "LIST", value_parser = parse_counts)]
    pub lattice: Option<List<u64>>,

    /// Rays a pixel of knn and lattice [default: render.samples_per_pixel of the scene]
    #[arg(long, value_name = "LIST", value_parser = parse_counts)]
    pub samples: Option<List<u64>>,

    /// Relative errors that the scene is rendered to; `none` leaves this curve out
    #[arg(long, value_name = "LIST", default_value = "0.1,0.05,0.02", value_parser = parse_errors)]
    pub target_error: List<f64>,

    /// Paths a pixel of the path tracer; `none` leaves this curve out
    #[arg(long, value_name = "LIST", default_value = "4,16,64", value_parser = parse_paths)]
    pub spp: List<u64>,

    /// Independent images of each setting
    #[arg(long, value_name = "R", default_value = "3", value_parser = parse_runs)]
    pub runs: u64,

    /// Seed of every random number: equal seeds give equal tables, but for times
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u64,

    /// Image size in pixels [default: that of the reference given, or 64 pixels wide in the scene's shape]
    #[arg(long, value_name = "WxH", value_parser = parse_resolution)]
    pub resolution: Option<[u64; 2]>,

    /// Threads to use [default: one a core]; errors do not depend on it
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// Reading volumes
    #[command(flatten)]
    pub volume: VolumeArguments,

    /// Files of the table
    #[command(flatten)]
    pub outputs: TableOutputs,

    /// No progress bar and no warnings
    #[arg(short, long)]
    pub quiet: bool,
}

fn parse_runs(text: &str) -> Result<u64, String> {
    let count = parse_count(text)?;
    if count < 2 {
        return Err("bias and noise are told apart by several runs; take 2 or more".into());
    }
    Ok(count)
}
