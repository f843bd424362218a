//! The hash of a scene tells scenes apart and nothing else.

use std::collections::HashSet;
use std::path::Path;

use photonvdb::scene::{Overrides, Scene};

const SCENE: &str = r#"[camera]
position = [0, 1, 6]
look_at = [0, 0, 0]

[medium]
kind = "homogeneous"
bounds = { min = [-1, -1, -1], max = [1, 1, 1] }
sigma_t = 1.0
albedo = 0.5

[[light]]
kind = "point"
position = [0, 2, 0]
intensity = 1.0

[photons]
count = 1000
"#;

fn load(folder: &Path, name: &str, text: &str) -> Scene {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    Scene::load(&path).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn form_does_not_matter() {
    let folder = tempfile::tempdir().unwrap();
    let hash = |name: &str, text: &str| load(folder.path(), name, text).hash;
    let expected = hash("a.toml", SCENE);
    let json = r#"{"light": [{"intensity": [1, 1, 1], "position": [0.0, 2e0, 0], "kind": "point"}],
        "photons": {"count": 1000, "seed": 0}, "render": {"gather": "auto"},
        "medium": {"albedo": 0.5, "sigma_t": 1, "kind": "homogeneous", "phase": {},
                   "bounds": {"max": [1, 1, 1], "min": [-1, -1, -1]}},
        "camera": {"look_at": [0, 0, 0], "position": [0, 1, 6], "vertical_fov": 35}}"#;
    assert_eq!(hash("b.json", json), expected);
    let spaced = SCENE.replace(" = ", "=").replace('\n', "\r\n\r\n").replace("1000", "1_000 # few");
    assert_eq!(hash("c.toml", &format!("\u{feff}{spaced}")), expected);
}

#[test]
fn every_value_matters() {
    let folder = tempfile::tempdir().unwrap();
    let edits = [
        ("", ""),
        ("1, 6]", "1, 6.0000001]"),
        ("look_at = [0, 0, 0]", "look_at = [0, 0, 1]"),
        ("look_at = [0, 0, 0]", "look_at = [0, 0, 0]\nup = [0, 1, 1]"),
        ("look_at = [0, 0, 0]", "look_at = [0, 0, 0]\nvertical_fov = 36"),
        ("look_at = [0, 0, 0]", "look_at = [0, 0, 0]\nresolution = [360, 640]"),
        ("-1, -1]", "-1, -2]"),
        ("{ min = [-1, -1, -1], max = [1, 1, 1] }", "{ center = [-1, -1, -1], radius = 1 }"),
        ("{ min = [-1, -1, -1], max = [1, 1, 1] }", "\"infinite\""),
        ("sigma_t = 1.0", "sigma_t = 1.0000000000000002"),
        ("albedo = 0.5", "albedo = [0.5, 0.5, 0.6]"),
        ("albedo = 0.5", "albedo = 0.5\nphase = { kind = \"henyey-greenstein\", g = 0.1 }"),
        (
            "\"point\"\nposition = [0, 2, 0]\nintensity",
            "\"directional\"\ndirection = [0, 2, 0]\nirradiance",
        ),
        ("[0, 2, 0]", "[2, 0, 0]"),
        ("intensity = 1.0", "intensity = 2.0"),
        ("count = 1000", "count = 1001"),
        ("count = 1000", "count = 1000\nemission = \"random\""),
        ("count = 1000", "count = 1000\nseed = 18446744073709551615"),
        ("count = 1000", "count = 1000\nmax_order = 1"),
        ("[photons]", "[estimate]\nk = 99\n[photons]"),
        ("[photons]", "[estimate]\ndivisor = \"k\"\n[photons]"),
        ("[photons]", "[estimate]\nkernel = \"epanechnikov\"\n[photons]"),
        ("[photons]", "[estimate]\nmax_radius = 1\n[photons]"),
        ("[photons]", "[render]\nsamples_per_pixel = 1\n[photons]"),
        ("[photons]", "[render]\ngather = \"knn\"\n[photons]"),
        ("[photons]", "[render]\nlattice = 20\n[photons]"),
        ("[photons]", "[render]\nmarch_samples = 1\n[photons]"),
        ("[photons]", "[render]\nlight_samples = 1\n[photons]"),
        ("[photons]", "[render]\nphotons_only = true\n[photons]"),
    ];
    let hash = |(from, to): &(&str, &str)| {
        assert!(SCENE.contains(from), "not in the scene: {from}");
        load(folder.path(), "a.toml", &SCENE.replacen(from, to, 1)).hash
    };
    let hashes: HashSet<u64> = edits.iter().map(hash).collect();
    assert_eq!(hashes.len(), edits.len());
}

#[test]
fn an_override_counts_as_the_value_it_replaces() {
    let folder = tempfile::tempdir().unwrap();
    let edited = SCENE.replace("count = 1000", "count = 2000\nemission = \"sobol\"\nseed = 9")
        + "[estimate]\nk = 7\ndivisor = \"k-1/2\"\n[render]\nphotons_only = true\n";
    let edited = edited.replace("look_at", "resolution = [32, 18]\nlook_at");
    let expected = load(folder.path(), "b.toml", &edited);
    let path = folder.path().join("a.toml");
    std::fs::write(&path, SCENE).unwrap();
    let overrides = Overrides {
        photons: Some(2000),
        emission: Some("sobol".into()),
        seed: Some(9),
        k: Some(7),
        divisor: Some("k-1/2".into()),
        resolution: Some([32, 18]),
        photons_only: Some(true),
        ..Overrides::default()
    };
    let scene = Scene::load_with(&path, &overrides).unwrap();
    assert_eq!(scene.hash, expected.hash);
    assert_eq!((scene.photons, scene.estimate), (expected.photons, expected.estimate));
    assert_eq!((scene.camera.width, scene.camera.height), (32, 18));
}
