//! `photonvdb presets`: the media known by name.

use clap::Args;
use photonvdb::scene::Preset;

use super::error::CliError;
use super::print_to_stdout;

const EXAMPLES: &str = "\
A scene names one with `preset` in its [medium]; what else is said there comes first:

  [medium]
  kind = \"homogeneous\"
  preset = \"fog\"
  bounds = { min = [-100, 0, -100], max = [100, 50, 100] }

Examples:
  photonvdb presets
  photonvdb presets fog
      Its figures, and where they come from.
  photonvdb new fog.toml --preset fog
      A scene of it.";

/// `photonvdb presets`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct PresetsArguments {
    /// One of them, in full [default: a list of all]
    #[arg(value_parser = parse_preset)]
    pub name: Option<Preset>,
}

/// The preset of that name.
pub fn parse_preset(name: &str) -> Result<Preset, String> {
    let names: Vec<_> = Preset::ALL.iter().map(|preset| preset.name).collect();
    Preset::find(name).ok_or_else(|| format!("known are {}", names.join(", ")))
}

/// Lists them, or shows one.
pub fn run(arguments: &PresetsArguments) -> Result<(), CliError> {
    if let Some(preset) = arguments.name {
        return print_to_stdout(preset.text);
    }
    let mut text = String::new();
    for preset in Preset::ALL {
        text += &format!("{:13} {}\n", preset.name, preset.about());
        for setting in preset.settings() {
            text += &format!("{:15} {setting}\n", "");
        }
    }
    print_to_stdout(&text)
}
