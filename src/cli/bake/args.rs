//! What can be typed after `photonvdb bake`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use photonvdb::render::BakeOptions;
use photonvdb::scene::Overrides;

use crate::cli::args::{SceneVolumeArguments, parse_passes};
use crate::cli::count::parse_count;
use crate::cli::file_names::vdb_name;

const EXAMPLES: &str = "\
Examples:
  photonvdb bake smoke.toml -o smoke_lit.vdb
      The smoke's density, the fluence in it, and its in-scattered light as emission.
  photonvdb bake smoke.toml -o smoke_lit.vdb --photons 1e6 --passes 16
      The mean of 16 independent passes.
  photonvdb bake fog.toml -o fog_lit.vdb --voxels 128
      A homogeneous medium, in 128 voxels along its longest side.

Grids, all on the tree of the density grid and in the scene's world: density, as in the file (of a homogeneous medium sigma_t in 1/m); fluence, RGB \
in W/m^2, of direct and scattered light; emission, RGB in W/(m^3 sr), which is sigma_s / (4 pi) times fluence: what the medium sends to every side \
of the light that falls on it, as though it scattered all ways alike. A renderer shows it as the emission of a volume that absorbs by sigma_t = \
density_scale times density and does not scatter; density_scale and albedo stand in the grid's metadata. Fire's own light is in the fluence that it \
causes, not in the emission.

Equal seeds give equal files, byte for byte, for any number of threads. Ctrl-C ends it after the pass in flight and writes what there is; a second one \
ends it at once.";

/// `photonvdb bake`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct BakeArguments {
    /// Scene file, .toml or .json
    pub scene: PathBuf,

    /// OpenVDB file to write: grids density, fluence and emission
    #[arg(short, long, value_name = "LIT.vdb", value_parser = vdb_name())]
    pub output: PathBuf,

    /// Photons emitted per pass [default: photons.count of the scene]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub photons: Option<u64>,

    /// Independent passes; fluence is their mean
    #[arg(long, value_name = "P", value_parser = parse_passes, default_value = "1")]
    pub passes: u32,

    /// How scattered light is gathered from photons: from their flights in a lattice, or from the k nearest; auto takes the k nearest if
    /// anything is said of k or divisor [default: render.gather of the scene]
    #[arg(long, value_name = "G", value_parser = PossibleValuesParser::new(["auto", "knn", "lattice"]))]
    pub gather: Option<String>,

    /// Photons of one estimate, with --gather knn [default: estimate.k of the scene]
    #[arg(long, value_name = "K", value_parser = parse_count)]
    pub k: Option<u64>,

    /// Cells of the lattice along its longest side [default: by the number of photons]
    #[arg(long, value_name = "CELLS", value_parser = parse_count)]
    pub lattice: Option<u64>,

    /// How photons are sampled at the lights [default: photons.emission of the scene]
    #[arg(long, value_name = "E", value_parser = PossibleValuesParser::new(["random", "stratified", "sobol"]))]
    pub emission: Option<String>,

    /// Directions looked at from each voxel towards each light that has extent; point, spot and parallel light is exact
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65536), default_value = "64")]
    pub light_samples: u32,

    /// Voxels along the longest side of a homogeneous medium
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096), default_value = "64")]
    pub voxels: u32,

    /// Number of the medium, from 0, where the scene has several: its voxels, and what it scatters of the light of all
    #[arg(long, value_name = "I", default_value = "0")]
    pub medium: u32,

    /// Seed of every random number [default: photons.seed of the scene]
    #[arg(long, value_name = "S")]
    pub seed: Option<u64>,

    /// Threads to use [default: one a core]; the file does not depend on it
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// Reading volumes
    #[command(flatten)]
    pub volume: SceneVolumeArguments,

    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

impl BakeArguments {
    /// What replaces values of the scene file.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            photons: self.photons,
            emission: self.emission.clone(),
            seed: self.seed,
            k: self.k,
            gather: self.gather.clone(),
            lattice: self.lattice,
            ..self.volume.overrides()
        }
    }

    /// How light is baked.
    pub fn options(&self) -> BakeOptions {
        BakeOptions {
            passes: self.passes,
            light_samples: self.light_samples as usize,
            medium: self.medium as usize,
            limits: self.volume.memory.limits(),
        }
    }
}
