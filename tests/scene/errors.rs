//! Every mistake in a scene file gives one sentence that names file, line and key, and says what to do.

use std::path::Path;

use photonvdb::scene::{Overrides, Scene};

/// A scene of every section and every kind of light, to be spoilt one line at a time.
const SCENE: &str = r#"[camera]
position = [0, 1, 6]
look_at = [0, 0, 0]
up = [0, 1, 0]
vertical_fov = 35.0
resolution = [64, 36]

[medium]
kind = "homogeneous"
bounds = { min = [-1, -1, -1], max = [1, 1, 1] }
sigma_t = 1.0
albedo = [0.9, 0.8, 0.7]
phase = { kind = "henyey-greenstein", g = 0.5 }

[[light]]
kind = "point"
position = [0, 2, 0]
intensity = 1.0

[[light]]
kind = "spot"
position = [0, 3, 0]
look_at = [0, 0, 0]
intensity = [1, 2, 3]
cone_angle = 20
falloff_angle = 10

[[light]]
kind = "directional"
direction = [0, -1, 0]
irradiance = 2

[[light]]
kind = "environment"
radiance = 0.1

[[light]]
kind = "quad"
corner = [-1, 2, -1]
edge_u = [2, 0, 0]
edge_v = [0, 0, 2]
radiance = 1

[[light]]
kind = "sphere"
center = [3, 0, 0]
radius = 0.5
radiance = 1

[photons]
count = 1000
emission = "stratified"
seed = 7
max_order = 100

[estimate]
k = 50
divisor = "k-1"
kernel = "constant"
max_radius = 0.5

[render]
samples_per_pixel = 4
march_samples = 8
light_samples = 4
photons_only = false
"#;

const VDB: &str = r#"kind = "vdb"
file = "absent.vdb"
density = "density"
density_scale = 2.0
albedo = 0.9
transform = { translate = [0, 0, 0], rotate = [0, 90, 0], scale = 1.0 }"#;

/// Where the medium's keys stand in `SCENE`.
const HOMOGENEOUS: &str = r#"kind = "homogeneous"
bounds = { min = [-1, -1, -1], max = [1, 1, 1] }
sigma_t = 1.0
albedo = [0.9, 0.8, 0.7]
phase = { kind = "henyey-greenstein", g = 0.5 }"#;

/// What a scene of this name and text is refused with, without the name of its folder.
fn refusal_of(name: &str, text: &str, overrides: &Overrides) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    let error = Scene::load_with(&path, overrides).expect_err(text).to_string();
    assert!(!error.contains('\n'), "more than one line: {error}");
    error.replace(&format!("{}/", folder.path().display()), "")
}

fn refusal(text: &str) -> String {
    refusal_of("s.toml", text, &Overrides::default())
}

#[test]
fn the_unspoilt_scene_loads() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    std::fs::write(&path, SCENE).unwrap();
    let scene = Scene::load(&path).unwrap();
    assert_eq!(scene.lights.len(), 6);
    assert_eq!(scene.estimate.k, 50);
}

