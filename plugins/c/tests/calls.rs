//! The functions as C calls them: answers, refusals, and threads.

use std::ffi::{CStr, CString};
use std::ptr::{null, null_mut};

use photonvdb::render::{LitScene, RenderOptions, Unobserved, render};
use photonvdb::scene::{Overrides, Scene};
use photonvdb_c::*;

const FOG: &str = r#"
[camera]
position = [0.0, 0.0, 4.0]
look_at = [0.0, 0.0, 0.0]
resolution = [12, 8]

[medium]
kind = "homogeneous"
bounds = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }
sigma_t = 1.5
albedo = [0.9, 0.8, 0.7]

[[light]]
kind = "point"
position = [0.3, 0.4, 0.2]
intensity = 1.0

[photons]
count = 5000

[estimate]
k = 30
"#;

fn last_error() -> String {
    // SAFETY: never null, and ends with 0.
    unsafe { CStr::from_ptr(pvdb_last_error()) }.to_str().unwrap().to_string()
}

fn scene_of(text: &str, path: &str) -> (pvdb_status, *mut pvdb_scene) {
    let (text, path) = (CString::new(text).unwrap(), CString::new(path).unwrap());
    let mut scene = std::ptr::dangling_mut();
    // SAFETY: texts that end with 0, and a place for a pointer.
    let status = unsafe { pvdb_scene_from_text(text.as_ptr(), path.as_ptr(), &mut scene) };
    (status, scene)
}

#[test]
fn answers_are_those_of_the_library() {
    let (status, scene) = scene_of(FOG, "fog.toml");
    assert_eq!((status, last_error().as_str()), (pvdb_status::Ok, ""));
    let own = Scene::from_text(FOG, "fog.toml".as_ref(), &Overrides::default()).unwrap();
    let (mut width, mut height) = (0, 0);
    let mut pixels = vec![0.0f32; 4 * 12 * 8];
    let mut map = null_mut();
    // SAFETY: living handles, and arrays of the lengths told.
    unsafe {
        assert_eq!(pvdb_scene_resolution(scene, &mut width, &mut height), pvdb_status::Ok);
        assert_eq!((width, height), (12, 8));
        let length = pixels.len();
        assert_eq!(pvdb_render(scene, 2, pixels.as_mut_ptr(), length), pvdb_status::Ok);
        assert_eq!(pvdb_map_build(scene, &mut map), pvdb_status::Ok);
        pvdb_scene_free(scene);
    }
    let film = render(&own, &RenderOptions::passes(2), &Unobserved).unwrap().film;
    for (found, pixel) in pixels.chunks(4).zip(&film.pixels) {
        let [r, g, b] = pixel.radiance().as_vec3().to_array();
        assert_eq!(found, [r, g, b, pixel.alpha() as f32]);
    }

    let lit = LitScene::prepare(&own, &Unobserved).unwrap();
    let mut reader = lit.reader();
    let points: Vec<[f64; 3]> = (0..1000).map(|i| [f64::from(i) * 2e-3 - 1.0, 0.1, -0.2]).collect();
    let (mut fluence, mut density) = (vec![[0.0f32; 3]; 1000], vec![[0.0f32; 3]; 1000]);
    let (first, count) = (points.as_ptr().cast(), points.len());
    // SAFETY: as above; the scene is free, the map lives.
    unsafe {
        let into = fluence.as_mut_ptr().cast();
        assert_eq!(pvdb_map_fluence(map, first, count, into), pvdb_status::Ok);
        let into = density.as_mut_ptr().cast();
        assert_eq!(pvdb_map_power_density(map, first, count, 30, 1, into), pvdb_status::Ok);
        assert_eq!(pvdb_map_photon_count(map), lit.map().len() as u64);
    }
    for ((place, fluence), density) in points.iter().zip(&fluence).zip(&density) {
        let place = (*place).into();
        assert_eq!(*fluence, reader.fluence(place).value.as_vec3().to_array());
        assert_eq!(*density, reader.power_density(place).value.as_vec3().to_array());
    }
    // k counts as one photon more than k - 1, and half as much more than k - 1/2.
    let mut of = [[0.0f32; 3]; 3];
    for (divisor, into) in of.iter_mut().enumerate() {
        let (point, divisor) = (points[500].as_ptr(), divisor as u32);
        // SAFETY: as above.
        let status =
            unsafe { pvdb_map_power_density(map, point, 1, 30, divisor, into.as_mut_ptr()) };
        assert_eq!(status, pvdb_status::Ok);
    }
    assert!(of[0][0] > of[2][0] && of[2][0] > of[1][0], "{of:?}");

    // Through the middle of the box and past it.
    let origins = [[0.0, 0.0, 5.0], [5.0, 5.0, 5.0]];
    let directions = [[0.0, 0.0, -2.0], [0.0, 0.0, -1.0]];
    let (mut radiance, mut passing) = ([[0.0f32; 3]; 2], [[0.0f32; 3]; 2]);
    for _ in 0..2 {
        let before = radiance;
        // SAFETY: as above.
        let status = unsafe {
            let (origins, directions) = (origins.as_ptr().cast(), directions.as_ptr().cast());
            let (light, share) = (radiance.as_mut_ptr().cast(), passing.as_mut_ptr().cast());
            let t_max = [f64::INFINITY; 2];
            pvdb_map_radiance(map, origins, directions, t_max.as_ptr(), 2, 7, light, share)
        };
        assert_eq!(status, pvdb_status::Ok);
        assert!(before == [[0.0; 3]; 2] || before == radiance);
    }
    assert!(radiance[0].iter().all(|light| *light > 0.0));
    assert!((f64::from(passing[0][0]) / (-3.0f64).exp() - 1.0).abs() < 1e-6);
    assert_eq!((radiance[1], passing[1]), ([0.0; 3], [1.0; 3]));
    // SAFETY: not freed yet.
    unsafe { pvdb_map_free(map) };
}

