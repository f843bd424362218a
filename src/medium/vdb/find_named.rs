//! Choosing grids that a scene names outright: there is no guessing as for densities.

use super::VolumeSource;
use super::error::VdbError;
use super::find::find_grid;
use super::summary::GridSummary;

/// The grid of numbers of that name, whatever its class.
///
/// A name that several grids have means the first of them; `name[1]` is the second.
///
/// # Errors
/// When there is no such grid, naming those there are; when it cannot be used or is not of numbers.
pub fn find_scalar(source: &dyn VolumeSource, name: &str) -> Result<usize, VdbError> {
    find(source, name, "numbers", GridSummary::is_usable_scalar)
}

/// The grid of three-component vectors (vec3s or vec3d) of that name.
///
/// A name that several grids have means the first of them; `name[1]` is the second.
///
/// # Errors
/// When there is no such grid, naming those there are; when it cannot be used or is not of vectors.
pub fn find_vector(source: &dyn VolumeSource, name: &str) -> Result<usize, VdbError> {
    find(source, name, "vectors (vec3s or vec3d)", |grid| {
        matches!(grid.value_type.as_str(), "vec3s" | "vec3d")
    })
}

fn find(
    source: &dyn VolumeSource,
    name: &str,
    wanted: &'static str,
    fits: impl Fn(&GridSummary) -> bool,
) -> Result<usize, VdbError> {
    let index = find_grid(source, name)?;
    let grid = &source.grids()[index];
    let file = || source.name().to_owned();
    let name = || grid.unique_name.clone();
    if let Some(reason) = &grid.unusable {
        return Err(VdbError::Unusable { file: file(), grid: name(), reason: reason.clone() });
    }
    if !fits(grid) {
        let value_type = grid.value_type.clone();
        return Err(VdbError::WrongType { file: file(), grid: name(), value_type, wanted });
    }
    Ok(index)
}
