//! The command line.
//!
//! [`args`] says what can be typed; each command has a module that turns its arguments into library calls
//! and files. Results go to files or, asked for, to stdout; everything meant for people goes to stderr.
//! Exit codes: 0 done, 1 a check asked for did not hold, 2 bad input or usage.

mod args;
mod bake;
mod bias;
mod bytes;
mod compare;
mod completions;
mod console;
mod convert;
mod count;
mod error;
mod file_names;
mod image_files;
mod inspect;
mod interrupt;
mod man;
mod new;
mod outputs;
mod presets;
mod progress;
mod reference;
mod render;
mod report;
mod resources;
mod schema;
mod summary;
mod sweep;
mod table_outputs;
mod terminal_picture;
mod text_file;
mod validate;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches};
use serde::Serialize;

use args::{Arguments, Command};
use console::say;
use error::CliError;

/// Runs the command typed.
pub fn run() -> ExitCode {
    let finished = match parsed().command {
        Command::New(arguments) => new::run(&arguments),
        Command::Render(arguments) => render::run(&arguments),
        Command::Bake(arguments) => bake::run(&arguments),
        Command::Reference(arguments) => reference::run(&arguments),
        Command::Bias(arguments) => bias::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Sweep(arguments) => sweep::run(&arguments),
        Command::Inspect(arguments) => inspect::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Validate(arguments) => validate::run(&arguments),
        Command::Presets(arguments) => presets::run(&arguments),
        Command::Schema(arguments) => schema::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
        Command::Man(arguments) => man::run(&arguments),
    };
    match finished {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("error: {error}"));
            ExitCode::from(error.exit_code())
        }
    }
}

/// What was typed. A negative number is taken as the value of the flag before it, so that its parser says what is wanted.
fn parsed() -> Arguments {
    let command = Arguments::command().mut_subcommands(|command| {
        command.mut_args(|argument| {
            let takes_text = argument.get_action().takes_values();
            argument.allow_negative_numbers(takes_text)
        })
    });
    let parsed = Arguments::from_arg_matches(&command.get_matches());
    parsed.unwrap_or_else(|error| error.exit())
}

/// A pool of so many threads; without a number one a core, or what RAYON_NUM_THREADS says.
fn thread_pool(threads: Option<u32>) -> Result<rayon::ThreadPool, CliError> {
    let threads = threads.unwrap_or(0);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads as usize)
        .build()
        .map_err(|source| CliError::Threads { threads, source })
}

/// Writes a value to stdout as indented JSON.
fn print_json(value: &impl Serialize) -> Result<(), CliError> {
    let json =
        serde_json::to_string_pretty(value).map_err(|error| CliError::Stdout(error.into()))?;
    print_to_stdout(&(json + "\n"))
}

/// Writes text to stdout. A reader that has seen enough and closed the pipe is no error.
fn print_to_stdout(text: &str) -> Result<(), CliError> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(CliError::Stdout(error)),
        _ => Ok(()),
    }
}