/// What is replaced in `SCENE`, what by, and the whole message.
#[rustfmt::skip]
const SPOILT: &[(&str, &str, &str)] = &[
    // camera
    ("[camera]", "[kamera]", "s.toml:1: kamera: unknown key; did you mean \"camera\"?"),
    ("position = [0, 1, 6]\n", "", "s.toml:1: camera.position: missing key; expected a list of 3 numbers"),
    ("[0, 1, 6]", "[0, 1]", "s.toml:2: camera.position: expected a list of 3 numbers, found [0, 1]"),
    ("[0, 1, 6]", "[0, nan, 6]", "s.toml:2: camera.position: numbers must be finite and of magnitude up to 1e30, found [0, NaN, 6]"),
    ("[0, 1, 6]", "[0, 1, 6, 7, 8]", "s.toml:2: camera.position: expected a list of 3 numbers, found a list of 5"),
    ("[0, 1, 6]", "\"here\"", "s.toml:2: camera.position: expected a list of 3 numbers, found \"here\""),
    ("look_at = [0, 0, 0]\nup", "look_at = [0, 1, 6]\nup", "s.toml:3: camera.look_at: must not be the camera's position"),
    ("up = [0, 1, 0]", "up = [0, 2, 12]", "s.toml:4: camera.up: must not be parallel to the view (look_at - position), found [0, 2, 12]"),
    ("up = [0, 1, 0]", "up = [0, 0, 0]", "s.toml:4: camera.up: must be a direction, found no length"),
    ("vertical_fov = 35.0", "vertical_fov = 180", "s.toml:5: camera.vertical_fov: must lie in (0, 180) degrees, found 180"),
    ("vertical_fov = 35.0", "vertical_fov = 0", "s.toml:5: camera.vertical_fov: must lie in (0, 180) degrees, found 0"),
    ("vertical_fov = 35.0", "vertical_fov = inf", "s.toml:5: camera.vertical_fov: numbers must be finite and of magnitude up to 1e30, found inf"),
    ("vertical_fov = 35.0", "fov = 35.0", "s.toml:5: camera.fov: unknown key; known here: position, look_at, up, vertical_fov, resolution"),
    ("vertical_fov", "vertical_fow", "s.toml:5: camera.vertical_fow: unknown key; did you mean \"vertical_fov\"?"),
    ("[64, 36]", "[64, 0]", "s.toml:6: camera.resolution: each side must lie in 1 to 16384 pixels, found [64, 0]"),
    ("[64, 36]", "[64, 16385]", "s.toml:6: camera.resolution: each side must lie in 1 to 16384 pixels, found [64, 16385]"),
    ("[64, 36]", "[64, -36]", "s.toml:6: camera.resolution: expected a list of 2 integers, found [64, -36]"),
    ("[64, 36]", "[64.5, 36]", "s.toml:6: camera.resolution: expected a list of 2 integers, found [64.5, 36]"),
    // medium
    ("kind = \"homogeneous\"\n", "", "s.toml:8: medium.kind: missing key; accepted: \"homogeneous\", \"vdb\""),
    ("\"homogeneous\"", "\"fog\"", "s.toml:9: medium.kind: unknown value \"fog\"; accepted: \"homogeneous\", \"vdb\""),
    ("\"homogeneous\"", "3", "s.toml:9: medium.kind: expected text in quotes, found 3"),
    ("bounds = { min = [-1, -1, -1], max = [1, 1, 1] }\n", "", "s.toml:8: medium.bounds: missing; expected { min = [x, y, z], max = [x, y, z] }, { center = [x, y, z], radius = r } or \"infinite\""),
    ("{ min = [-1, -1, -1], max = [1, 1, 1] }", "\"everywhere\"", "s.toml:10: medium.bounds: unknown value \"everywhere\"; accepted: \"infinite\""),
    ("{ min = [-1, -1, -1], max = [1, 1, 1] }", "1.0", "s.toml:10: medium.bounds: expected a table, found 1"),
    ("max = [1, 1, 1] }", "max = [1, 1, 1], radius = 1 }", "s.toml:10: medium.bounds: give either min and max or center and radius, not both"),
    ("max = [1, 1, 1] }", "maxi = [1, 1, 1] }", "s.toml:10: medium.bounds.maxi: unknown key; did you mean \"max\"?"),
    (", max = [1, 1, 1] }", " }", "s.toml:10: medium.bounds.max: missing key; expected a list of 3 numbers"),
    ("max = [1, 1, 1] }", "max = [1, -1, 1] }", "s.toml:10: medium.bounds.max: must be above min = [-1, -1, -1] on every axis, found [1, -1, 1]"),
    ("max = [1, 1, 1] }", "max = [1, 1, -2] }", "s.toml:10: medium.bounds.max: must be above min = [-1, -1, -1] on every axis, found [1, 1, -2]"),
    ("{ min = [-1, -1, -1], max = [1, 1, 1] }", "{ center = [0, 0, 0], radius = 0 }", "s.toml:10: medium.bounds.radius: must be above 0, found 0"),
    ("{ min = [-1, -1, -1], max = [1, 1, 1] }", "{ center = [0, 0, 0] }", "s.toml:10: medium.bounds.radius: missing key; expected a number"),
    ("sigma_t = 1.0\n", "", "s.toml:8: medium.sigma_t: missing key; expected a number or a list of 3 numbers"),
    ("sigma_t = 1.0", "sigma_t = -1.0", "s.toml:11: medium.sigma_t: must not be below 0, found -1"),
    ("sigma_t = 1.0", "sigma_t = [1, 2, -3]", "s.toml:11: medium.sigma_t: must not be below 0, found [1, 2, -3]"),
    ("sigma_t = 1.0", "sigma_t = [1, 2]", "s.toml:11: medium.sigma_t: expected a number or a list of 3 numbers, found [1, 2]"),
    ("sigma_t = 1.0", "sigma_t = 1e31", "s.toml:11: medium.sigma_t: numbers must be finite and of magnitude up to 1e30, found 10000000000000000000000000000000"),
    ("sigma_t = 1.0", "sigma_t = 2020-01-01", "s.toml:11: medium.sigma_t: expected a number or a list of 3 numbers, found a date"),
    ("sigma_t = 1.0", "sigma_s = 1.0", "s.toml:11: medium.sigma_s: unknown key; did you mean \"sigma_t\"?"),
    ("sigma_t = 1.0", "sigma_t = 1.0\nfile = \"a.vdb\"", "s.toml:12: medium.file: belongs to kind \"vdb\", but this kind is \"homogeneous\""),
    ("sigma_t = 1.0", "sigma_t = 1.0\ntemperature = \"heat\"", "s.toml:12: medium.temperature: belongs to kind \"vdb\", but this kind is \"homogeneous\""),
    ("0.7]", "1.7]", "s.toml:12: medium.albedo: must lie in [0, 1], found [0.9, 0.8, 1.7]"),
    ("[0.9, 0.8, 0.7]", "-0.1", "s.toml:12: medium.albedo: must lie in [0, 1], found -0.1"),
    ("albedo = [0.9, 0.8, 0.7]\n", "", "s.toml:8: medium.albedo: missing key; expected a number or a list of 3 numbers"),
    ("g = 0.5", "gg = 0.5", "s.toml:13: medium.phase.gg: unknown key; did you mean \"g\"?"),
    ("g = 0.5", "g = 1", "s.toml:13: medium.phase.g: must lie in (-1, 1), found 1"),
    ("g = 0.5", "g = -1.5", "s.toml:13: medium.phase.g: must lie in (-1, 1), found -1.5"),
    (", g = 0.5", "", "s.toml:13: medium.phase.g: missing key; expected a number"),
    ("henyey-greenstein", "isotropic", "s.toml:13: medium.phase.g: belongs to kind \"henyey-greenstein\", but this kind is \"isotropic\""),
    ("henyey-greenstein", "hg", "s.toml:13: medium.phase.kind: unknown value \"hg\"; accepted: \"isotropic\", \"henyey-greenstein\", \"double-henyey-greenstein\", \"draine\", \"droplets\""),
    ("g = 0.5", "alpha = 1", "s.toml:13: medium.phase.alpha: belongs to kind \"draine\", but this kind is \"henyey-greenstein\""),
    ("\"henyey-greenstein\"", "\"draine\"", "s.toml:13: medium.phase.alpha: missing key; expected a number"),
    ("\"henyey-greenstein\"", "\"draine\", alpha = -1", "s.toml:13: medium.phase.alpha: must not be below 0, found -1"),
    ("\"henyey-greenstein\", g", "\"double-henyey-greenstein\", g2 = 0, weight = 1.5, g1", "s.toml:13: medium.phase.weight: must lie in [0, 1], found 1.5"),
    ("\"henyey-greenstein\", g", "\"double-henyey-greenstein\", g2 = 1, weight = 1, g1", "s.toml:13: medium.phase.g2: must lie in (-1, 1), found 1"),
    ("\"henyey-greenstein\", g", "\"droplets\", diameter_um", "s.toml:13: medium.phase.diameter_um: must lie in [5, 50], the micrometres that the fit is made for, found 0.5"),
    ("\"henyey-greenstein\", g", "\"droplets\", diameter", "s.toml:13: medium.phase.diameter: unknown key; did you mean \"diameter_um\"?"),
    ("phase = { kind = \"henyey-greenstein\", g = 0.5 }", "phase = \"isotropic\"", "s.toml:13: medium.phase: expected a table, found \"isotropic\""),
    // lights
    ("\"point\"", "\"bulb\"", "s.toml:16: light[0].kind: unknown value \"bulb\"; accepted: \"point\", \"spot\", \"directional\", \"environment\", \"quad\", \"sphere\""),
    ("kind = \"point\"\n", "", "s.toml:15: light[0].kind: missing key; accepted: \"point\", \"spot\", \"directional\", \"environment\", \"quad\", \"sphere\""),
    ("intensity = 1.0", "intensity = -1.0", "s.toml:18: light[0].intensity: must not be below 0, found -1"),
    ("intensity = 1.0", "intensty = 1.0", "s.toml:18: light[0].intensty: unknown key; did you mean \"intensity\"?"),
    ("intensity = 1.0", "intensity = 1.0\ncone_angle = 3", "s.toml:19: light[0].cone_angle: belongs to kind \"spot\", but this kind is \"point\""),
    ("intensity = 1.0", "radiance = 1.0", "s.toml:18: light[0].radiance: belongs to kind \"environment\", but this kind is \"point\""),
    ("intensity = [1, 2, 3]\n", "", "s.toml:20: light[1].intensity: missing key; expected a number or a list of 3 numbers"),
    ("look_at = [0, 0, 0]\nintensity", "look_at = [0, 3, 0]\nintensity", "s.toml:23: light[1].look_at: must not be the light's position, found [0, 3, 0]"),
    ("cone_angle = 20", "cone_angle = 180", "s.toml:25: light[1].cone_angle: must lie in [0.001, 180) degrees, found 180"),
    ("cone_angle = 20", "cone_angle = 0", "s.toml:25: light[1].cone_angle: must lie in [0.001, 180) degrees, found 0"),
    ("falloff_angle = 10", "falloff_angle = 21", "s.toml:26: light[1].falloff_angle: must lie between 0 and cone_angle = 20, found 21"),
    ("falloff_angle = 10", "falloff_angle = -1", "s.toml:26: light[1].falloff_angle: must lie between 0 and cone_angle = 20, found -1"),
    ("direction = [0, -1, 0]", "direction = [0, 0, 0]", "s.toml:30: light[2].direction: must have a length, found [0, 0, 0]"),
    ("irradiance = 2", "irradiance = [1, 1, -2]", "s.toml:31: light[2].irradiance: must not be below 0, found [1, 1, -2]"),
    ("radiance = 0.1", "", "s.toml:33: light[3].radiance: missing key; give radiance or file"),
    ("radiance = 0.1", "radiance = 0.1\nfile = \"sky.exr\"", "s.toml:35: light[3].radiance: give either radiance or file, not both"),
    ("radiance = 0.1", "radiance = 0.1\nscale = 2", "s.toml:36: light[3].scale: applies to an image only; give file too"),
    ("radiance = 0.1", "file = \"sky.exr\"\nscale = -1", "s.toml:36: light[3].scale: must not be below 0, found -1"),
    ("radiance = 0.1", "file = \"sky.exr\"", "s.toml:35: light[3].file: cannot read sky.exr: No such file or directory (os error 2)"),
    ("edge_v = [0, 0, 2]", "edge_v = [4, 0, 0]", "s.toml:41: light[4].edge_v: must not be zero or parallel to edge_u, found [4, 0, 0]"),
    ("radius = 0.5", "radius = -0.5", "s.toml:47: light[5].radius: must be above 0, found -0.5"),
    ("[[light]]\nkind = \"sphere\"", "[lights]\nkind = \"sphere\"", "s.toml:44: lights: unknown key; did you mean \"light\"?"),
    // photons
    ("count = 1000", "count = 0", "s.toml:51: photons.count: must lie in 1 to 10^12, found 0"),
    ("count = 1000", "count = -5", "s.toml:51: photons.count: expected an integer from 0 to 2^64 - 1, found -5"),
    ("count = 1000", "count = 1e6", "s.toml:51: photons.count: expected an integer from 0 to 2^64 - 1, found 1000000"),
    ("count = 1000", "count = 1000000000001", "s.toml:51: photons.count: must lie in 1 to 10^12, found 1000000000001"),
    ("\"stratified\"", "\"jittered\"", "s.toml:52: photons.emission: unknown value \"jittered\"; accepted: \"random\", \"stratified\", \"sobol\""),
    ("seed = 7", "seed = 0.5", "s.toml:53: photons.seed: expected an integer from 0 to 2^64 - 1, found 0.5"),
    ("max_order = 100", "max_order = 0", "s.toml:54: photons.max_order: must lie in 1 to 4294967295, found 0"),
    ("max_order = 100", "max_order = 4294967296", "s.toml:54: photons.max_order: must lie in 1 to 4294967295, found 4294967296"),
    // estimate
    ("k = 50", "k = 0", "s.toml:57: estimate.k: must lie in 1 to 1000000, found 0"),
    ("k = 50", "k = 1", "s.toml:57: estimate.k: must be at least 2 with divisor \"k-1\", found 1"),
    ("divisor = \"k-1\"", "divisor = \"k-2\"", "s.toml:58: estimate.divisor: unknown value \"k-2\"; accepted: \"k\", \"k-1\", \"k-1/2\", \"calibrated\""),
    ("k = 50\ndivisor = \"k-1\"", "k = 1\ndivisor = \"calibrated\"", "s.toml:57: estimate.k: must be at least 2 with divisor \"calibrated\", found 1"),
    ("kernel = \"constant\"", "kernel = \"cone\"", "s.toml:59: estimate.kernel: unknown value \"cone\"; accepted: \"constant\", \"epanechnikov\""),
    ("max_radius = 0.5", "max_radius = 0", "s.toml:60: estimate.max_radius: must be above 0, found 0"),
    ("max_radius = 0.5", "radius = 0.5", "s.toml:60: estimate.radius: unknown key; did you mean \"max_radius\"?"),
    // render
    ("samples_per_pixel = 4", "samples_per_pixel = 0", "s.toml:63: render.samples_per_pixel: must lie in 1 to 65536, found 0"),
    ("march_samples = 8", "march_samples = 70000", "s.toml:64: render.march_samples: must lie in 1 to 65536, found 70000"),
    ("light_samples = 4", "light_samples = true", "s.toml:65: render.light_samples: expected an integer from 0 to 2^64 - 1, found true"),
    ("photons_only = false", "photons_only = 0", "s.toml:66: render.photons_only: expected true or false, found 0"),
];

