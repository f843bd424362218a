//! The tables as JSON Schema, draft 7, which editors know.

use serde_json::{Map, Value, json};

use super::key::{Default, Key, Kind, Limits, Repeats, Section, Variant};
use super::tables::{REQUIRED, SECTIONS};
use super::words::range_words;
use crate::scene::Preset;

/// The JSON Schema of scene files, TOML and JSON alike. It checks keys, types, words and ranges; what one value asks of
/// another (that `look_at` is not `position`) only loading the scene does.
pub fn json_schema() -> Value {
    let properties: Map<String, Value> =
        SECTIONS.iter().map(|section| (section.path.into(), section_schema(section))).collect();
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "photonvdb scene",
        "description": "A scene of photonvdb. SI units, degrees, linear RGB; y is up unless the camera says otherwise.",
        "type": "object",
        "properties": properties,
        "required": REQUIRED,
        "additionalProperties": false,
    })
}

fn section_schema(section: &Section) -> Value {
    let mut variants: Vec<Value> = section.variants.iter().map(variant_schema).collect();
    let table = if variants.len() == 1 { variants.remove(0) } else { json!({ "oneOf": variants }) };
    let mut schema = match section.repeats {
        Repeats::Never => table,
        Repeats::Always => json!({ "type": "array", "items": table }),
        Repeats::Allowed => {
            let list = json!({ "type": "array", "items": table, "minItems": 1 });
            json!({ "oneOf": [table, list] })
        }
    };
    schema["description"] = section.about.into();
    schema
}

fn variant_schema(variant: &Variant) -> Value {
    if let Some(word) = variant.word {
        return json!({ "const": word, "description": variant.about });
    }
    let mut properties = Map::new();
    let mut required = Vec::new();
    if let Some((key, word)) = variant.chosen_by {
        properties.insert(key.into(), json!({ "const": word }));
        if !variant.is_default {
            required.push(key);
        }
    }
    for key in variant.keys {
        properties.insert(key.name.into(), key_schema(key));
    }
    required.extend(
        variant.keys.iter().filter(|key| key.default == Default::Required).map(|key| key.name),
    );
    let mut schema = json!({
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    });
    if !variant.about.is_empty() {
        schema["description"] = variant.about.into();
    }
    let alternatives: Vec<Value> = variant.keys.iter().filter_map(alternatives).collect();
    if !alternatives.is_empty() {
        schema["allOf"] = alternatives.into();
    }
    let needs = variant.keys.iter().filter(|key| !key.needs.is_empty());
    let needs: Map<String, Value> =
        needs.map(|key| (key.name.into(), any_required(key.needs.iter().copied()))).collect();
    if !needs.is_empty() {
        schema["dependencies"] = needs.into();
    }
    schema
}

/// That a key is given, or one that stands in for it.
fn alternatives(key: &Key) -> Option<Value> {
    match key.default {
        Default::Unless(others) => {
            Some(any_required([key.name].into_iter().chain(others.split(" or "))))
        }
        _ => None,
    }
}

fn any_required<'a>(keys: impl Iterator<Item = &'a str>) -> Value {
    let each: Vec<Value> = keys.map(|key| json!({ "required": [key] })).collect();
    json!({ "anyOf": each })
}

fn key_schema(key: &Key) -> Value {
    let mut schema = kind_schema(&key.kind);
    schema["description"] = description(key).into();
    if let Default::Value(text) = key.default
        && let Ok(value) = serde_json::from_str::<Value>(text)
    {
        schema["default"] = value;
    }
    schema
}

fn description(key: &Key) -> String {
    let mut text = key.meaning.to_owned();
    let mut add = |label: &str, words: &str| {
        if !words.is_empty() {
            text += &format!(". {label}: {words}");
        }
    };
    add("Unit", key.unit);
    add("Range", &range_words(key));
    match key.default {
        Default::Required => add("Default", "none, it is required"),
        Default::Unless(other) => {
            add("Default", &format!("none, it is required unless there is {other}"))
        }
        Default::Value(value) => add("Default", value),
        Default::Words(words) => add("Default", words),
    }
    text
}

fn kind_schema(kind: &Kind) -> Value {
    match *kind {
        Kind::Number(limits) => number(&limits),
        Kind::Integer(min, max) => integer(min, max),
        Kind::Boolean => json!({ "type": "boolean" }),
        Kind::Text | Kind::Path => json!({ "type": "string" }),
        Kind::Word(words) => json!({ "type": "string", "enum": words }),
        Kind::Preset => {
            let names: Vec<_> = Preset::ALL.iter().map(|preset| preset.name).collect();
            json!({ "type": "string", "enum": names })
        }
        Kind::Numbers(count) => list(number(&super::key::ANY), count),
        Kind::OneOrThree(limits) => {
            json!({ "oneOf": [number(&limits), list(number(&limits), 3)] })
        }
        Kind::Pair(min, max) => list(integer(min, max), 2),
        Kind::Table(section) => section_schema(section),
    }
}

fn integer(min: u64, max: u64) -> Value {
    json!({ "type": "integer", "minimum": min, "maximum": max })
}

fn list(item: Value, count: usize) -> Value {
    json!({ "type": "array", "items": item, "minItems": count, "maxItems": count })
}

fn number(limits: &Limits) -> Value {
    let mut schema = json!({ "type": "number" });
    if let Some(min) = limits.min {
        schema[if limits.open_min { "exclusiveMinimum" } else { "minimum" }] = min.into();
    }
    if let Some(max) = limits.max {
        schema[if limits.open_max { "exclusiveMaximum" } else { "maximum" }] = max.into();
    }
    schema
}
