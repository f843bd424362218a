//! What can be typed after `photonvdb compare`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;

use crate::cli::args::VolumeArguments;
use crate::cli::bias::k_list::{KList, parse_k_list};
use crate::cli::count::{parse_count, parse_resolution};
use crate::cli::table_outputs::TableOutputs;

const EXAMPLES: &str = "\
Scenes whose power density is known, all with sigma_t = 1:
  analytic:point-absorbing   a point light of 1 W in an infinite medium that absorbs; queries 1 m from it
  analytic:point-scattering  the same with an albedo of 0.9, isotropic
  analytic:uniform-ball      a white furnace: a ball of radius 1 m, albedo 1, radiance 1 all around; queries anywhere
  analytic:uniform-box       the same with a cube of edges of 2 m; queries anywhere, up to the corners
  analytic:beam              parallel light of 1 W/m^2 on a box that absorbs; queries 1 m deep

Every run emits and traces n photons as a render does and asks their map at random places. Errors are told apart:
  intrinsic   power of the k nearest photons / power that their ball is expected to hold - 1: k / u - 1
  smoothing   mean power density in that ball over its value in the middle - 1
  total       what a render sees, both together

In a SCENE the places are those of photons, the same for all runs; the power expected in a ball is the mean of all other
maps, and the density at a place is that of the smallest ball whose power is known to 7 %. Besides, images are rendered with
the scene's own k and divisor and held against --reference, or against the mean of renders with --reference-photons. Light
scattered once is not in the map of a scene unless it says so, or --photons-only does.

Examples:
  photonvdb compare analytic:point-absorbing
      A table of random, stratified and Sobol emission.
  photonvdb compare analytic:beam --k 10..200 --runs 100 --csv compare.csv --plot compare.svg
      More of everything.
  photonvdb compare fog.toml --n 1e5 --photons-only
      What stratified photons gain in a scene: at points, and in its pixels.
  photonvdb compare fog.toml --pixels 64x36 --reference truth.exr --csv - --timing
      Against a known image of 64 x 36 pixels, or a multiple of it.";

/// `photonvdb compare`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct CompareArguments {
    /// Scene file (.toml or .json), or one whose power density is known: `analytic:NAME`
    pub scene: String,

    /// Photons of the estimate at points: numbers and ranges, separated by commas
    #[arg(long, value_name = "LIST", default_value = "5,10,20,50,100,200", value_parser = parse_k_list)]
    pub k: KList,

    /// Photons emitted a run [default: 1e6; in a scene file, 1e5]
    #[arg(long, value_name = "PHOTONS", value_parser = parse_photons)]
    pub n: Option<u64>,

    /// Independent photon maps, and images, of each way of emission
    #[arg(long, value_name = "R", default_value = "32", value_parser = parse_runs)]
    pub runs: u64,

    /// Queries a run; in a scene file, places
    #[arg(long, value_name = "Q", default_value = "1000", value_parser = parse_count)]
    pub queries: u64,

    /// Ways of emission
    #[arg(long, value_name = "E", value_delimiter = ',', default_value = "random,stratified,sobol",
        value_parser = PossibleValuesParser::new(["random", "stratified", "sobol"]))]
    pub emission: Vec<String>,

    /// Seed of every random number: equal seeds give equal tables
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u64,

    /// Pixels of the images of a scene, whatever their shape: the picture stays [default: 32 wide, or the reference's size
    /// over a whole number]
    #[arg(long, value_name = "WxH", value_parser = parse_resolution)]
    pub pixels: Option<[u64; 2]>,

    /// Image to hold those of a scene against: as many pixels, or a multiple, which is averaged
    #[arg(long, value_name = "REF.exr")]
    pub reference: Option<PathBuf>,

    /// Photons of each render of the reference, where none is given: a fourth as many as runs [default: 8 times n]
    #[arg(long, value_name = "PHOTONS", value_parser = parse_photons, conflicts_with = "reference")]
    pub reference_photons: Option<u64>,

    /// Take single scattering of a scene from photons, too, instead of sampling it towards the lights
    #[arg(long)]
    pub photons_only: bool,

    /// Reading volumes
    #[command(flatten)]
    pub volume: VolumeArguments,

    /// Files of the table
    #[command(flatten)]
    pub outputs: TableOutputs,

    /// Threads to use [default: one a core]; results do not depend on it
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
}

impl CompareArguments {
    /// The first flag given that only scene files know.
    pub fn scene_flag(&self) -> Option<&'static str> {
        let flags = [
            ("--pixels", self.pixels.is_some()),
            ("--reference", self.reference.is_some()),
            ("--reference-photons", self.reference_photons.is_some()),
            ("--photons-only", self.photons_only),
            ("--max-volume-memory", self.volume.max_volume_memory.is_some()),
        ];
        flags.into_iter().find_map(|(name, is_given)| is_given.then_some(name))
    }
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
