//! An EXR: its parts, layers and metadata.

use std::fmt::Write;
use std::path::Path;

use photonvdb::film::{ExrPart, describe_exr};
use serde_json::{Map, Value, json};

use crate::cli::error::CliError;
use crate::cli::{print_json, print_to_stdout};

/// Shows the EXR at `path`.
pub fn inspect(path: &Path, as_json: bool) -> Result<(), CliError> {
    let parts = describe_exr(path)?.parts;
    if as_json {
        let parts: Vec<Value> = parts.iter().map(part_json).collect();
        return print_json(&json!({ "parts": parts }));
    }
    let mut text = String::new();
    for part in &parts {
        // Writing to a string cannot fail.
        let _ = write_part(&mut text, path, part);
    }
    print_to_stdout(&text)
}

fn part_json(part: &ExrPart) -> Value {
    let layers = part
        .layers()
        .into_iter()
        .map(|(name, channels)| json!({ "name": name, "channels": channels }));
    let channels = part
        .channels
        .iter()
        .map(|(name, sample_type)| json!({ "name": name, "type": sample_type }));
    let metadata: Map<String, Value> =
        part.attributes.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
    json!({
        "name": part.name,
        "width": part.width,
        "height": part.height,
        "compression": part.compression,
        "layers": layers.collect::<Vec<_>>(),
        "channels": channels.collect::<Vec<_>>(),
        "metadata": metadata,
    })
}

fn write_part(text: &mut String, path: &Path, part: &ExrPart) -> std::fmt::Result {
    let name = part.name.as_deref().map(|name| format!(", part {name}")).unwrap_or_default();
    writeln!(
        text,
        "{}{name}: {} x {} pixels, {}",
        path.display(),
        part.width,
        part.height,
        part.compression
    )?;
    writeln!(text, "layers")?;
    for (layer, channels) in part.layers() {
        let layer = if layer.is_empty() { "(image)" } else { layer };
        writeln!(text, "  {layer:<18}{}", channels.join(" "))?;
    }
    writeln!(text, "metadata")?;
    let width = part.attributes.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, value) in &part.attributes {
        writeln!(text, "  {name:<width$}  {value}")?;
    }
    Ok(())
}
