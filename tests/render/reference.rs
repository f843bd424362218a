//! Whole images against references from an independent light tracer (`tests/scenes`).

use crate::transport_support::*;
use photonvdb::film::{RgbImage, compare, read_rgb};
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::Scene;

/// Default settings, one pass: the mean within 0.5 %, blocks of 16 x 16 pixels within 3 % rms.
fn assert_like_reference(name: &str) {
    let path = |ending: &str| tests().join("scenes").join(format!("{name}.{ending}"));
    let scene = Scene::load(&path("toml")).unwrap();
    let rendering = render(&scene, &RenderOptions::passes(1), &Unobserved).unwrap();
    let reference = read_rgb(&path("exr")).unwrap();
    let error = compare(&RgbImage::from(&rendering.film), &reference).unwrap();
    println!("{name}: {error:?} {:?}", rendering.report.seconds);
    assert!((error.mean_ratio - 1.0).abs() < 0.005, "{name}: {error:?}");
    assert!(error.block_rel_rms < 0.03, "{name}: {error:?}");
}

#[test]
fn fog_with_a_point_light_inside() {
    assert_like_reference("fog_point");
}

#[test]
fn forward_scattering_fog_with_a_spot() {
    assert_like_reference("fog_spot");
}

#[test]
fn smoke_of_a_file_in_sunlight() {
    assert_like_reference("smoke_sun");
}
