//! The part of JSON Schema that the scene's schema uses, checked value by value.

use serde_json::{Map, Value};

/// Words of a schema that check nothing.
const NOTES: [&str; 4] = ["$schema", "title", "description", "default"];

/// Why a value does not fit a schema.
pub fn check(schema: &Value, value: &Value, path: &str) -> Result<(), String> {
    let schema = schema.as_object().expect("a schema is a table");
    for (word, rule) in schema {
        let fits = match word.as_str() {
            word if NOTES.contains(&word) => true,
            "type" => has_type(value, rule.as_str().expect("a type")),
            "const" => value == rule,
            "enum" => rule.as_array().expect("values").contains(value),
            "minimum" => value.as_f64().is_none_or(|number| number >= limit(rule)),
            "maximum" => value.as_f64().is_none_or(|number| number <= limit(rule)),
            "exclusiveMinimum" => value.as_f64().is_none_or(|number| number > limit(rule)),
            "exclusiveMaximum" => value.as_f64().is_none_or(|number| number < limit(rule)),
            "minItems" => value.as_array().is_none_or(|items| items.len() as f64 >= limit(rule)),
            "maxItems" => value.as_array().is_none_or(|items| items.len() as f64 <= limit(rule)),
            "items" => {
                for (index, item) in value.as_array().into_iter().flatten().enumerate() {
                    check(rule, item, &format!("{path}[{index}]"))?;
                }
                true
            }
            "required" => value.as_object().is_none_or(|table| has_all(table, rule)),
            "properties" => {
                for (key, rule) in rule.as_object().expect("properties") {
                    if let Some(value) = value.get(key) {
                        check(rule, value, &format!("{path}.{key}"))?;
                    }
                }
                true
            }
            "additionalProperties" => {
                assert_eq!(rule, &Value::Bool(false));
                let known = schema["properties"].as_object().expect("properties");
                value
                    .as_object()
                    .is_none_or(|table| table.keys().all(|key| known.contains_key(key)))
            }
            "dependencies" => {
                for (key, rule) in rule.as_object().expect("dependencies") {
                    if value.get(key).is_some() {
                        check(rule, value, path)?;
                    }
                }
                true
            }
            "allOf" => {
                rule.as_array()
                    .expect("schemas")
                    .iter()
                    .try_for_each(|rule| check(rule, value, path))?;
                true
            }
            "anyOf" => fitting(rule, value, path) >= 1,
            "oneOf" => fitting(rule, value, path) == 1,
            other => panic!("{other} is not known here"),
        };
        if !fits {
            return Err(format!("{path}: {value} against {word} {rule}"));
        }
    }
    Ok(())
}

fn fitting(schemas: &Value, value: &Value, path: &str) -> usize {
    let schemas = schemas.as_array().expect("schemas").iter();
    schemas.filter(|schema| check(schema, value, path).is_ok()).count()
}

fn limit(rule: &Value) -> f64 {
    rule.as_f64().expect("a number")
}

fn has_all(table: &Map<String, Value>, keys: &Value) -> bool {
    keys.as_array()
        .expect("keys")
        .iter()
        .all(|key| table.contains_key(key.as_str().expect("a key")))
}

fn has_type(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        other => panic!("{other} is no type"),
    }
}