#[test]
fn every_spoilt_line_is_named() {
    let mut wrong = Vec::new();
    for (line, spoilt, expected) in SPOILT {
        assert!(SCENE.contains(line), "not in the scene: {line}");
        let message = refusal(&SCENE.replacen(line, spoilt, 1));
        if message != *expected {
            wrong.push(format!(
                "{line:?} -> {spoilt:?}\n  expected {expected}\n  found    {message}"
            ));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), SPOILT.len(), wrong.join("\n"));
}

/// What is replaced in `VDB`, what by, and the whole message.
#[rustfmt::skip]
const SPOILT_VDB: &[(&str, &str, &str)] = &[
    ("", "", "s.toml:10: medium.file: cannot read absent.vdb: No such file or directory (os error 2)"),
    ("file = \"absent.vdb\"\n", "", "s.toml:8: medium.file: missing key; expected text in quotes"),
    ("density_scale = 2.0", "density_scale = -2.0", "s.toml:12: medium.density_scale: must not be below 0, found -2"),
    ("density_scale = 2.0", "density_scal = 2.0", "s.toml:12: medium.density_scal: unknown key; did you mean \"density_scale\"?"),
    ("density_scale = 2.0", "sigma_t = 2.0", "s.toml:12: medium.sigma_t: belongs to kind \"homogeneous\", but this kind is \"vdb\""),
    ("density_scale = 2.0", "bounds = \"infinite\"", "s.toml:12: medium.bounds: belongs to kind \"homogeneous\", but this kind is \"vdb\""),
    ("density_scale = 2.0", "emission_scale = 2.0", "s.toml:12: medium.emission_scale: needs temperature or flame, the name of a grid that glows"),
    ("density_scale = 2.0", "temperature_scale = 2.0", "s.toml:12: medium.temperature_scale: needs temperature, the name of a grid"),
    ("density_scale = 2.0", "flame_color = 2.0", "s.toml:12: medium.flame_color: needs flame, the name of a grid"),
    ("density_scale = 2.0", "temperature = 1500", "s.toml:12: medium.temperature: expected text in quotes, found 1500"),
    ("density_scale = 2.0", "temperature = \"heat\"\ntemperature_scale = -1", "s.toml:13: medium.temperature_scale: must not be below 0, found -1"),
    ("density_scale = 2.0", "flame = \"flame\"\nflame_color = [1, -1, 0]", "s.toml:13: medium.flame_color: must not be below 0, found [1, -1, 0]"),
    ("density_scale = 2.0", "flame = \"flame\"\nemission_scale = -1", "s.toml:13: medium.emission_scale: must not be below 0, found -1"),
    ("density_scale = 2.0", "color = 3", "s.toml:12: medium.color: expected text in quotes, found 3"),
    ("density = \"density\"", "density = 1", "s.toml:11: medium.density: expected text in quotes, found 1"),
    ("albedo = 0.9", "albedo = 9", "s.toml:13: medium.albedo: must lie in [0, 1], found 9"),
    ("scale = 1.0 }", "scale = [1, 0, 1] }", "s.toml:14: medium.transform.scale: must not be 0, found [1, 0, 1]"),
    ("rotate", "rotation", "s.toml:14: medium.transform.rotation: unknown key; did you mean \"rotate\"?"),
    ("rotate = [0, 90, 0]", "rotate = 90", "s.toml:14: medium.transform.rotate: expected a list of 3 numbers, found 90"),
    ("scale = 1.0 }", "matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1] }", "s.toml:14: medium.transform.translate: give either matrix or translate, rotate and scale, not both"),
    ("{ translate = [0, 0, 0], rotate = [0, 90, 0], scale = 1.0 }", "{ matrix = [1, 0, 0] }", "s.toml:14: medium.transform.matrix: expected a list of 16 numbers, found [1, 0, 0]"),
    ("{ translate = [0, 0, 0], rotate = [0, 90, 0], scale = 1.0 }", "{ matrix = [1,0,0,0, 0,1,0,0, 1,1,0,0, 0,0,0,1] }", "s.toml:14: medium.transform.matrix: must be invertible: it flattens the volume, found a list of 16"),
    ("{ translate = [0, 0, 0], rotate = [0, 90, 0], scale = 1.0 }", "{ matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 1,0,0,1] }", "s.toml:14: medium.transform.matrix: the last of the 4 rows must be 0, 0, 0, 1, found a list of 16"),
];

