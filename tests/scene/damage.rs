//! No scene file, however damaged, does worse than give an error that names it.

use std::path::Path;

use photonvdb::scene::Scene;

const SCENE: &str = r#"[camera]
position = [0, 1, 6]
look_at = [0, 0, 0]
vertical_fov = 35.0
[medium]
kind = "homogeneous"
bounds = { center = [0, 0, 0], radius = 1 }
sigma_t = 1e0
albedo = [0.9, 0.8, 0.7]
phase = { kind = "henyey-greenstein", g = 0.5 }
[[light]]
kind = "spot"
position = [0, 3, 0]
look_at = [0, 0, 0]
intensity = [1, 2, 3]
cone_angle = 20
[estimate]
k = 50
"#;

/// The same scene in the other format.
fn json() -> String {
    serde_json::to_string(&SCENE.parse::<toml::Table>().unwrap()).unwrap()
}

/// Loads a text; true if it is a scene.
fn is_scene(path: &Path, text: &[u8]) -> bool {
    std::fs::write(path, text).unwrap();
    match Scene::load(path) {
        Ok(_) => true,
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with(&path.display().to_string()), "{message}");
            false
        }
    }
}

fn every_damage(name: &str, text: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    assert!(is_scene(&path, text.as_bytes()));
    let mut survivors = 0;
    for at in 0..text.len() {
        is_scene(&path, &text.as_bytes()[..at]);
        for byte in *b"\x00\"]-9" {
            let mut damaged = text.as_bytes().to_vec();
            damaged[at] = byte;
            survivors += usize::from(is_scene(&path, &damaged));
        }
    }
    // Digits may change without harm, brackets may not.
    assert!(survivors > 50 && survivors < text.len() * 3, "{survivors}");
}

#[test]
fn damaged_toml_is_refused_or_read() {
    every_damage("s.toml", SCENE);
}

#[test]
fn damaged_json_is_refused_or_read() {
    every_damage("s.json", &json());
}