#[test]
fn what_cannot_be_is_refused_with_a_sentence() {
    let refused = |status: pvdb_status, expected: pvdb_status, said: &str| {
        assert_eq!(status, expected, "{said}");
        assert!(last_error().contains(said), "{}", last_error());
    };
    let (status, none) = scene_of("[camera]\nlens = 3", "dir/bad.toml");
    refused(status, pvdb_status::BadScene, "dir/bad.toml:");
    assert!(none.is_null());
    let (status, scene) = scene_of(FOG, "fog.toml");
    assert_eq!(status, pvdb_status::Ok);
    let bad = pvdb_status::BadArgument;
    let mut pixels = [0.0f32; 16];
    let mut map: *mut pvdb_map = null_mut();
    // SAFETY: null pointers, which are refused, living handles and arrays of the lengths told.
    unsafe {
        refused(pvdb_scene_load(null(), &mut null_mut()), bad, "path is a null pointer");
        refused(pvdb_scene_load(c"x.toml".as_ptr(), null_mut()), bad, "scene is a null pointer");
        let mut missing = null_mut();
        let status = pvdb_scene_load(c"missing.toml".as_ptr(), &mut missing);
        refused(status, pvdb_status::BadScene, "missing.toml: cannot read the scene");
        refused(pvdb_scene_load(c"\xff.toml".as_ptr(), &mut missing), bad, "path is not UTF-8");
        refused(pvdb_render(null(), 1, pixels.as_mut_ptr(), 16), bad, "scene is a null pointer");
        refused(pvdb_render(scene, 1, pixels.as_mut_ptr(), 16), bad, "pixels must be 384 floats");
        refused(pvdb_render(scene, 1, null_mut(), 384), bad, "pixels is a null pointer");
        refused(pvdb_render(scene, 0, pixels.as_mut_ptr(), 384), bad, "passes must be at least 1");
        refused(pvdb_map_build(null(), &mut map), bad, "scene is a null pointer");
        refused(pvdb_map_build(scene, null_mut()), bad, "map is a null pointer");
        assert_eq!(pvdb_map_build(scene, &mut map), pvdb_status::Ok);
        let point = [0.0f64, 0.0, f64::NAN];
        let rgb = pixels.as_mut_ptr();
        refused(pvdb_map_fluence(map, null(), 1, rgb), bad, "points is a null pointer");
        refused(pvdb_map_fluence(map, point.as_ptr(), 1, rgb), bad, "not finite");
        refused(pvdb_map_fluence(map, point.as_ptr(), usize::MAX, rgb), bad, "cannot have");
        assert_eq!(pvdb_map_fluence(map, null(), 0, null_mut()), pvdb_status::Ok);
        let density =
            |k, divisor| pvdb_map_power_density(map, [0.0; 3].as_ptr(), 1, k, divisor, rgb);
        refused(density(0, 0), bad, "k must be at least 1");
        refused(density(5, 4), bad, "there is no divisor 4");
        refused(density(30, 3), bad, "ask for it in the scene");
        let (zero, t_max) = ([0.0f64; 3], [-1.0f64]);
        let radiance = |direction: &[f64; 3], t_max: &[f64]| {
            let (origin, direction) = (zero.as_ptr(), direction.as_ptr());
            pvdb_map_radiance(map, origin, direction, t_max.as_ptr(), 1, 0, rgb, null_mut())
        };
        refused(radiance(&zero, &[1.0]), bad, "a direction has no length");
        refused(radiance(&[1.0, 0.0, 0.0], &t_max), bad, "t_max must not be -1");
        // The sentence is the thread's own.
        std::thread::spawn(|| assert_eq!(last_error(), "")).join().unwrap();
        assert!(last_error().contains("t_max"));
        pvdb_map_free(map);
        pvdb_map_free(null_mut());
        pvdb_scene_free(scene);
        pvdb_scene_free(null_mut());
    }
}
