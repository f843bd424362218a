//! Files to be written, looked at before any work: whether they can be, and that none takes the place of another, or of a file
//! that is read.

use std::fs;
use std::path::{Path, PathBuf};

use photonvdb::files::check_writable;
use photonvdb::scene::{Overrides, SceneFile};

use super::error::CliError;
use super::report::is_stdout;

/// A flag and the file it names, if it is given.
type Named<'a> = (&'static str, Option<&'a Path>);

/// Fails early where an output cannot be written, or would take the place of an input or of another output. Of the inputs those that
/// the scene at `scene` names are looked at, too.
pub fn check(outputs: &[Named], scene: &Path, inputs: &[Named]) -> Result<(), CliError> {
    let mut taken: Vec<(String, PathBuf)> = Vec::new();
    let named = inputs
        .iter()
        .filter_map(|(flag, path)| Some(((*flag).to_owned(), path.as_ref()?.to_path_buf())));
    for (what, path) in named.chain(files_of(scene)) {
        taken.extend(identity(&path).map(|identity| (what, identity)));
    }
    let given = outputs.iter().filter_map(|(flag, path)| Some((*flag, (*path)?)));
    for (flag, path) in given.filter(|(_, path)| !is_stdout(path)) {
        check_writable(path)?;
        let Some(identity) = identity(path) else { continue };
        if let Some((other, _)) = taken.iter().find(|(_, taken)| *taken == identity) {
            let (other, path) = (other.clone(), path.to_path_buf());
            return Err(CliError::TakesPlace { flag, other, path });
        }
        taken.push((flag.to_owned(), identity));
    }
    Ok(())
}

/// The scene file and those it names. One that cannot be read is left to whoever loads it.
fn files_of(scene: &Path) -> Vec<(String, PathBuf)> {
    let directory = scene.parent().unwrap_or(Path::new(""));
    let named = SceneFile::load(scene, &Overrides::default()).map(|file| file.files(directory));
    let itself = ("the scene".to_owned(), scene.to_path_buf());
    [itself].into_iter().chain(named.unwrap_or_default()).collect()
}

/// One name for a file, whichever way it is written; `None` of what is no file, and may be written to as often as one likes.
fn identity(path: &Path) -> Option<PathBuf> {
    if let Ok(found) = fs::metadata(path) {
        return if found.is_file() { fs::canonicalize(path).ok() } else { None };
    }
    let directory = match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    Some(fs::canonicalize(directory).ok()?.join(path.file_name()?))
}
