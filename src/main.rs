//! The command line of photonvdb: parses, runs, and reports by exit code.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run()
}
