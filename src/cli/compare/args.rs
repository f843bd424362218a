//! What can be typed after `photonvdb compare`.

use clap::Args;
use clap::builder::PossibleValuesParser;

use crate::cli::bias::k_list::{KList, parse_k_list};
use crate::cli::count::parse_count;
use crate::cli::table_outputs::TableOutputs;

const EXAMPLES: &str = "\
Scenes:
  analytic:point-absorbing   a point light of 1 W in an infinite medium, sigma_t = 1, that absorbs; queries 1 m from it
  analytic:point-scattering  the same with an albedo of 0.9, isotropic

Every run emits and traces n photons as a render does and asks their map at random places. Errors are told apart:
  intrinsic   k / u - 1, u the photons that the ball out to the k-th is expected to hold
  smoothing   mean power density in that ball over its value in the middle - 1
  total       what a render sees, both together

Examples:
  photonvdb compare analytic:point-absorbing
      A table of random, stratified and Sobol emission.
  photonvdb compare analytic:point-absorbing --k 10..200 --runs 100 --csv compare.csv --plot compare.svg
      More of everything.";

/// `photonvdb compare`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct CompareArguments {
    /// Scene whose power density is known: `analytic:NAME`
    pub scene: String,

    /// Photons of the estimate: numbers and ranges, separated by commas
    #[arg(long, value_name = "LIST", default_value = "5,10,20,50,100,200", value_parser = parse_k_list)]
    pub k: KList,

    /// Photons emitted a run
    #[arg(long, value_name = "PHOTONS", default_value = "1e6", value_parser = parse_photons)]
    pub n: u64,

    /// Independent photon maps of each way of emission
    #[arg(long, value_name = "R", default_value = "32", value_parser = parse_runs)]
    pub runs: u64,

    /// Queries a run
    #[arg(long, value_name = "Q", default_value = "1000", value_parser = parse_count)]
    pub queries: u64,

    /// Ways of emission
    #[arg(long, value_name = "E", value_delimiter = ',', default_value = "random,stratified,sobol",
        value_parser = PossibleValuesParser::new(["random", "stratified", "sobol"]))]
    pub emission: Vec<String>,

    /// Seed of every random number: equal seeds give equal tables
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u64,

    /// Files of the table
    #[command(flatten)]
    pub outputs: TableOutputs,

    /// Threads to use [default: one a core]; results do not depend on it
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
}

/// All collisions of a map are held at once, 44 bytes each, ten a photon where most light is scattered.
const MOST_PHOTONS: u64 = 20_000_000;

fn parse_photons(text: &str) -> Result<u64, String> {
    let count = parse_count(text)?;
    if count > MOST_PHOTONS {
        return Err(format!("more than {MOST_PHOTONS} photons a run; take more runs instead"));
    }
    Ok(count)
}

fn parse_runs(text: &str) -> Result<u64, String> {
    let count = parse_count(text)?;
    if count < 2 {
        return Err("standard errors come from several runs; take 2 or more, better 32".into());
    }
    Ok(count)
}
