//! Media known by name: `[medium] preset = "fog"`.
//!
//! A preset is a file of `media/presets`, compiled in, that holds `sigma_t` \[1/m\], `albedo` and `phase` as a scene file
//! spells them, and says in its comments where the figures come from. It fills in what the scene does not say; in a
//! volume, whose extinction is `density_scale` times its values, `sigma_t` is what value 1 stands for.

use super::error::Problem;
use super::tree::{self, Node, Value};

/// A medium known by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// As scenes name it.
    pub name: &'static str,
    /// Its file: TOML whose comments tell where the figures come from.
    pub text: &'static str,
}

macro_rules! presets {
    ($($name:literal)*) => {
        &[$(Preset { name: $name, text: include_str!(concat!("../../media/presets/", $name, ".toml")) }),*]
    };
}

impl Preset {
    /// Every preset, thin ones first.
    pub const ALL: &'static [Preset] = presets![
        "fog" "cloud" "steam" "smoke" "skim-milk" "whole-milk" "lowfat-milk" "regular-milk"
    ];

    /// The preset of that name.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|preset| preset.name == name).copied()
    }

    /// What it is, in a sentence: the first line of its file.
    pub fn about(&self) -> &'static str {
        self.text.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
    }

    /// What it sets, a line a key: `albedo = 0.9`.
    pub fn settings(&self) -> impl Iterator<Item = &'static str> {
        self.text.lines().filter(|line| !line.starts_with('#') && !line.is_empty())
    }

    /// Extinction of the channel that has most of it \[1/m\].
    pub fn max_sigma_t(&self) -> f64 {
        let sigma_t = self.entries().into_iter().find(|(key, _)| key == "sigma_t");
        let channels = match sigma_t.map(|(_, node)| node.value) {
            Some(Value::List(channels)) => {
                channels.into_iter().map(|channel| channel.value).collect()
            }
            one => Vec::from_iter(one),
        };
        let number = |channel: &Value| match channel {
            Value::Float(number) => *number,
            _ => 0.0,
        };
        channels.iter().map(number).fold(0.0, f64::max)
    }

    /// Mean cosine of the angle by which it scatters.
    pub fn mean_cosine(&self) -> f64 {
        let value_of = |entries: Vec<(String, Node)>, name: &str| {
            entries.into_iter().find(|(key, _)| key == name).map(|(_, node)| node.value)
        };
        match value_of(self.entries(), "phase") {
            Some(Value::Table(phase)) => match value_of(phase, "g") {
                Some(Value::Float(g)) => g,
                _ => 0.0,
            },
            _ => 0.0,
        }
    }

    fn entries(&self) -> Vec<(String, Node)> {
        match tree::parse_toml(self.text).map(|node| node.value) {
            Some(Value::Table(entries)) => entries,
            _ => Vec::new(),
        }
    }
}

/// Puts what presets say into the media of a scene that name one, where the scene says nothing.
pub(super) fn apply(scene: &mut Node) -> Result<(), Problem> {
    let Value::Table(sections) = &mut scene.value else { return Ok(()) };
    let Some((_, medium)) = sections.iter_mut().find(|(name, _)| name == "medium") else {
        return Ok(());
    };
    match &mut medium.value {
        Value::Table(entries) => fill_in(entries, "medium"),
        Value::List(media) => {
            media.iter_mut().enumerate().try_for_each(|(index, medium)| match &mut medium.value {
                Value::Table(entries) => fill_in(entries, &format!("medium[{index}]")),
                _ => Ok(()),
            })
        }
        _ => Ok(()),
    }
}

fn fill_in(entries: &mut Vec<(String, Node)>, path: &str) -> Result<(), Problem> {
    let problem = |text: String| Problem::new(format!("{path}.preset"), text);
    let find = |key: &str| entries.iter().find(|(name, _)| name == key).map(|(_, node)| node);
    let Some(named) = find("preset") else { return Ok(()) };
    let Value::Text(name) = &named.value else {
        return Err(problem(format!("expected the name of a preset, found {}", named.value)));
    };
    let preset = Preset::find(name).ok_or_else(|| problem(unknown(name)))?;
    let name = preset.name;
    let origin = named.origin;
    let is_volume =
        find("kind").is_some_and(|kind| matches!(&kind.value, Value::Text(kind) if kind == "vdb"));
    for (mut key, mut node) in preset.entries() {
        if is_volume && key == "sigma_t" {
            key = "density_scale".into();
        }
        if entries.iter().any(|(given, _)| *given == key) {
            continue;
        }
        if key == "density_scale" && matches!(node.value, Value::List(_)) {
            return Err(problem(format!(
                "{name:?} has an extinction for each channel and a volume one for all: give density_scale"
            )));
        }
        node.place(origin);
        entries.push((key, node));
    }
    Ok(())
}

fn unknown(name: &str) -> String {
    let distance =
        |preset: &&Preset| strsim::damerau_levenshtein(&name.to_lowercase(), preset.name);
    let nearest = Preset::ALL.iter().min_by_key(distance);
    match nearest.filter(|preset| distance(preset) <= 1 + preset.name.len() / 3) {
        Some(preset) => format!("unknown preset {name:?}; did you mean {:?}?", preset.name),
        None => {
            let names: Vec<_> = Preset::ALL.iter().map(|preset| preset.name).collect();
            format!("unknown preset {name:?}; known: {}", names.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_sets_the_three_and_names_its_source() {
        for preset in Preset::ALL {
            let keys: Vec<_> = preset.entries().into_iter().map(|(key, _)| key).collect();
            assert_eq!([keys.len(), preset.settings().count()], [3, 3], "{}", preset.name);
            for key in ["sigma_t", "albedo", "phase"] {
                assert!(keys.iter().any(|found| found == key), "{}: {key}", preset.name);
            }
            assert!(preset.max_sigma_t() > 0.0);
            let comments = preset.text.lines().filter(|line| line.starts_with('#'));
            assert!(comments.clone().any(|line| line.contains("20") || line.contains("19")));
            assert!(comments.count() >= 4 && preset.about().ends_with('.'), "{}", preset.name);
            assert_eq!(Preset::find(preset.name), Some(*preset));
        }
    }
}
