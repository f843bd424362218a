//! Writing the film's files, complete or not at all.

use std::fs::File;
use std::io;
use std::path::Path;

use super::FilmError;
use crate::files::{self, WriteFailure};

/// As [`files::write_beside`], for what fails as input and output do.
///
/// # Errors
/// [`FilmError::Write`] with `path` and the cause.
pub fn write_beside(
    path: &Path,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<(), FilmError> {
    let failure = |source| WriteFailure { path: path.to_path_buf(), source };
    Ok(files::write_beside(path, |file| write(file).map_err(failure))?)
}

/// As [`files::check_writable`].
///
/// # Errors
/// [`FilmError::Write`] with `path` and the cause.
pub fn check_writable(path: &Path) -> Result<(), FilmError> {
    Ok(files::check_writable(path)?)
}
