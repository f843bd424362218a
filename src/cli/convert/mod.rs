//! `photonvdb convert`: grids of an OpenVDB file, written to another one.
//!
//! The file that is read lies in memory, and of its grids one at a time. The new file takes its place
//! when it is complete, so that both may have the same name.

pub mod args;

use std::fs::{self, File};
use std::path::Path;

use photonvdb::files::write_beside;
use photonvdb::medium::vdb::{
    GridClass, GridSummary, GridToWrite, SparseGrid, ValuesToWrite, VdbError, VdbFile, VdbWriter,
    VolumeSource, WrittenGrid, crop, find_grid,
};

use super::console::say;
use super::error::CliError;
use args::ConvertArguments;

/// Writes the grids that the arguments name.
pub fn run(arguments: &ConvertArguments) -> Result<(), CliError> {
    let input = VdbFile::open_within(&arguments.input, &arguments.volume.limits())?;
    let input_len = byte_count(&arguments.input)?;
    let indices = chosen_grids(&input, arguments)?;
    let written =
        write_beside(&arguments.output, |file| write_grids(file, &input, &indices, arguments))?;
    for (grid, &index) in written.iter().zip(&indices) {
        summarise(grid, &input.grids()[index]);
    }
    let active: u64 =
        written.iter().fold(0, |sum, grid| sum.saturating_add(grid.active_voxel_count));
    let plural = if written.len() == 1 { "" } else { "s" };
    say(&format!(
        "wrote {}: {} grid{plural}, {active} active voxels, {input_len} bytes -> {}",
        arguments.output.display(),
        written.len(),
        byte_count(&arguments.output)?
    ));
    Ok(())
}

/// The grids that are written, in the order asked for.
fn chosen_grids(input: &VdbFile, arguments: &ConvertArguments) -> Result<Vec<usize>, CliError> {
    let chosen = if arguments.grids.is_empty() {
        convertible_grids(input)
    } else {
        named_grids(input, &arguments.grids)?
    };
    match (&arguments.rename, chosen.len()) {
        (_, 0) => Err(CliError::NothingToConvert { path: arguments.input.clone() }),
        (Some(_), count) if count > 1 => Err(CliError::RenameMany { count }),
        _ => Ok(chosen),
    }
}

/// Every grid that can be converted; tells which cannot.
fn convertible_grids(input: &VdbFile) -> Vec<usize> {
    if let Some(damage) = input.damage() {
        say(&format!("warning: more grids of {} cannot be read: {damage}", input.name()));
    }
    let mut chosen = Vec::new();
    for (index, summary) in input.grids().iter().enumerate() {
        match &summary.unusable {
            Some(reason) => say(&format!("skipping grid \"{}\": {reason}", summary.unique_name)),
            None => chosen.push(index),
        }
    }
    chosen
}

/// The grids of these names, each once.
fn named_grids(input: &VdbFile, names: &[String]) -> Result<Vec<usize>, VdbError> {
    let mut chosen = Vec::new();
    for name in names {
        let index = find_grid(input, name)?;
        if let GridSummary { unusable: Some(reason), unique_name, .. } = &input.grids()[index] {
            return Err(VdbError::Unusable {
                file: input.name().to_owned(),
                grid: unique_name.clone(),
                reason: reason.clone(),
            });
        }
        if !chosen.contains(&index) {
            chosen.push(index);
        }
    }
    Ok(chosen)
}

fn write_grids(
    file: &mut File,
    input: &VdbFile,
    indices: &[usize],
    arguments: &ConvertArguments,
) -> Result<Vec<WrittenGrid>, CliError> {
    let name = |index: usize| arguments.rename.as_deref().unwrap_or(&input.grids()[index].name);
    let names: Vec<&str> = indices.iter().map(|&index| name(index)).collect();
    let options = arguments.write_options();
    let mut writer = VdbWriter::new(file, &arguments.output, &names, &options)?;
    let limits = arguments.volume.limits();
    let mut written = Vec::new();
    for (&index, name) in indices.iter().zip(&names) {
        let summary = &input.grids()[index];
        written.push(if summary.is_usable_scalar() {
            let grid = input.load_scalar(index, &limits)?;
            write_grid(grid, name, summary, arguments, &mut writer)?
        } else {
            let grid = input.load_vector(index, &limits)?;
            write_grid(grid, name, summary, arguments, &mut writer)?
        });
    }
    writer.finish()?;
    Ok(written)
}

/// Writes one grid, cropped where asked for.
fn write_grid<V>(
    mut grid: SparseGrid<V>,
    name: &str,
    summary: &GridSummary,
    arguments: &ConvertArguments,
    writer: &mut VdbWriter<&mut File>,
) -> Result<WrittenGrid, CliError>
where
    V: Copy + Default,
    for<'g> ValuesToWrite<'g>: From<&'g SparseGrid<V>>,
{
    if let Some(bounds) = arguments.crop {
        crop(&mut grid, bounds, &arguments.volume.limits()).map_err(|source| CliError::Crop {
            path: arguments.input.clone(),
            grid: summary.unique_name.clone(),
            source,
        })?;
    }
    let grid = GridToWrite {
        class: GridClass::from_word(&summary.class),
        // What was rounded once need not be kept in more bits than it has.
        half: summary.half || summary.value_type == "half",
        metadata: summary.metadata.clone(),
        ..GridToWrite::new(name, &grid)
    };
    Ok(writer.write_grid(&grid)?)
}

/// Says what became of a grid.
fn summarise(grid: &WrittenGrid, source: &GridSummary) {
    let name = if grid.unique_name.is_empty() { "(no name)" } else { &grid.unique_name };
    say(&format!(
        "{name}: {} of {} active voxels, {} bytes",
        grid.active_voxel_count, source.active_voxel_count, grid.byte_count
    ));
}

fn byte_count(path: &Path) -> Result<u64, CliError> {
    let found = fs::metadata(path).map(|metadata| metadata.len());
    found.map_err(|source| CliError::Read { path: path.to_path_buf(), source })
}
