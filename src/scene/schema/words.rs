//! The tables in words: the page `docs/SCENE.md`.

use super::key::{Default, Key, Kind, Limits, Repeats, Section, Variant};
use super::tables::SECTIONS;
use crate::scene::Preset;

const OPENING: &str = "\
# The scene file

Every key, with its type, unit, default and range. TOML or JSON of the same structure; SI units, degrees, linear RGB;
numbers are finite and of magnitude up to 1e30. A key that is not listed here is an error that names the line and the key
meant. Paths are relative to the scene file. `photonvdb schema` prints the same as JSON Schema, for editors: with
`photonvdb schema > photonvdb.schema.json`, a first line `#:schema photonvdb.schema.json` makes editors that know TOML
schemas complete and check scenes.

This page is printed by `photonvdb schema --markdown`, and a test holds it against the program.
";

/// Every key of scene files in Markdown: `docs/SCENE.md`.
pub fn scene_reference() -> String {
    let mut page = OPENING.to_owned();
    for section in SECTIONS {
        describe(section, &mut page);
    }
    page += "\n## Presets\n\n`medium.preset` is one of these. `photonvdb presets NAME` prints where its figures come from.\n\n";
    page += "| name | medium | sigma_t \\[1/m\\] |\n|---|---|---|\n";
    for preset in Preset::ALL {
        let sigma_t = preset.settings().find_map(|line| line.strip_prefix("sigma_t = "));
        let sigma_t = sigma_t.unwrap_or_default();
        page += &format!("| `{}` | {} | {sigma_t} |\n", preset.name, preset.about());
    }
    page
}

fn describe(section: &Section, page: &mut String) {
    let path = section.path;
    let title = match (section.repeats, path.contains('.')) {
        (Repeats::Always, _) => format!("`[[{path}]]`"),
        (Repeats::Allowed, _) => format!("`[{path}]`, or `[[{path}]]` once or more"),
        (Repeats::Never, true) => format!("`{path}`"),
        (Repeats::Never, false) => format!("`[{path}]`"),
    };
    *page += &format!("\n## {title}\n\n{}\n", section.about);
    for variant in section.variants {
        describe_variant(variant, page);
    }
    let mut tables: Vec<&Section> = Vec::new();
    for key in section.variants.iter().flat_map(|variant| variant.keys) {
        if let Kind::Table(table) = key.kind
            && !tables.iter().any(|known| known.path == table.path)
        {
            tables.push(table);
        }
    }
    for table in tables {
        describe(table, page);
    }
}

fn describe_variant(variant: &Variant, page: &mut String) {
    let chosen = match variant.chosen_by {
        Some((key, word)) if variant.is_default => format!("`{key} = \"{word}\"` (default): "),
        Some((key, word)) => format!("`{key} = \"{word}\"`: "),
        None => variant.word.map_or_else(String::new, |word| format!("`\"{word}\"`: ")),
    };
    if !variant.about.is_empty() {
        *page += &format!("\n{chosen}{}\n", variant.about);
    }
    if variant.keys.is_empty() {
        return;
    }
    *page += "\n| key | type | unit | default | range | meaning |\n|---|---|---|---|---|---|\n";
    for key in variant.keys {
        *page += &format!(
            "| `{}` | {} | {} | {} | {} | {} |\n",
            key.name,
            type_words(&key.kind),
            escape(key.unit),
            default_words(key),
            escape(&range_words(key)),
            key.meaning
        );
    }
}

fn type_words(kind: &Kind) -> String {
    match *kind {
        Kind::Number(_) => "number".into(),
        Kind::Integer(..) => "integer".into(),
        Kind::Boolean => "boolean".into(),
        Kind::Text => "text".into(),
        Kind::Path => "path".into(),
        Kind::Word(words) => {
            words.iter().map(|word| format!("`\"{word}\"`")).collect::<Vec<_>>().join(", ")
        }
        Kind::Preset => "[preset](#presets)".into(),
        Kind::Numbers(count) => format!("{count} numbers"),
        Kind::OneOrThree(_) => "number or 3 numbers".into(),
        Kind::Pair(..) => "2 integers".into(),
        Kind::Table(section) => format!("table, see `{}` below", section.path),
    }
}

fn default_words(key: &Key) -> String {
    match key.default {
        Default::Required => "required".into(),
        Default::Unless(other) => format!("required unless there is {other}"),
        Default::Value(value) => format!("`{value}`"),
        Default::Words(words) => words.into(),
    }
}

/// Where the value of a key must lie.
pub(super) fn range_words(key: &Key) -> String {
    let limits = match key.kind {
        Kind::Number(limits) | Kind::OneOrThree(limits) => limit_words(&limits),
        Kind::Integer(min, max) => format!("{min} to {max}"),
        Kind::Pair(min, max) => format!("{min} to {max} each"),
        _ => String::new(),
    };
    let needs = match key.needs {
        [] => String::new(),
        needs => format!("only with {}", needs.join(" or ")),
    };
    [limits.as_str(), key.rule, &needs]
        .into_iter()
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join("; ")
}

fn limit_words(limits: &Limits) -> String {
    match (limits.min, limits.max) {
        (Some(min), Some(max)) => {
            let open = if limits.open_min { '(' } else { '[' };
            let close = if limits.open_max { ')' } else { ']' };
            format!("{open}{min}, {max}{close}")
        }
        (Some(min), None) if limits.open_min => format!("above {min}"),
        (Some(min), None) => format!("at least {min}"),
        (None, Some(max)) => format!("up to {max}"),
        (None, None) => String::new(),
    }
}

fn escape(text: &str) -> String {
    text.replace('[', "\\[").replace(']', "\\]")
}
