//! Places in a scene where a table of keys stands, taken from the schema, each with a scene that has it.

use serde_json::{Map, Value, json};

/// A table of a scene, in one of its variants.
pub struct Place {
    /// `medium.phase`; lights are the first of their list.
    pub path: String,
    /// Its schema: an object with properties.
    pub schema: Value,
    /// A scene with the keys that the table requires, and no others in it.
    pub scene: Value,
}

impl Place {
    /// Every table of every variant.
    pub fn all(schema: &Value) -> Vec<Place> {
        let mut places = Vec::new();
        for (section, rule) in schema["properties"].as_object().unwrap() {
            let path = if section == "light" { "light.0" } else { section };
            let rule = if section == "light" { &rule["items"] } else { rule };
            collect(path, rule, &minimal_scene(schema), &mut places);
        }
        places
    }

    /// The word that chooses the variant.
    pub fn kind(&self) -> Option<&str> {
        self.schema["properties"]["kind"]["const"].as_str()
    }

    /// The keys and what may stand there.
    pub fn properties(&self) -> &Map<String, Value> {
        self.schema["properties"].as_object().unwrap()
    }

    /// The scene with `key` set in this table.
    pub fn scene_with(&self, key: &str, value: Value) -> Value {
        let mut scene = self.scene.clone();
        let table = scene.pointer_mut(&pointer(&self.path)).unwrap();
        table[key] = value;
        // What the key needs.
        if let Some(need) = self.schema["dependencies"][key]["anyOf"][0]["required"][0].as_str() {
            table[need] = "x".into();
        }
        // One photon alone has no k-1.
        if key == "k" {
            table["divisor"] = "k".into();
        }
        scene
    }
}

/// As JSON pointers are written.
pub fn pointer(path: &str) -> String {
    format!("/{}", path.replace('.', "/"))
}

fn collect(path: &str, rule: &Value, scene: &Value, places: &mut Vec<Place>) {
    for variant in variants(rule).into_iter().filter(|variant| variant["type"] == "object") {
        let mut scene = scene.clone();
        put(&mut scene, path, sample(variant, "", &mut 1));
        for (key, rule) in variant["properties"].as_object().unwrap() {
            if is_table(rule) {
                collect(&format!("{path}.{key}"), rule, &scene, places);
            }
        }
        places.push(Place { path: path.into(), schema: variant.clone(), scene });
    }
}

fn variants(rule: &Value) -> Vec<&Value> {
    rule["oneOf"]
        .as_array()
        .map_or_else(|| vec![rule], |rules| rules.iter().flat_map(variants).collect())
}

fn is_table(rule: &Value) -> bool {
    variants(rule).iter().any(|variant| variant["type"] == "object")
}

fn put(scene: &mut Value, path: &str, value: Value) {
    match path.rsplit_once('.') {
        Some((parent, "0")) => scene[parent] = json!([value]),
        Some((parent, key)) => scene.pointer_mut(&pointer(parent)).unwrap()[key] = value,
        None => scene[path] = value,
    }
}

/// A scene that loads.
fn minimal_scene(schema: &Value) -> Value {
    let sections = &schema["properties"];
    let sample = |rule: &Value| sample(variants(rule)[0], "", &mut 1);
    json!({
        "camera": sample(&sections["camera"]),
        "medium": sample(&sections["medium"]),
        "light": [sample(&sections["light"]["items"])],
    })
}

/// A value that fits. `count` tells places apart, so that no direction is zero and no box is empty.
fn sample(rule: &Value, key: &str, count: &mut u32) -> Value {
    if let Some(rules) = rule["oneOf"].as_array() {
        return sample(&rules[0], key, count);
    }
    if let Some(word) = rule.get("const") {
        return word.clone();
    }
    match rule["type"].as_str().unwrap() {
        "object" => {
            let alternatives = rule["allOf"].as_array().into_iter().flatten();
            let alternatives = alternatives.map(|rules| &rules["anyOf"][0]["required"]);
            let required = [&rule["required"]].into_iter().chain(alternatives);
            let keys = required.flat_map(|keys| keys.as_array().into_iter().flatten());
            let entry = |key: &Value| {
                let key = key.as_str().unwrap();
                (key.to_owned(), sample(&rule["properties"][key], key, count))
            };
            Value::Object(keys.map(entry).collect())
        }
        "array" if key == "matrix" => {
            json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
        }
        "array" => {
            let n = *count;
            *count += 1;
            json!([n, n * n, 3 * n + 1])
        }
        "string" => rule["enum"].get(0).cloned().unwrap_or("x".into()),
        "number" => json!(rule["minimum"].as_f64().map_or(0.5, |least| least.max(0.5))),
        "integer" => rule["minimum"].clone(),
        "boolean" => true.into(),
        other => panic!("{other} is no type"),
    }
}
