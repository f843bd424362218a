//! Choosing the grid a scene means.

use super::VolumeSource;
use super::error::VdbError;
use super::summary::GridSummary;

/// Grids named in a message before it breaks off.
const NAMED_IN_MESSAGE: usize = 12;

/// The grid of densities a scene names. If no grid has that `name` and the user did not type it
/// (`explicit` is false), the file's only float grid serves.
///
/// A name that several grids have means the first of them; `name[1]` is the second.
///
/// # Errors
/// When there is no such grid, naming those there are; when it cannot be used, is not of numbers,
/// or is a level set.
pub fn find_density(
    source: &dyn VolumeSource,
    name: &str,
    explicit: bool,
) -> Result<usize, VdbError> {
    let grids = source.grids();
    let named = position_named(grids, name);
    let found = match named {
        None if !explicit => only_float(grids),
        named => named,
    };
    let index = found.ok_or_else(|| VdbError::NoSuchGrid {
        file: source.name().to_owned(),
        grid: name.to_owned(),
        present: present(grids),
    })?;
    check_density(source, &grids[index])?;
    Ok(index)
}

/// The first grid of that name, plain or unique.
pub(super) fn position_named(grids: &[GridSummary], name: &str) -> Option<usize> {
    grids
        .iter()
        .position(|grid| grid.name == name)
        .or_else(|| grids.iter().position(|grid| grid.unique_name == name))
}

fn check_density(source: &dyn VolumeSource, grid: &GridSummary) -> Result<(), VdbError> {
    let file = source.name().to_owned();
    let name = grid.unique_name.clone();
    if let Some(reason) = &grid.unusable {
        return Err(VdbError::Unusable { file, grid: name, reason: reason.clone() });
    }
    if !grid.is_usable_scalar() {
        return Err(VdbError::WrongType {
            file,
            grid: name,
            value_type: grid.value_type.clone(),
            wanted: "numbers",
        });
    }
    if grid.is_level_set() {
        return Err(VdbError::LevelSet { file, grid: name });
    }
    Ok(())
}

/// The only grid of real numbers that could be a density, if there is exactly one.
fn only_float(grids: &[GridSummary]) -> Option<usize> {
    let is_real = |grid: &GridSummary| matches!(grid.value_type.as_str(), "float" | "double");
    let mut candidates = (0..grids.len()).filter(|&index| {
        let grid = &grids[index];
        is_real(grid) && grid.unusable.is_none() && !grid.is_level_set()
    });
    let only = candidates.next()?;
    candidates.next().is_none().then_some(only)
}

/// The grids of a file, in words.
pub(super) fn present(grids: &[GridSummary]) -> String {
    if grids.is_empty() {
        return "it holds no grids at all".into();
    }
    let mut words: Vec<String> = grids
        .iter()
        .take(NAMED_IN_MESSAGE)
        .map(|grid| {
            let class = if grid.is_level_set() { ", level set" } else { "" };
            format!("\"{}\" ({}{class})", grid.unique_name, grid.value_type)
        })
        .collect();
    if grids.len() > NAMED_IN_MESSAGE {
        words.push(format!("and {} more", grids.len() - NAMED_IN_MESSAGE));
    }
    format!("name one it holds: {}", words.join(", "))
}