#[test]
fn every_spoilt_line_of_a_volume_is_named() {
    for (line, spoilt, expected) in SPOILT_VDB {
        assert!(VDB.contains(line), "not in the medium: {line}");
        let medium = VDB.replacen(line, spoilt, 1);
        assert_eq!(refusal(&SCENE.replacen(HOMOGENEOUS, &medium, 1)), *expected);
    }
}

#[test]
fn broken_syntax_names_the_line() {
    let message = refusal(&SCENE.replacen("sigma_t = 1.0", "sigma_t = = 1.0", 1));
    assert!(message.starts_with("s.toml:11: "), "{message}");
    let message = refusal(&SCENE.replacen("sigma_t = 1.0", "sigma_t = 1.0\nsigma_t = 2.0", 1));
    assert_eq!(message, "s.toml:12: duplicate key");
    let json = |text| refusal_of("s.json", text, &Overrides::default());
    assert_eq!(json("{\n\"camera\": }"), "s.json:2: expected value (column 11)");
    assert_eq!(
        json("{\"camera\": {}, \"camera\": {}}"),
        "s.json:1: duplicate key `camera` (column 28)"
    );
    assert!(json(&"[".repeat(100_000)).starts_with("s.json:1: recursion limit"));
    assert!(refusal(&format!("a = {}", "[".repeat(100_000))).starts_with("s.toml:1: "));
}

