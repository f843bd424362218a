//! Bytes of the committed files.

use std::path::{Path, PathBuf};

/// Where the committed files are.
pub fn directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vdb")
}

/// The bytes of a committed file, named without its ending.
pub fn committed(name: &str) -> Vec<u8> {
    std::fs::read(directory().join(name).with_extension("vdb")).unwrap()
}
