//! How a scene names a file: relative to itself where the two have a directory in common.

use std::path::{Component, Path, PathBuf};

use crate::cli::error::CliError;

/// The path of `file` as a scene in `directory` writes it, with slashes. Both must exist.
pub fn relative_to(directory: &Path, file: &Path) -> Result<String, CliError> {
    let directory = if directory == Path::new("") { Path::new(".") } else { directory };
    let full = |path: &Path| {
        path.canonicalize().map_err(|source| CliError::Read { path: path.into(), source })
    };
    let path = between(&full(directory)?, &full(file)?);
    let text = path.to_str().ok_or_else(|| CliError::UnwritablePath { path: file.into() })?;
    Ok(if cfg!(windows) { text.replace('\\', "/") } else { text.to_owned() })
}

/// From one absolute path to another; the other itself where they have only the root in common.
fn between(from: &Path, to: &Path) -> PathBuf {
    let is_name = |part: &Component| matches!(part, Component::Normal(_));
    let common = from.components().zip(to.components()).take_while(|(a, b)| a == b);
    let common: Vec<_> = common.map(|(part, _)| part).collect();
    if !common.iter().any(is_name) {
        return to.to_path_buf();
    }
    let up = from.components().skip(common.len()).map(|_| Component::ParentDir);
    up.chain(to.components().skip(common.len())).collect()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_from_the_scene() {
        for (from, to, path) in [
            ("/films/scenes", "/films/scenes/a.vdb", "a.vdb"),
            ("/films/scenes", "/films/media/a.vdb", "../media/a.vdb"),
            ("/films/scenes/deep", "/films/a b/c.vdb", "../../a b/c.vdb"),
            ("/films", "/home/a.vdb", "/home/a.vdb"),
        ] {
            assert_eq!(between(Path::new(from), Path::new(to)), Path::new(path));
        }
    }
}