#[test]
fn json_errors_name_the_key() {
    let json = |text| refusal_of("s.JSON", text, &Overrides::default());
    assert_eq!(json("[1]"), "s.JSON: scene: expected a table of sections, found [1]");
    assert_eq!(json("{\"camera\": null}"), "s.JSON: camera: expected a table, found null");
    let position = "s.JSON: camera.position: missing key; expected a list of 3 numbers";
    assert_eq!(json("{}"), position);
    assert_eq!(
        json("{\"light\": {}}"),
        "s.JSON: light: expected a list of tables, as [[light]] writes it, found a table"
    );
    assert_eq!(json("{\"light\": [7]}"), "s.JSON: light[0]: expected a table, found 7");
}

#[test]
fn a_scene_without_light_is_refused() {
    let dark = SCENE.split("[[light]]").next().unwrap();
    assert_eq!(refusal(dark), "s.toml:1: light: the scene has no light; add a [[light]]");
}

#[test]
fn files_that_are_no_scenes_are_refused() {
    let load = |path: &Path| Scene::load(path).unwrap_err().to_string();
    let absent = load(Path::new("absent/scene.toml"));
    assert!(absent.starts_with("absent/scene.toml: cannot read the scene: "), "{absent}");
    assert_eq!(
        refusal_of("s.yaml", SCENE, &Overrides::default()),
        "s.yaml: the name of a scene file ends in .toml or .json"
    );
    let large = format!("#{}", " ".repeat(17 << 20));
    assert_eq!(refusal(&large), "s.toml: not a scene: larger than 16 MiB");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    std::fs::write(&path, [b'a', 0xff, b'\n']).unwrap();
    let message = load(&path);
    assert!(message.ends_with("cannot read the scene: stream did not contain valid UTF-8"));
}

