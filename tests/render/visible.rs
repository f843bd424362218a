//! Lights that the camera does not see: they light the medium as before, to the last bit, and are missing from what is seen directly.

use std::path::Path;

use photonvdb::film::Pixel;
use photonvdb::math::Rgb;
use photonvdb::reference::{Limits, Unwatched, render_reference};
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::{Overrides, Scene};
use serde_json::{Value, json};

/// A ball of fog between the camera and a square of light, with a lamp beside it.
fn scene(visible: &Value) -> Scene {
    let light = |shape: Value| {
        let mut light = shape;
        light["radiance"] = json!(3.0);
        if !visible.is_null() {
            light["visible"] = visible.clone();
        }
        light
    };
    let quad =
        json!({ "kind": "quad", "corner": [-1, -1, -2], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0] });
    let sphere = json!({ "kind": "sphere", "center": [0.5, 0.5, 2], "radius": 0.3 });
    let scene = json!({
        "camera": { "position": [0, 0, 5], "look_at": [0, 0, 0], "resolution": [16, 16] },
        "medium": {
            "kind": "homogeneous",
            "bounds": { "center": [0, 0, 0], "radius": 1 },
            "sigma_t": 1.0,
            "albedo": 0.9,
        },
        "light": [light(quad), light(sphere), { "kind": "environment", "radiance": 0.25 }],
        "photons": { "count": 20_000 },
    });
    let text = scene.to_string();
    Scene::from_json_text(&text, Path::new(""), &Overrides::default()).unwrap()
}

/// Photon mapped, and by the path tracer.
fn images(visible: bool) -> [Vec<Pixel>; 2] {
    let scene = scene(&json!(visible));
    let rendering = render(&scene, &RenderOptions::passes(1), &Unobserved).unwrap();
    let limits = Limits { samples: Some(16), ..Limits::default() };
    let reference = render_reference(&scene, &limits, &Unwatched).unwrap();
    [rendering.film.pixels, reference.film.pixels]
}

#[test]
fn hidden_lights_shine_and_are_not_seen() {
    for (seen, hidden) in images(true).into_iter().zip(images(false)) {
        let mut seen_lights = 0;
        for (seen, hidden) in seen.iter().zip(&hidden) {
            assert_eq!(seen.single_scatter, hidden.single_scatter);
            assert_eq!(seen.multiple_scatter, hidden.multiple_scatter);
            assert_eq!(seen.transmittance, hidden.transmittance);
            // What is left is the environment, which is behind everything.
            let environment = 0.25 * hidden.transmittance;
            assert!((hidden.emission - environment).abs().max_element() < 1e-12);
            seen_lights += usize::from(seen.emission.x > environment.x + 0.5);
        }
        assert!(seen_lights > 16, "{seen_lights}");
        assert!(hidden.iter().map(|pixel| pixel.single_scatter).sum::<Rgb>().min_element() > 0.0);
    }
}

/// Images of before the key keep their hash, and their checkpoints.
#[test]
fn lights_are_visible_unless_the_scene_says_otherwise() {
    let silent = scene(&Value::Null);
    assert_eq!(silent.hash, scene(&json!(true)).hash);
    assert_ne!(silent.hash, scene(&json!(false)).hash);
    assert!(silent.lights.iter().all(|light| light.is_visible()));
}
