//! The example scenes load, and their plans say what they need.

use std::path::{Path, PathBuf};

use photonvdb::scene::{Overrides, Plan, Scene, SceneFile};

fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes");
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_scene = |path: &PathBuf| path.extension().is_some_and(|e| e == "toml" || e == "json");
    let mut scenes: Vec<_> = entries.filter(is_scene).collect();
    scenes.sort();
    scenes
}

#[test]
fn every_example_loads_without_a_warning() {
    assert!(examples().len() >= 7);
    for path in examples() {
        let scene = Scene::load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.warnings, Vec::<String>::new(), "{}", path.display());
        let plan = Plan::of(&scene);
        println!("{}: {plan}", path.display());
        assert!(plan.expected_stored > 0, "{}", path.display());
    }
}

#[test]
fn a_scene_file_written_again_reads_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for path in examples() {
        let file = SceneFile::load(&path, &Overrides::default()).unwrap();
        let toml = folder.path().join("again.toml");
        let json = folder.path().join("again.json");
        std::fs::write(&toml, toml::to_string(&file).unwrap()).unwrap();
        std::fs::write(&json, serde_json::to_string(&file).unwrap()).unwrap();
        for again in [toml, json] {
            let read = SceneFile::load(&again, &Overrides::default());
            assert_eq!(read.unwrap_or_else(|error| panic!("{error}")), file);
        }
    }
}

#[test]
fn plans_read_as_a_sentence() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes");
    let first_line = |name: &str| {
        let plan = Plan::of(&Scene::load(&folder.join(name)).unwrap()).to_string();
        plan.lines().next().unwrap().to_owned()
    };
    assert_eq!(
        first_line("fog_point.toml"),
        "homogeneous, isotropic, 1 point light: no grid, no majorants, no emission"
    );
    assert_eq!(
        first_line("fog_sky.toml"),
        "homogeneous, isotropic, chromatic, 1 environment light: no grid, no majorants, no emission"
    );
    assert_eq!(
        first_line("fire_smoke.toml"),
        "density grid, anisotropic (mean cosine 0.20), chromatic, 1 spot light, 1 sphere light: majorants, no emission"
    );
}