#[test]
fn overrides_meet_the_limits_of_the_file() {
    let refused = |overrides: Overrides| refusal_of("s.toml", SCENE, &overrides);
    let none = Overrides::default();
    assert_eq!(
        refused(Overrides { photons: Some(0), ..none.clone() }),
        "s.toml: photons.count (overridden): must lie in 1 to 10^12, found 0"
    );
    assert_eq!(
        refused(Overrides { k: Some(1), ..none.clone() }),
        "s.toml: estimate.k (overridden): must be at least 2 with divisor \"k-1\", found 1"
    );
    assert_eq!(
        refused(Overrides { divisor: Some("k/2".into()), ..none.clone() }),
        "s.toml: estimate.divisor (overridden): unknown value \"k/2\"; \
         accepted: \"k\", \"k-1\", \"k-1/2\", \"calibrated\""
    );
    assert_eq!(
        refused(Overrides { emission: Some("halton".into()), ..none.clone() }),
        "s.toml: photons.emission (overridden): unknown value \"halton\"; \
         accepted: \"random\", \"stratified\", \"sobol\""
    );
    assert_eq!(
        refused(Overrides { resolution: Some([0, 9]), ..none.clone() }),
        "s.toml: camera.resolution (overridden): each side must lie in 1 to 16384 pixels, found [0, 9]"
    );
    let sections = "[medium]\nkind = \"vdb\"\n";
    let overrides = Overrides { resolution: Some([9, 9]), ..none };
    assert_eq!(
        refusal_of("s.toml", sections, &overrides),
        "s.toml:1: camera.position: missing key; expected a list of 3 numbers"
    );
}
