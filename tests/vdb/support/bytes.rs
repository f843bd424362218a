//! The files tests read.

use std::path::{Path, PathBuf};

/// Where the committed files are.
pub fn directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vdb")
}

/// Files that are too many or not free to be committed, if there are any: the directories named in
/// `PHOTONVDB_VDB_CORPUS`, or those of `shared/vdb` beside the repository.
pub fn larger_corpora() -> Vec<PathBuf> {
    if let Some(named) = std::env::var_os("PHOTONVDB_VDB_CORPUS") {
        return std::env::split_paths(&named).filter(|path| path.is_dir()).collect();
    }
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/vdb");
    let directories = ["generated", "real"].map(|name| shared.join(name));
    let present: Vec<_> = directories.into_iter().filter(|path| path.is_dir()).collect();
    if present.is_empty() {
        println!("no larger corpus at {}: nothing more to check", shared.display());
    }
    present
}

/// The VDB files of a directory.
pub fn files(directory: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(directory).unwrap();
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "vdb"))
        .collect();
    files.sort();
    files
}

/// The bytes of a committed file, named without its ending.
pub fn committed(name: &str) -> Vec<u8> {
    std::fs::read(directory().join(name).with_extension("vdb")).unwrap()
}
