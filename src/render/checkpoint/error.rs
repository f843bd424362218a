//! Why a render cannot go on from a checkpoint.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

/// A checkpoint cannot be read, or is one of another render.
#[derive(Debug, Error)]
pub enum CheckpointError {
    /// The file cannot be opened or its bytes cannot be read.
    #[error("cannot read the checkpoint {path}: {source}", path = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file of another kind.
    #[error("{path} is not a checkpoint of photonvdb; render without --resume", path = path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// A checkpoint that is cut off or whose bytes have changed.
    #[error("the checkpoint {path} is damaged: {reason}; render without --resume", path = path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        reason: String,
    },
    /// Written by another version of the program, whose passes may differ.
    #[error(
        "the checkpoint {path} was written by photonvdb {found} and this is {own}; go on with that version, or render without --resume",
        path = path.display()
    )]
    OtherVersion {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: String,
        /// The version that runs.
        own: &'static str,
    },
    /// A setting that the image depends on is another.
    #[error(
        "the checkpoint {path} was made with {name} = {found} and this render has {asked}; give the same, or render without --resume",
        path = path.display()
    )]
    OtherSetting {
        /// The file.
        path: PathBuf,
        /// Name of the setting, as in a scene file.
        name: String,
        /// Its value in the checkpoint.
        found: String,
        /// Its value now.
        asked: String,
    },
    /// Another scene, or a file that it names has other content.
    #[error(
        "the checkpoint {path} is of another scene, or the scene or a file it names has changed since (scene hash {found}, now {asked}); restore the scene, or render without --resume",
        path = path.display()
    )]
    OtherScene {
        /// The file.
        path: PathBuf,
        /// Hash of its scene.
        found: String,
        /// Hash of the scene now.
        asked: String,
    },
    /// More passes than asked for: they cannot be taken off the mean.
    #[error(
        "the checkpoint {path} holds {found} passes and {asked} are asked for; ask for --passes {found} or more, or render without --resume",
        path = path.display()
    )]
    TooManyPasses {
        /// The file.
        path: PathBuf,
        /// Its passes.
        found: u32,
        /// Passes asked for.
        asked: u32,
    },
}
