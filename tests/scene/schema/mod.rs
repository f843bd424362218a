//! The schema and the page of keys say what the reader of scene files does: its keys, words, defaults and limits, taken one
//! by one from the schema and given to the reader.

mod check;
mod place;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use check::check;
use photonvdb::scene::{Overrides, Preset, SceneError, SceneFile, json_schema, scene_reference};
use place::{Place, pointer};
use serde_json::{Value, json};

const NONSENSE: &str = "qqqqqqqqqqqqqqqqqqqqqqqqqqqqqq";

fn read(scene: &Value) -> Result<SceneFile, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    fs::write(&path, scene.to_string()).unwrap();
    SceneFile::load(&path, &Overrides::default())
}

fn refusal(scene: &Value) -> String {
    read(scene).expect_err(&scene.to_string()).to_string()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Every scene of the repository.
fn scenes() -> Vec<PathBuf> {
    let folders = ["examples/scenes", "tests/scenes", "tests/goldens"];
    let entries = folders.iter().flat_map(|folder| fs::read_dir(root().join(folder)).unwrap());
    let paths = entries.map(|entry| entry.unwrap().path());
    let is_scene = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap();
        name.ends_with(".toml") || name.ends_with("_quad.json")
    };
    paths.filter(is_scene).collect()
}

fn parse(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap();
    if path.extension().unwrap() == "toml" {
        toml::from_str(&text).unwrap()
    } else {
        serde_json::from_str(&text).unwrap()
    }
}

#[test]
fn every_scene_fits_and_none_with_an_unknown_key() {
    let schema = json_schema();
    let scenes = scenes();
    assert!(scenes.len() >= 22, "{}", scenes.len());
    for path in scenes {
        let scene = parse(&path);
        check(&schema, &scene, "").unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let mut tables = vec![String::new()];
        while let Some(table) = tables.pop() {
            let mut broken = scene.clone();
            broken.pointer_mut(&table).unwrap()[NONSENSE] = 1.into();
            assert!(check(&schema, &broken, "").is_err(), "{}: {table}", path.display());
            let inner: Vec<(String, &Value)> = match scene.pointer(&table).unwrap() {
                Value::Object(entries) => entries.iter().map(|(k, v)| (k.clone(), v)).collect(),
                _ => Vec::new(),
            };
            for (key, value) in inner {
                match value {
                    Value::Object(_) => tables.push(format!("{table}/{key}")),
                    Value::Array(items) if items.iter().any(Value::is_object) => {
                        tables.extend((0..items.len()).map(|i| format!("{table}/{key}/{i}")));
                    }
                    _ => {}
                }
            }
        }
    }
}

#[test]
fn the_reader_knows_the_same_keys() {
    let schema = json_schema();
    let mut known: BTreeMap<(String, Option<String>), (BTreeSet<String>, Value)> = BTreeMap::new();
    for place in Place::all(&schema) {
        read(&place.scene).unwrap_or_else(|error| panic!("{error}: {}", place.scene));
        check(&schema, &place.scene, "").unwrap();
        let key = (place.path.clone(), place.kind().map(Into::into));
        let (keys, scene) = known.entry(key).or_default();
        keys.extend(place.properties().keys().cloned());
        *scene = place.scene_with(NONSENSE, 1.into());
    }
    assert!(known.len() >= 16, "{}", known.len());
    for ((path, kind), (keys, scene)) in known {
        let text = refusal(&scene);
        let (_, list) = text.split_once("known here: ").expect(&text);
        let read: BTreeSet<String> = list.split(", ").map(Into::into).collect();
        assert_eq!(read, keys, "{path} {kind:?}");
    }
    let mut scene = Place::all(&schema).remove(0).scene;
    scene[NONSENSE] = json!({});
    let text = refusal(&scene);
    let sections: BTreeSet<&str> = text.split_once("known here: ").unwrap().1.split(", ").collect();
    let expected = schema["properties"].as_object().unwrap();
    assert_eq!(sections, expected.keys().map(String::as_str).collect());
}

