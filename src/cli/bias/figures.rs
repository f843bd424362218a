//! Every graph of the thesis, into a directory.

use std::fs;
use std::path::Path;

use photonvdb::lab::figures::{Studies, figures, plotted_csv, plotted_numbers, report};
use serde_json::json;

use crate::cli::console::say;
use crate::cli::error::CliError;
use crate::cli::text_file::{write_json, write_text};

/// Draws all figures, and beside them their numbers and the report.
pub fn draw(directory: &Path, seed: u64) -> Result<(), CliError> {
    let cannot = |source| CliError::Directory { path: directory.to_path_buf(), source };
    fs::create_dir_all(directory).map_err(cannot)?;
    let studies = Studies::run(seed, 1.0, say)?;
    let figures = figures(&studies);
    for figure in &figures {
        write_text(&directory.join(figure.file_name()), &figure.to_svg()?)?;
    }
    let numbers = plotted_numbers(&figures);
    write_text(&directory.join("figures.csv"), &plotted_csv(&numbers))?;
    let experiments = studies.costs();
    let all = json!({ "numbers": numbers, "experiments": experiments });
    write_json(&directory.join("figures.json"), &all)?;
    write_text(&directory.join("report.md"), &report(&studies))?;
    let seconds: f64 = experiments.iter().map(|cost| cost.seconds).sum();
    say(&format!(
        "{} figures, {} numbers, report.md in {}; {} experiments took {seconds:.1} s",
        figures.len(),
        numbers.len(),
        directory.display(),
        experiments.len()
    ));
    Ok(())
}
