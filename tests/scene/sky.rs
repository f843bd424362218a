//! Environment images of scenes: found beside the scene file, scaled, and checked.

use std::path::Path;

use exr::prelude::write_rgb_file;
use glam::DVec3;
use photonvdb::light::{Environment, Light};
use photonvdb::scene::Scene;

const SCENE: &str = r#"[camera]
position = [0, 1, 6]
look_at = [0, 0, 0]

[medium]
kind = "homogeneous"
bounds = { min = [-1, -1, -1], max = [1, 1, 1] }
sigma_t = 1
albedo = 0.5

[[light]]
kind = "environment"
file = "images/sky.exr"
scale = [2, 1, 0.5]
rotation = 90
"#;

/// A scene whose sky of 4 x 2 pixels is (x, y, 1) but for one pixel.
fn write_scene(folder: &Path, odd_pixel: (f32, f32, f32)) -> std::path::PathBuf {
    std::fs::create_dir_all(folder.join("images")).unwrap();
    let pixel =
        |x: usize, y: usize| if (x, y) == (2, 1) { odd_pixel } else { (x as f32, y as f32, 1.0) };
    write_rgb_file(folder.join("images/sky.exr"), 4, 2, pixel).unwrap();
    let path = folder.join("scene.toml");
    std::fs::write(&path, SCENE).unwrap();
    path
}

#[test]
fn a_sky_is_found_beside_the_scene_and_scaled() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::load(&write_scene(folder.path(), (8.0, 8.0, 8.0))).unwrap();
    let [Light::Environment(sky @ Environment::Image(_))] = &scene.lights[..] else {
        panic!("{:?}", scene.lights)
    };
    // Column 3 of 4 has its middle 135 degrees right of the image's centre, which looks along -z; the rotation
    // takes it back by 90. Row 0 is above the horizon.
    let right_ahead = DVec3::new(1.0, 0.5, -1.0).normalize();
    assert_eq!(sky.radiance(right_ahead), DVec3::new(6.0, 0.0, 0.5));
    let left_ahead_below = DVec3::new(-1.0, -0.5, -1.0).normalize();
    assert_eq!(sky.radiance(left_ahead_below), DVec3::new(16.0, 8.0, 4.0));
}

#[test]
fn the_content_of_a_sky_matters_and_its_place_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let hash = |pixel| Scene::load(&write_scene(folder.path(), pixel)).unwrap().hash;
    let (first, second) = (hash((8.0, 8.0, 8.0)), hash((8.0, 8.0, 9.0)));
    assert_ne!(first, second);
    std::fs::rename(folder.path().join("images/sky.exr"), folder.path().join("moved.exr")).unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, SCENE.replace("images/sky.exr", "moved.exr")).unwrap();
    assert_eq!(Scene::load(&path).unwrap().hash, second);
}

#[test]
fn pixels_that_are_no_radiance_are_named() {
    let folder = tempfile::tempdir().unwrap();
    for (pixel, shown) in [
        ((0.0, -1.0, 0.0), "[0.0, -1.0, 0.0]"),
        ((f32::NAN, 0.0, 0.0), "[NaN, 0.0, 0.0]"),
        ((0.0, 0.0, f32::INFINITY), "[0.0, 0.0, inf]"),
        ((f32::MAX, 0.0, 0.0), "[3.4028235e38, 0.0, 0.0]"),
    ] {
        let path = write_scene(folder.path(), pixel);
        let message = Scene::load(&path).unwrap_err().to_string();
        let expected = format!(
            "scene.toml:13: light[0].file: {}/images/sky.exr: pixel (x = 2, y = 1) is {shown}; \
             radiance must be finite and not negative",
            folder.path().display()
        );
        assert!(message.ends_with(&expected), "{message}");
    }
}
