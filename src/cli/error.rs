//! Why a command could not be carried out, as one sentence.

use std::io;
use std::path::PathBuf;

use photonvdb::film::FilmError;
use photonvdb::lab::LabError;
use photonvdb::medium::vdb::VdbError;
use photonvdb::render::RenderError;
use photonvdb::scene::SceneError;
use thiserror::Error;

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
    Render(#[from] RenderError),
    #[error(transparent)]
    Lab(#[from] LabError),
    #[error(
        "there is no model {name:?}; did you mean {nearest}? `photonvdb bias --help` lists all"
    )]
    UnknownModel { name: String, nearest: &'static str },
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
}
