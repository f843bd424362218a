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
    let is_density = |grid: &GridSummary| is_real(grid) && !grid.is_level_set();
    let index = find_scalar(source, name, explicit, is_density)?;
    let grid = &source.grids()[index];
    if grid.is_level_set() {
        let (file, grid) = (source.name().to_owned(), grid.unique_name.clone());
        return Err(VdbError::LevelSet { file, grid });
    }
    Ok(index)
}

/// As [`find_density`], but a level set will do, for [`fog_of_level_set`](super::fog_of_level_set).
///
/// # Errors
/// As [`find_density`], level sets excepted.
pub fn find_density_or_level_set(
    source: &dyn VolumeSource,
    name: &str,
    explicit: bool,
) -> Result<usize, VdbError> {
    find_scalar(source, name, explicit, is_real)
}

/// The grid of that name, or else the only one that could be meant.
fn find_scalar(
    source: &dyn VolumeSource,
    name: &str,
    explicit: bool,
    could_be_meant: impl Fn(&GridSummary) -> bool,
) -> Result<usize, VdbError> {
    let grids = source.grids();
    let index = match find_grid(source, name) {
        Err(error) if !explicit => only(grids, could_be_meant).ok_or(error)?,
        named => named?,
    };
    check_scalar(source, &grids[index])?;
    Ok(index)
}

/// The grid of that `name`, whatever it holds. A name that several grids have means the first of
/// them; `name[1]` is the second.
///
/// # Errors
/// When there is no such grid, naming those there are.
pub fn find_grid(source: &dyn VolumeSource, name: &str) -> Result<usize, VdbError> {
    let grids = source.grids();
    let named = grids.iter().position(|grid| grid.name == name);
    let found = named.or_else(|| grids.iter().position(|grid| grid.unique_name == name));
    found.ok_or_else(|| VdbError::NoSuchGrid {
        file: source.name().to_owned(),
        grid: name.to_owned(),
        present: present(grids),
    })
}

fn check_scalar(source: &dyn VolumeSource, grid: &GridSummary) -> Result<(), VdbError> {
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
    Ok(())
}

/// Whether a grid holds real numbers and can be loaded.
fn is_real(grid: &GridSummary) -> bool {
    matches!(grid.value_type.as_str(), "float" | "double") && grid.unusable.is_none()
}

/// The only grid that passes, if there is exactly one.
fn only(grids: &[GridSummary], passes: impl Fn(&GridSummary) -> bool) -> Option<usize> {
    let mut candidates = (0..grids.len()).filter(|&index| passes(&grids[index]));
    let only = candidates.next()?;
    candidates.next().is_none().then_some(only)
}

/// The grids of a file, in words.
fn present(grids: &[GridSummary]) -> String {
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
    let fill = if grids.iter().any(GridSummary::is_level_set) {
        "; --sdf-to-fog fills a level set with fog"
    } else {
        ""
    };
    format!("name one it holds: {}{fill}", words.join(", "))
}
