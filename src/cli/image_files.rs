//! An image and its preview to files.

use std::env;
use std::path::Path;

use photonvdb::film::{ExrOptions, Film, FilmError, RenderMetadata, write_exr, write_preview_png};

use super::error::CliError;

/// Writes an image and, where one is asked for, its preview. Work that has no room where it was to go is not thrown away: it
/// is kept among temporary files, and the error tells where.
pub fn write_images(
    [exr, preview]: [Option<&Path>; 2],
    film: &Film,
    options: &ExrOptions,
    metadata: &RenderMetadata,
) -> Result<(), CliError> {
    let write = |path: &Path| write_exr(path, film, options, metadata);
    let written = exr.map_or(Ok(()), |path| write(path).map_err(|error| kept(error, path, write)));
    let previewed = preview.map_or(Ok(()), |path| write_preview_png(path, film, None));
    written.and(previewed.map_err(CliError::from))
}

/// The error, or, where the image could be written elsewhere, the same with that place.
fn kept(
    source: FilmError,
    path: &Path,
    write: impl Fn(&Path) -> Result<(), FilmError>,
) -> CliError {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let kept = env::temp_dir().join(format!("photonvdb-{}-{name}", std::process::id()));
    match write(&kept) {
        Ok(()) => CliError::Kept { source, kept },
        Err(_) => source.into(),
    }
}
