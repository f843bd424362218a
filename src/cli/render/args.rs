//! What can be typed after `photonvdb render`.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use photonvdb::film::ExrOptions;
use photonvdb::render::{CostlyLayers, Gather, RenderOptions};
use photonvdb::scene::{Overrides, Scene};

use crate::cli::args::{SceneVolumeArguments, parse_passes};
use crate::cli::count::{parse_count, parse_positive, parse_resolution};
use crate::cli::file_names::{exr_name, png_name};

const EXAMPLES: &str = "\
Examples:
  photonvdb render fog.toml -o fog.exr --resolution 320x180 --photons 1e5
      A quick draft.
  photonvdb render fog.toml -o fog.exr --resolution 160x90 --photons 1e5 --show
      A look at it in the terminal.
  photonvdb render fog.toml -o fog.exr --target-error 0.02
      As many passes as it takes to be within 2 %, noise and bias; --time-budget 60 for the best of a minute.
  photonvdb render smoke.toml -o smoke.exr --holdout --half --layers depth,lights
      For compositing: no background, depths, and a layer a light.
  photonvdb render fog.toml -o fog.exr --passes 1000 --checkpoint fog.ckpt
      Kept after every pass; once it was killed, the same with --resume fog.ckpt goes on to the same image.
  photonvdb render fog.toml -o fog.exr --gather knn --k 100 --divisor calibrated
      From the photon map: the 100 nearest photons of each point.
  photonvdb render fog.toml -o fog.exr --reference truth.exr --report fog.json
      How long it took, how much memory, and how far it is from a reference.
  photonvdb render fog.toml -o fog.exr --report - --quiet | jq .seconds
      The report alone, on stdout.

Ctrl-C ends the render after the pass in flight and writes what there is; a second one ends it at once.";

/// `photonvdb render`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct RenderArguments {
    /// Scene file, .toml or .json
    pub scene: PathBuf,

    /// Image to write: linear OpenEXR with all layers
    #[arg(short, long, value_name = "OUT.exr", value_parser = exr_name())]
    pub output: PathBuf,

    /// Photons emitted per pass [default: photons.count of the scene]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub photons: Option<u64>,

    /// Independent passes; the image is their mean [default: 1, 4 with --gather bounce, or as
    /// many as the limits below allow]
    #[arg(long, value_name = "P", value_parser = parse_passes)]
    pub passes: Option<u32>,

    /// Relative error to reach, like 0.05: passes go on until the image's estimated noise and bias are below, root mean square over
    /// its mean
    #[arg(long, value_name = "REL", value_parser = parse_positive)]
    pub target_error: Option<f64>,

    /// Wall-clock time to stay within; the first pass is always made
    #[arg(long, value_name = "SECONDS", value_parser = parse_positive)]
    pub time_budget: Option<f64>,

    /// Photons of one estimate: more are smoother, fewer are sharper [default: estimate.k of the scene]
    #[arg(long, value_name = "K", value_parser = parse_count)]
    pub k: Option<u64>,

    /// What the k nearest photons count as; `calibrated` measures what leaves no bias [default: estimate.divisor of the scene]
    #[arg(long, value_name = "D", value_parser = PossibleValuesParser::new(["k", "k-1", "k-1/2", "calibrated"]))]
    pub divisor: Option<String>,

    /// How photons are sampled at the lights [default: photons.emission of the scene]
    #[arg(long, value_name = "E", value_parser = PossibleValuesParser::new(["random", "stratified", "sobol"]))]
    pub emission: Option<String>,

    /// How light scattered twice or more is gathered from photons: from the k nearest, from their flights in a lattice, or by
    /// paths that bounce a few times and end in the lattice; auto bounces where light scatters many times, else takes the lattice [default: render.gather of the scene, else knn if anything is said of k or divisor, else auto]
    #[arg(long, value_name = "G", value_parser = PossibleValuesParser::new(["auto", "knn", "lattice", "bounce"]))]
    pub gather: Option<String>,

    /// Cells of the lattice along its longest side [default: by the number of photons]
    #[arg(long, value_name = "CELLS", value_parser = parse_count)]
    pub lattice: Option<u64>,

    /// Collisions of a path before it ends in the lattice, with --gather bounce [default: render.bounces of the scene, 8]
    #[arg(long, value_name = "J", value_parser = parse_count)]
    pub bounces: Option<u64>,

    /// Whether multiple scattering is smoothed from pixel to pixel, as far as the noise taken away exceeds the measured bias;
    /// auto smooths with --target-error, --time-budget or --gather bounce [default: render.filter of the scene]
    #[arg(long, value_name = "F", value_parser = PossibleValuesParser::new(["auto", "on", "off"]))]
    pub filter: Option<String>,

    /// Rays a pixel and pass [default: render.samples_per_pixel of the scene]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub samples: Option<u64>,

    /// Seed of every random number: equal seeds give equal images [default: photons.seed of the scene]
    #[arg(long, value_name = "S")]
    pub seed: Option<u64>,

    /// Threads to use [default: one a core]; the image does not depend on it
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// Image size in pixels [default: camera.resolution of the scene]
    #[arg(long, value_name = "WxH", value_parser = parse_resolution)]
    pub resolution: Option<[u64; 2]>,

    /// Leave out of the image what the camera sees of environments, which still light the medium: over any background the image is
    /// then composited by its alpha [default: render.background of the scene]
    #[arg(long)]
    pub holdout: bool,

    /// Write colours and alpha as 16-bit floats; depths, variance and counts stay in 32 bits
    #[arg(long)]
    pub half: bool,

    /// More layers to write, separated by commas
    #[arg(long, value_name = "LAYERS", value_delimiter = ',')]
    pub layers: Vec<ExtraLayer>,

    /// Take single scattering from photons, too, instead of sampling it towards the lights
    #[arg(long)]
    pub photons_only: bool,

    /// File to keep the render's state in, written after every pass: a render that is killed goes on from there with --resume
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,

    /// Checkpoint to go on from, of the same scene and settings, to the same image as without a break; may be the file of
    /// --checkpoint. With more --passes, or another --target-error, passes are added. A --time-budget counts the time already
    /// spent
    #[arg(long, value_name = "FILE")]
    pub resume: Option<PathBuf>,

    /// Image to compare with, of the same size; the figures go to stderr and to the report
    #[arg(long, value_name = "REF.exr")]
    pub reference: Option<PathBuf>,

    /// Settings, times, photons, power and memory as JSON; `-` is stdout
    #[arg(long, value_name = "OUT.json")]
    pub report: Option<PathBuf>,

    /// Tone-mapped picture for a quick look
    #[arg(long, value_name = "OUT.png", value_parser = png_name())]
    pub preview: Option<PathBuf>,

    /// Show the picture in the terminal, small, in half blocks: after passes, and when it is done
    #[arg(long)]
    pub show: bool,

    /// Reading volumes
    #[command(flatten)]
    pub volume: SceneVolumeArguments,

    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// Layers written on request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum ExtraLayer {
    /// Mean number of photons found a query
    PhotonCount,
    /// Mean kernel radius of the queries, or edge of the lattice's cells
    KernelRadius,
    /// Square of the radiance's standard error, from how passes differ, and the number of rays
    Variance,
    /// Alpha a channel, as AR, AG and AB
    Alpha,
    /// Z, the distance from the camera at which half of the light is lost, and scatter.Z, the mean one of the first scattering;
    /// infinite where there is none
    Depth,
    /// light.NAME or light.NUMBER: the image of each light alone, by single and multiple scattering and seen directly; light.medium
    /// of a fire. Each is gathered by itself: up to as long a light as for all
    Lights,
}

