//! What can be wrong with a scene, each as one sentence that names the file, the line where known, and the key.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::tree::{Node, Origin};

/// Why a scene could not be loaded.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The scene file could not be read.
    #[error("{}: cannot read the scene: {source}", .file.display())]
    Read {
        /// The scene file.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The scene file is far too large for a scene.
    #[error("{}: not a scene: larger than {limit_mib} MiB", .file.display())]
    TooLarge {
        /// The scene file.
        file: PathBuf,
        /// What a scene file may hold \[MiB\].
        limit_mib: u64,
    },
    /// Neither TOML nor JSON by its name.
    #[error("{}: the name of a scene file ends in .toml or .json{}", .file.display(), volume_note(.file))]
    Extension {
        /// The scene file.
        file: PathBuf,
    },
    /// Not well-formed TOML or JSON.
    #[error("{}:{line}: {problem}", .file.display())]
    Syntax {
        /// The scene file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What the parser met.
        problem: String,
    },
    /// A key is unknown, missing, or has a value that no scene can have.
    #[error("{}{}: {key}{}: {problem}", .file.display(), line_suffix(*.origin), override_note(*.origin))]
    Invalid {
        /// The scene file.
        file: PathBuf,
        /// Where the value was written.
        origin: Origin,
        /// Path of the key, such as `light[2].intensity`.
        key: String,
        /// What is wrong, and what to do.
        problem: String,
    },
}

/// What to do with a volume that was given for a scene.
fn volume_note(file: &Path) -> String {
    let is_volume = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("vdb"));
    let name = file.display();
    let note = || format!("; make one around this volume: photonvdb new SCENE.toml --from {name}");
    if is_volume { note() } else { String::new() }
}

fn line_suffix(origin: Origin) -> String {
    match origin {
        Origin::Line(line) => format!(":{line}"),
        Origin::File | Origin::Override => String::new(),
    }
}

fn override_note(origin: Origin) -> &'static str {
    if origin == Origin::Override { " (overridden)" } else { "" }
}

/// A problem with the key at a path, before the file is known.
#[derive(Debug)]
pub(super) struct Problem {
    pub key: String,
    pub text: String,
}

impl Problem {
    pub fn new(key: impl Into<String>, text: impl Into<String>) -> Self {
        Self { key: key.into(), text: text.into() }
    }

    /// The same problem with the file and the line it is in.
    pub fn locate(self, file: &Path, tree: &Node) -> SceneError {
        let origin = tree.origin_of(&self.key);
        SceneError::Invalid { file: file.into(), origin, key: self.key, problem: self.text }
    }
}
