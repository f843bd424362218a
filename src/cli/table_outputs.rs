//! Where a lab command writes its table: the same flags, the same files.

use std::path::PathBuf;

use clap::Args;
use photonvdb::film::check_writable;
use photonvdb::lab::Chart;
use serde::Serialize;

use super::error::CliError;
use super::print_to_stdout;
use super::report::is_stdout;
use super::text_file::{write_json, write_text};

/// Files of a table.
#[derive(Args, Debug)]
pub struct TableOutputs {
    /// Every row as CSV; `-` is stdout
    #[arg(long, value_name = "OUT.csv")]
    pub csv: Option<PathBuf>,

    /// Every row and what it cost as JSON; `-` is stdout
    #[arg(long, value_name = "OUT.json")]
    pub json: Option<PathBuf>,

    /// The table as a chart, with error bars
    #[arg(long, value_name = "OUT.svg")]
    pub plot: Option<PathBuf>,

    /// Adds processor time and efficiency to the CSV, which then differs from run to run
    #[arg(long)]
    pub timing: bool,
}

impl TableOutputs {
    /// Fails early where a file cannot be written.
    pub fn check(&self) -> Result<(), CliError> {
        let mut files = self.paths().filter(|path| !is_stdout(path));
        Ok(files.try_for_each(|path| check_writable(path))?)
    }

    /// Writes what was asked for, and the summary to stdout unless something else goes there.
    pub fn write(
        &self,
        csv: &str,
        table: &impl Serialize,
        chart: &Chart,
        summary: &str,
    ) -> Result<(), CliError> {
        if let Some(path) = &self.csv {
            write_text(path, csv)?;
        }
        if let Some(path) = &self.json {
            write_json(path, table)?;
        }
        if let Some(path) = &self.plot {
            write_text(path, &chart.to_svg()?)?;
        }
        let is_stdout_taken = self.paths().any(|path| is_stdout(path));
        if is_stdout_taken { Ok(()) } else { print_to_stdout(summary) }
    }

    fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        [&self.csv, &self.json, &self.plot].into_iter().flatten()
    }
}
