//! `photonvdb schema`: what a scene file may say, for editors and for people.

use clap::Args;
use photonvdb::scene::{json_schema, scene_reference};

use super::error::CliError;
use super::{print_json, print_to_stdout};

const EXAMPLES: &str = "\
Examples:
  photonvdb schema > photonvdb.schema.json
      With the line `#:schema photonvdb.schema.json` at the top of a scene, editors that know TOML schemas (Even Better
      TOML, Taplo) complete and check it; JSON scenes are mapped to it in the settings of the editor.
  photonvdb schema --markdown | less
      The same in words.";

/// `photonvdb schema`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct SchemaArguments {
    /// Every key in words, in Markdown
    #[arg(long)]
    pub markdown: bool,
}

/// Prints what was asked for.
pub fn run(arguments: &SchemaArguments) -> Result<(), CliError> {
    if arguments.markdown {
        print_to_stdout(&scene_reference())
    } else {
        print_json(&json_schema())
    }
}