#[test]
fn the_reader_knows_the_same_words() {
    let mut kinds: BTreeMap<String, (BTreeSet<String>, Value)> = BTreeMap::new();
    for place in Place::all(&json_schema()) {
        if let Some(kind) = place.kind() {
            let (words, scene) = kinds.entry(place.path.clone()).or_default();
            words.insert(kind.into());
            *scene = place.scene_with("kind", NONSENSE.into());
        }
        for (key, rule) in place.properties() {
            let Some(words) = rule["enum"].as_array() else { continue };
            let words: BTreeSet<String> =
                words.iter().map(|w| w.as_str().unwrap().into()).collect();
            let scene = place.scene_with(key, NONSENSE.into());
            if key == "preset" {
                assert_eq!(words, Preset::ALL.iter().map(|preset| preset.name.into()).collect());
                assert!(refusal(&scene).contains("unknown preset"));
            } else {
                assert_eq!(accepted(&scene), words, "{} {key}", place.path);
            }
        }
    }
    assert_eq!(kinds.len(), 3);
    for (path, (words, scene)) in kinds {
        assert_eq!(accepted(&scene), words, "{path}");
    }
}

fn accepted(scene: &Value) -> BTreeSet<String> {
    let text = refusal(scene);
    let (_, list) = text.split_once("accepted: ").expect(&text);
    list.split(", ").map(|word| word.trim_matches('"').into()).collect()
}

#[test]
fn defaults_are_what_the_reader_fills_in() {
    let mut count = 0;
    for place in Place::all(&json_schema()) {
        for (key, rule) in place.properties() {
            let Some(default) = rule.get("default") else { continue };
            let given = place.scene_with(key, default.clone());
            let mut left_out = given.clone();
            let table = left_out.pointer_mut(&pointer(&place.path)).unwrap();
            table.as_object_mut().unwrap().remove(key);
            // A key of [estimate] makes another scene, but not another section.
            let section = pointer(place.path.split('.').next().unwrap());
            let [given, left_out] = [given, left_out].map(|scene| {
                let file = read(&scene).unwrap_or_else(|error| panic!("{error}: {scene}"));
                serde_json::to_value(file).unwrap().pointer(&section).unwrap().clone()
            });
            assert_eq!(given, left_out, "{} {key}", place.path);
            count += 1;
        }
    }
    assert!(count >= 27, "{count}");
}

#[test]
fn limits_are_those_of_the_reader() {
    let schema = json_schema();
    let mut count = 0;
    for place in Place::all(&schema) {
        for (key, rule) in place.properties() {
            let is_one_or_three = rule["oneOf"][0]["type"] == "number";
            let number = if is_one_or_three { &rule["oneOf"][0] } else { rule };
            if number["type"] != "number" && number["type"] != "integer" {
                continue;
            }
            for (value, fits) in around_limits(number) {
                let scene = place.scene_with(key, value);
                assert_eq!(read(&scene).is_ok(), fits, "{} {key}: {scene}", place.path);
                assert_eq!(check(&schema, &scene, "").is_ok(), fits, "{} {key}", place.path);
                count += 1;
            }
        }
    }
    assert!(count >= 80, "{count}");
}

/// Values at the limits of a number and next to them, and whether they fit.
fn around_limits(rule: &Value) -> Vec<(Value, bool)> {
    let mut values = Vec::new();
    if rule["type"] == "integer" {
        let (min, max) = (rule["minimum"].as_u64().unwrap(), rule["maximum"].as_u64().unwrap());
        values.extend([(json!(min), true), (json!(max), true), (json!(min as i64 - 1), false)]);
        values.extend(max.checked_add(1).map(|beyond| (json!(beyond), false)));
        return values;
    }
    for (word, sign, is_open) in [
        ("minimum", 1.0, false),
        ("exclusiveMinimum", 1.0, true),
        ("maximum", -1.0, false),
        ("exclusiveMaximum", -1.0, true),
    ] {
        let Some(limit) = rule[word].as_f64() else { continue };
        let step = sign * 1e-6 * limit.abs().max(1e-3);
        values.extend([(json!(limit + step), true), (json!(limit), !is_open)]);
        values.push((json!(limit - step), false));
    }
    values
}

/// `PHOTONVDB_REMAKE_DOCS=1 cargo test --test scene schema` writes the page anew.
#[test]
fn the_page_is_that_of_the_program_and_has_every_key() {
    let path = root().join("docs/SCENE.md");
    let page = scene_reference();
    if std::env::var_os("PHOTONVDB_REMAKE_DOCS").is_some() {
        fs::write(&path, &page).unwrap();
    }
    assert_eq!(fs::read_to_string(path).unwrap(), page, "make docs/SCENE.md anew");
    for place in Place::all(&json_schema()) {
        for key in place.properties().keys() {
            assert!(page.contains(&format!("`{key}")), "{} {key}", place.path);
        }
    }
}
