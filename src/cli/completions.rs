//! `photonvdb completions`: what shells need to complete commands and flags.

use clap::{Args, CommandFactory};
use clap_complete::{Shell, generate};

use super::args::Arguments;
use super::error::CliError;
use super::print_to_stdout;

const EXAMPLES: &str = "\
Examples:
  photonvdb completions bash > ~/.local/share/bash-completion/completions/photonvdb
  photonvdb completions zsh > ~/.zfunc/_photonvdb
      With `fpath+=~/.zfunc` before compinit in ~/.zshrc.
  photonvdb completions fish > ~/.config/fish/completions/photonvdb.fish
  photonvdb completions powershell >> $PROFILE
  photonvdb completions elvish >> ~/.config/elvish/rc.elv";

/// `photonvdb completions`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct CompletionsArguments {
    /// The shell
    pub shell: Shell,
}

/// Prints the script.
pub fn run(arguments: &CompletionsArguments) -> Result<(), CliError> {
    let mut script = Vec::new();
    generate(arguments.shell, &mut Arguments::command(), "photonvdb", &mut script);
    print_to_stdout(&String::from_utf8_lossy(&script))
}
