//! Tables, JSON and charts to files, whole or not at all.

use std::fs;
use std::io::Write;
use std::path::Path;

use photonvdb::film::write_beside;
use serde::Serialize;

use super::error::CliError;
use super::report::is_stdout;
use super::{print_json, print_to_stdout};

/// Writes text to a file, or to stdout where the path is `-`.
pub fn write_text(path: &Path, text: &str) -> Result<(), CliError> {
    if is_stdout(path) {
        return print_to_stdout(text);
    }
    Ok(write_beside(path, |file: &mut fs::File| file.write_all(text.as_bytes()))?)
}

/// Writes a value as indented JSON to a file, or to stdout where the path is `-`.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), CliError> {
    if is_stdout(path) {
        return print_json(value);
    }
    let write = |file: &mut fs::File| {
        serde_json::to_writer_pretty(&mut *file, value)?;
        writeln!(file)
    };
    Ok(write_beside(path, write)?)
}