impl RenderArguments {
    /// What replaces values of the scene file.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            photons: self.photons,
            emission: self.emission.clone(),
            seed: self.seed,
            k: self.k,
            divisor: self.divisor.clone(),
            resolution: self.resolution,
            gather: self.gather.clone(),
            lattice: self.lattice,
            bounces: self.bounces,
            filter: self.filter.clone(),
            samples_per_pixel: self.samples,
            photons_only: self.photons_only.then_some(true),
            background: self.holdout.then(|| "holdout".to_string()),
            ..self.volume.overrides()
        }
    }

    /// Flags given that change nothing in this scene, and what they are for.
    pub fn idle_flags(
        &self,
        scene: &Scene,
        options: &RenderOptions,
    ) -> Vec<(&'static str, &'static str)> {
        let gather = scene.render.gather;
        let has = |layer| self.layers.contains(&layer);
        let is_knn = gather == Gather::Knn;
        let flags = [
            ("--k", "--gather knn", self.k.is_some() && !is_knn),
            ("--divisor", "--gather knn", self.divisor.is_some() && !is_knn),
            ("--layers photon_count", "--gather knn", has(ExtraLayer::PhotonCount) && !is_knn),
            ("--lattice", "--gather lattice", self.lattice.is_some() && is_knn),
            ("--bounces", "--gather bounce", self.bounces.is_some() && gather != Gather::Bounce),
            (
                "--layers variance",
                "two --passes or more",
                has(ExtraLayer::Variance) && options.passes == 1,
            ),
        ];
        let idle = flags.into_iter().filter(|(.., is_idle)| *is_idle);
        idle.map(|(flag, purpose, _)| (flag, purpose)).collect()
    }

    /// When the render ends.
    pub fn options(&self, scene: &Scene) -> RenderOptions {
        let layers = CostlyLayers {
            depths: self.layers.contains(&ExtraLayer::Depth),
            lights: self.layers.contains(&ExtraLayer::Lights),
        };
        let Self { passes, target_error, time_budget, .. } = *self;
        RenderOptions {
            layers,
            ..RenderOptions::for_scene(scene, passes, target_error, time_budget)
        }
    }

    /// What the image's file holds.
    pub fn exr_options(&self) -> ExrOptions {
        ExrOptions {
            photon_count: self.layers.contains(&ExtraLayer::PhotonCount),
            kernel_radius: self.layers.contains(&ExtraLayer::KernelRadius),
            variance: self.layers.contains(&ExtraLayer::Variance),
            alpha: self.layers.contains(&ExtraLayer::Alpha),
            half: self.half,
        }
    }
}
