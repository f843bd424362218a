//! Why a command could not be carried out, as one sentence.

use std::io;
use std::path::PathBuf;

use photonvdb::files::WriteFailure;
use photonvdb::film::FilmError;
use photonvdb::lab::{LabError, SceneComparisonError, SweepError};
use photonvdb::medium::vdb::{CropError, VdbError, VdbWriteError};
use photonvdb::reference::ReferenceError;
use photonvdb::render::{CheckpointError, RenderError};
use photonvdb::scene::SceneError;
use photonvdb::validate::ValidateError;
use thiserror::Error;

/// Bad input or usage, as clap's own errors.
const BAD_INPUT: u8 = 2;

/// A check asked for did not hold.
const CHECK_FAILED: u8 = 1;

/// Why a command could not be carried out.
#[derive(Debug, Error)]
pub enum CliError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Film(#[from] FilmError),
    #[error(transparent)]
    Vdb(#[from] VdbError),
    #[error(transparent)]
    VdbWrite(#[from] VdbWriteError),
    #[error(transparent)]
    Write(#[from] WriteFailure),
    #[error("grid \"{grid}\" of {path} cannot be cropped so: {source}", path = path.display())]
    Crop { path: PathBuf, grid: String, source: CropError },
    #[error("{path} has no grid that can be converted", path = path.display())]
    NothingToConvert { path: PathBuf },
    #[error("--rename is for one grid and {count} are written; choose one with --grid")]
    RenameMany { count: usize },
    #[error(transparent)]
    Render(#[from] RenderError),
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    #[error(transparent)]
    Lab(#[from] LabError),
    #[error(transparent)]
    Validate(#[from] ValidateError),
    #[error("{failed} of {count} checks failed")]
    ValidationFailed { failed: usize, count: usize },
    #[error(
        "there is no model {name:?}; did you mean {nearest}? `photonvdb bias --help` lists all"
    )]
    UnknownModel { name: String, nearest: &'static str },
    #[error(
        "there is nothing to compare in {name:?}; known are scene files, .toml or .json, and {known}"
    )]
    UnknownComparison { name: String, known: String },
    #[error(
        "{flag} is for scene files: analytic scenes have no images, and all light from photons"
    )]
    OnlyForSceneFiles { flag: &'static str },
    #[error("{path}: {source}", path = path.display())]
    SceneComparison { path: PathBuf, source: Box<SceneComparisonError> },
    #[error("{path}: {source}", path = path.display())]
    Sweep { path: PathBuf, source: Box<SweepError> },
    #[error("these lists span more than {limit} settings; name fewer values")]
    TooManySettings { limit: u128 },
    #[error("there is no setting to measure; name values for --gather, --target-error or --spp")]
    NothingToSweep,
    #[error("cannot make the directory {path}: {source}", path = path.display())]
    Directory { path: PathBuf, source: io::Error },
    #[error("cannot read {path}: {source}", path = path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error("cannot start {threads} threads: {source}")]
    Threads { threads: u32, source: rayon::ThreadPoolBuildError },
    #[error("cannot catch Ctrl-C: {0}")]
    Interrupt(#[from] ctrlc::Error),
    #[error("cannot write to stdout: {0}")]
    Stdout(io::Error),
    #[error("{path} is there already; give another name, or --force to replace it", path = path.display())]
    Exists { path: PathBuf },
    #[error(
        "{flag} would be written in place of {other}: both are {path}; give another name",
        path = path.display()
    )]
    TakesPlace { flag: &'static str, other: String, path: PathBuf },
    #[error("{source}; the image is kept in {kept}", kept = kept.display())]
    Kept { source: FilmError, kept: PathBuf },
    #[error("give a volume to start from, --from FILE.vdb, or --preset NAME")]
    NothingToStartFrom,
    #[error("grid \"{grid}\" of {path} cannot be used: {reason}", path = path.display())]
    UnusableGrid { grid: String, path: PathBuf, reason: String },
    #[error(
        "{path} has no grid of numbers that could be densities; `photonvdb inspect {path}` lists its grids",
        path = path.display()
    )]
    NoDensity { path: PathBuf },
    #[error("{path} cannot be named in a scene: its name is not Unicode", path = path.display())]
    UnwritablePath { path: PathBuf },
}

impl CliError {
    /// What the process ends with: 1 where a check asked for did not hold, else 2.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::ValidationFailed { .. } => CHECK_FAILED,
            _ => BAD_INPUT,
        }
    }
}
