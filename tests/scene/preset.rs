//! Presets fill in what a scene does not say, and nothing else.

use std::fs;

use photonvdb::math::Rgb;
use photonvdb::scene::{MediumSection, Overrides, Preset, Scene, SceneFile};

const REST: &str = "
[camera]
position = [0, 0, 5]
look_at = [0, 0, 0]

[[light]]
kind = \"environment\"
radiance = 1
";

const BOX: &str = "bounds = { min = [-1, -1, -1], max = [1, 1, 1] }";

fn read(medium: &str) -> Result<SceneFile, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, format!("[medium]\n{medium}\n{REST}")).unwrap();
    SceneFile::load(&path, &Overrides::default()).map_err(|error| error.to_string())
}

#[test]
fn a_preset_is_what_its_file_says() {
    for preset in Preset::ALL {
        let named = read(&format!("kind = \"homogeneous\"\n{BOX}\npreset = \"{}\"", preset.name));
        let written = read(&format!("kind = \"homogeneous\"\n{BOX}\n{}", preset.text));
        assert_eq!(named.unwrap(), written.unwrap(), "{}", preset.name);
    }
}

#[test]
fn what_the_scene_says_comes_first() {
    let file = read(&format!("kind = \"homogeneous\"\n{BOX}\npreset = \"fog\"\nalbedo = 0.5"));
    let MediumSection::Homogeneous { sigma_t, albedo, phase, .. } = file.unwrap().media.remove(0)
    else {
        panic!("homogeneous");
    };
    assert_eq!(albedo, Rgb::splat(0.5));
    assert_eq!(sigma_t, Rgb::splat(0.01956));
    assert_eq!(serde_json::to_value(phase).unwrap()["g"], 0.854);
}

#[test]
fn in_a_volume_sigma_t_is_the_extinction_of_value_1() {
    let scale = |more: &str| {
        let file = read(&format!("kind = \"vdb\"\nfile = \"a.vdb\"\npreset = \"steam\"\n{more}"));
        match file.unwrap().media.remove(0) {
            MediumSection::Vdb { density_scale, .. } => density_scale,
            MediumSection::Homogeneous { .. } => panic!("a volume"),
        }
    };
    assert_eq!(scale(""), 0.339);
    assert_eq!(scale("density_scale = 7"), 7.0);
    // Milk has an extinction for each channel, a grid has one.
    let milk = "kind = \"vdb\"\nfile = \"a.vdb\"\npreset = \"whole-milk\"";
    let error = read(milk).unwrap_err();
    assert!(error.contains("scene.toml:4: medium.preset") && error.contains("give density_scale"));
    assert!(read(&format!("{milk}\ndensity_scale = 2000")).is_ok());
}

#[test]
fn names_that_are_none_are_told_with_their_line() {
    let error = read(&format!("kind = \"homogeneous\"\n{BOX}\npreset = \"fgo\"")).unwrap_err();
    assert!(
        error
            .contains("scene.toml:4: medium.preset: unknown preset \"fgo\"; did you mean \"fog\"?"),
        "{error}"
    );
    let error = read(&format!("kind = \"homogeneous\"\n{BOX}\npreset = 3")).unwrap_err();
    assert!(error.contains("expected the name of a preset, found 3"), "{error}");
    let error = read(&format!("kind = \"homogeneous\"\n{BOX}\nprest = \"fog\"")).unwrap_err();
    assert!(error.contains("did you mean \"preset\"?"), "{error}");
}

/// Reduced scattering and absorption \[1/mm\] of the tables that the presets cite.
#[test]
fn milks_have_the_coefficients_of_their_tables() {
    for (name, reduced, absorption) in [
        ("whole-milk", [2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014]),
        ("skim-milk", [0.70, 1.22, 1.90], [0.0014, 0.0025, 0.0142]),
        ("regular-milk", [4.5513, 5.8294, 7.136], [0.001533, 0.0046, 0.019933]),
        ("lowfat-milk", [0.89187, 1.5136, 2.532], [0.002875, 0.00575, 0.0115]),
    ] {
        let file = read(&format!("kind = \"homogeneous\"\n{BOX}\npreset = \"{name}\"")).unwrap();
        let MediumSection::Homogeneous { sigma_t, albedo, phase, .. } = file.media[0] else {
            panic!("homogeneous");
        };
        let g = serde_json::to_value(phase).unwrap()["g"].as_f64().unwrap_or(0.0);
        let found = sigma_t * albedo * (1.0 - g) / 1000.0;
        assert!(
            (found / Rgb::from_array(reduced) - 1.0).abs().max_element() < 1e-3,
            "{name} {found}"
        );
        let found = sigma_t * (1.0 - albedo) / 1000.0;
        // Albedos are rounded to six digits.
        let error = (found - Rgb::from_array(absorption)).abs() / (sigma_t / 1000.0);
        assert!(error.max_element() < 6e-7, "{name} {found}");
    }
}

#[test]
fn a_preset_and_its_figures_are_the_same_scene() {
    let folder = tempfile::tempdir().unwrap();
    let hash = |name: &str, medium: &str| {
        let path = folder.path().join(name);
        fs::write(&path, format!("[medium]\nkind = \"homogeneous\"\n{BOX}\n{medium}\n{REST}"))
            .unwrap();
        Scene::load(&path).unwrap().hash
    };
    let fog = Preset::find("fog").unwrap();
    assert_eq!(hash("a.toml", "preset = \"fog\""), hash("b.toml", fog.text));
}
