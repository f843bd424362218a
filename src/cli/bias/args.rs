//! What can be typed after `photonvdb bias`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;

use super::k_list::{KList, parse_k_list};
use crate::cli::count::parse_count;
use crate::cli::table_outputs::TableOutputs;

const EXAMPLES: &str = "\
Models:
  1d-random 2d-random 3d-random            photons independent of each other
  1d-stratified 1d-first-approximation     one in each of n parts of a line, the query in the middle
  1d-fixed-radius                          the same, counted within a fixed radius
  2d-basic 3d-basic                        one in each of n shells of equal measure
  2d-order 3d-order                        x in the x-th shell, uniform in radius
  2d-order-volume 3d-order-volume          the same, uniform in area or volume
  1d-jittered 2d-jittered 3d-jittered      one in each cell of a grid, the query at random

Examples:
  photonvdb bias 3d-random 3d-jittered --k 10,50,100 --trials 1e5
      Bias and variance of both, measured and, where known, exact.
  photonvdb bias all --k 2..200 --csv bias.csv --plot bias.svg
      Every model, every divisor.
  photonvdb bias 3d-order --k 1e6,1e9,1e12 --exact-only
      Exact values far beyond what can be simulated.
  photonvdb bias --figures figures/
      Every graph of the thesis the models come from, photons emitted as for a render, the calibrated divisor, a report on the
      thesis's claims, and every number drawn.";

/// `photonvdb bias`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct BiasArguments {
    /// Models by name, or `all`
    #[arg(value_name = "MODEL", required_unless_present = "figures")]
    pub models: Vec<String>,

    /// Photons [default: 1000, or as many as the largest k needs]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub n: Option<u64>,

    /// Which nearest photon defines the ball: numbers and ranges, separated by commas
    #[arg(long, value_name = "LIST", default_value = "2..200", value_parser = parse_k_list)]
    pub k: KList,

    /// Repetitions of each experiment
    #[arg(long, value_name = "T", default_value = "10000", value_parser = parse_count)]
    pub trials: u64,

    /// What the k nearest photons count as; `unbiased` removes a model's bias, `calibrated` is what a render would measure
    #[arg(long, value_name = "D", value_delimiter = ',', default_value = "all",
        value_parser = PossibleValuesParser::new(["all", "k", "k-1/2", "k-1", "unbiased", "calibrated"]))]
    pub divisor: Vec<String>,

    /// Seed of every random number: equal seeds give equal tables
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u64,

    /// How photons are drawn: `fast` draws only what the k asked for depend on, `direct` places all n
    #[arg(long, value_name = "METHOD", default_value = "fast",
        value_parser = PossibleValuesParser::new(["fast", "direct"]))]
    pub method: String,

    /// No experiments, exact values alone
    #[arg(long)]
    pub exact_only: bool,

    /// Files of the table
    #[command(flatten)]
    pub outputs: TableOutputs,

    /// Draws every graph of the thesis, and what lies beyond it, into a directory, with their numbers and a report
    #[arg(long, value_name = "DIR")]
    pub figures: Option<PathBuf>,

    /// Threads to use [default: one a core]; results do not depend on it
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
}
