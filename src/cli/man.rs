//! `photonvdb man`: the help as manual pages, one a command.

use std::fs;
use std::io;
use std::path::PathBuf;

use clap::{Args, Command, CommandFactory};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};
use photonvdb::film::write_beside;

use super::args::Arguments;
use super::console::say;
use super::error::CliError;
use super::print_to_stdout;

const EXAMPLES: &str = "\
Examples:
  photonvdb man | man -l -
      The page of photonvdb, read at once.
  photonvdb man ~/.local/share/man/man1
      Every page where man finds it: `man photonvdb-render`.";

/// `photonvdb man`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct ManArguments {
    /// Directory for all pages, made if need be [default: the page of photonvdb alone, on stdout]
    pub directory: Option<PathBuf>,
}

/// Prints one page or writes all.
pub fn run(arguments: &ManArguments) -> Result<(), CliError> {
    let mut command = Arguments::command().disable_help_subcommand(true);
    command.build();
    let Some(directory) = &arguments.directory else {
        let page = page(&command).map_err(CliError::Stdout)?;
        return print_to_stdout(&String::from_utf8_lossy(&page));
    };
    let failure = |source| CliError::Directory { path: directory.clone(), source };
    fs::create_dir_all(directory).map_err(failure)?;
    let mut count = 0;
    for command in [&command].into_iter().chain(command.get_subcommands()) {
        let path = directory.join(Man::new(command.clone()).get_filename());
        let page = page(command).map_err(failure)?;
        write_beside(&path, |file| io::Write::write_all(file, &page))?;
        count += 1;
    }
    say(&format!("wrote {count} pages to {}", directory.display()));
    Ok(())
}

/// A page with the text below the help as it is: examples keep their lines.
fn page(command: &Command) -> io::Result<Vec<u8>> {
    let man = Man::new(command.clone());
    let mut page = Vec::new();
    man.render_title(&mut page)?;
    man.render_name_section(&mut page)?;
    man.render_synopsis_section(&mut page)?;
    man.render_description_section(&mut page)?;
    man.render_options_section(&mut page)?;
    if command.has_subcommands() {
        man.render_subcommands_section(&mut page)?;
    }
    let below = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let (notes, examples) = below.split_once("Examples:\n").unwrap_or((&below, ""));
    let mut roff = Roff::new();
    for (title, text) in [("NOTES", notes), ("EXAMPLES", examples)] {
        if text.trim().is_empty() {
            continue;
        }
        roff.control("SH", [title]);
        roff.control("nf", []);
        for line in text.trim_matches('\n').lines() {
            roff.text([roman(line)]);
        }
        roff.control("fi", []);
    }
    roff.to_writer(&mut page)?;
    Ok(page)
}
