//! The photon mapper against the path tracer, which shares none of its estimators: every light, every medium, layer by layer.
//!
//! Single scattering and what is seen directly have no bias in either. Multiple scattering of 10 000 photons a map
//! has that of its kernels, which is bounded by a share of it.

use std::f64::consts::PI;

use crate::transport_support::*;
use photonvdb::camera::Camera;
use photonvdb::film::Film;
use photonvdb::light::{
    DirectionalLight, Environment, EnvironmentImage, Light, PointLight, QuadLight, SphereLight,
    SpotLight,
};
use photonvdb::math::{DVec3, Rgb};
use photonvdb::medium::{Medium, Phase};
use photonvdb::reference::{Limits, Unwatched, render_reference};
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::{Overrides, Scene};

/// Share of the multiple scattering that kernels may add or lose.
const KERNEL_BIAS: f64 = 0.03;

/// Means of single scattering, multiple scattering and emission, channel by channel.
fn layers(film: &Film) -> [f64; 9] {
    let count = film.pixels.len() as f64;
    let mean = |layer: fn(&photonvdb::film::Pixel) -> Rgb| {
        (film.pixels.iter().map(layer).sum::<Rgb>() / count).to_array()
    };
    let parts = [mean(|p| p.single_scatter), mean(|p| p.multiple_scatter), mean(|p| p.emission)];
    std::array::from_fn(|index| parts[index / 3][index % 3])
}

fn assert_agree(scene: &mut Scene, what: &str) {
    scene.camera = Camera::look_at(
        DVec3::new(2.2, 1.8, 4.2),
        DVec3::new(0.0, 0.05, 0.0),
        DVec3::Y,
        0.6,
        [12, 9],
    )
    .unwrap();
    scene.photons.count = 10_000;
    scene.estimate.k = 50;
    let photons = over_seeds(scene, |scene| {
        layers(&render(scene, &RenderOptions::passes(1), &Unobserved).unwrap().film)
    });
    let limits = Limits { samples: Some(8), ..Limits::default() };
    let paths = over_seeds(scene, |scene| {
        layers(&render_reference(scene, &limits, &Unwatched).unwrap().film)
    });
    for (index, (photons, paths)) in photons.iter().zip(paths).enumerate() {
        let layer = ["single", "multiple", "emission"][index / 3];
        let bias = if layer == "multiple" { KERNEL_BIAS * paths.mean } else { 0.0 };
        let what = format!("{what}, {layer}, channel {}", index % 3);
        if photons.mean != paths.mean {
            let error = photons.error.hypot(paths.error);
            Runs { error, ..*photons }.assert_within(paths.mean, bias, &what);
        }
    }
}

fn painted_sky() -> Light {
    let pixels = (0..32).map(|i| {
        let value = ((i * 7) % 5) as f32 + if i == 13 { 20.0 } else { 0.0 };
        [value, 0.5 * value, 0.25]
    });
    Light::Environment(Environment::Image(Box::new(EnvironmentImage::new(
        8,
        4,
        pixels.collect(),
        0.3,
    ))))
}

fn sun() -> Light {
    let direction = DVec3::new(-0.4, -0.8, -0.45).normalize();
    Light::Directional(DirectionalLight { direction, irradiance: Rgb::new(3.0, 2.0, 1.0) })
}

fn every_light() -> Vec<(&'static str, Light)> {
    let position = DVec3::new(0.3, 0.4, 0.2);
    let from = DVec3::new(-2.0, 1.5, 0.5);
    vec![
        ("point inside", Light::Point(PointLight { position, intensity: Rgb::ONE })),
        ("point outside", Light::Point(PointLight { position: from, intensity: Rgb::ONE })),
        (
            "spot",
            Light::Spot(SpotLight {
                position: from,
                axis: (-from).normalize(),
                intensity: Rgb::splat(9.0),
                cone_angle: 0.25,
                falloff_angle: 0.15,
            }),
        ),
        ("sun", sun()),
        ("constant sky", white_sky()),
        ("painted sky", painted_sky()),
        (
            "quad inside",
            Light::Quad(QuadLight {
                corner: DVec3::new(-0.4, 0.5, -0.3),
                edge_u: DVec3::new(0.8, 0.1, 0.0),
                edge_v: DVec3::new(0.0, 0.1, 0.7),
                radiance: Rgb::splat(2.0),
                is_visible: true,
            }),
        ),
        (
            "sphere inside",
            Light::Sphere(SphereLight {
                center: position,
                radius: 0.15,
                radiance: Rgb::splat(3.0),
                is_visible: true,
            }),
        ),
    ]
}

#[test]
fn every_light_in_fog() {
    for (name, light) in every_light() {
        let mut scene = scene(grey_fog(CUBE, 1.5, 0.9, 0.4), light, 1);
        assert_agree(&mut scene, name);
    }
}

#[test]
fn coloured_fog() {
    let medium = fog(ball(1.0), Rgb::new(0.5, 1.5, 3.0), Rgb::new(0.95, 0.8, 0.6), 0.0);
    let mut scene = scene(medium, every_light().remove(0).1, 1);
    scene.lights.push(sun());
    assert_agree(&mut scene, "coloured fog");
}

/// A scene file with a volume, lights as given.
fn volume(medium: &str, lights: Vec<Light>) -> Scene {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("scene.toml");
    let root = env!("CARGO_MANIFEST_DIR");
    let light = "[[light]]\nkind = \"point\"\nposition = [0, 5, 0]\nintensity = 1\n";
    let text = format!(
        "[camera]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\n[[medium]]\nkind = \"vdb\"\nfile = \"{root}/{medium}\n{light}"
    );
    std::fs::write(&path, text).unwrap();
    let mut scene = Scene::load_with(&path, &Overrides::default()).unwrap();
    scene.lights = lights;
    scene
}

#[test]
fn smoke_in_sunlight() {
    let smoke = "media/smoke_plume.vdb\"\ndensity_scale = 20\nalbedo = [0.9, 0.8, 0.7]\nphase = { kind = \"henyey-greenstein\", g = 0.3 }";
    let position = DVec3::new(0.1, 0.0, 0.1);
    let lights =
        vec![sun(), Light::Point(PointLight { position, intensity: Rgb::splat(0.1 * PI) })];
    assert_agree(&mut volume(smoke, lights), "smoke");
}

#[test]
fn a_fire_by_its_own_light() {
    let fire = "media/fire.vdb\"\ndensity_scale = 9\nalbedo = [0.8, 0.78, 0.75]\ntemperature = \"temperature\"\nflame = \"flame\"\nemission_scale = 0.02\nflame_color = [20, 5, 1]";
    assert_agree(&mut volume(fire, Vec::new()), "fire");
}

/// A cloud's droplets in sun and sky.
#[test]
fn fog_of_droplets() {
    let medium = Medium { phase: Phase::droplets(8.0), ..grey_fog(ball(1.0), 3.0, 0.95, 0.0) };
    let mut scene = scene(medium, sun(), 1);
    scene.lights.push(white_sky());
    assert_agree(&mut scene, "droplets");
}

const FOG: &str = "[[medium]]\nkind = \"homogeneous\"\nbounds = { center = [0.1, 0.2, 0], radius = 0.9 }\nsigma_t = 0.8\nalbedo = [0.9, 0.95, 0.99]\n";

#[test]
fn smoke_in_fog() {
    let smoke = "media/smoke_plume.vdb\"\ndensity_scale = 20\nalbedo = [0.9, 0.8, 0.7]\nphase = { kind = \"double-henyey-greenstein\", g1 = 0.6, g2 = -0.3, weight = 0.8 }";
    let position = DVec3::new(0.1, 0.0, 0.1);
    let lights = vec![
        sun(),
        white_sky(),
        Light::Point(PointLight { position, intensity: Rgb::splat(0.1 * PI) }),
    ];
    assert_agree(&mut volume(&format!("{smoke}\n{FOG}"), lights), "smoke in fog");
}

#[test]
fn fire_in_fog() {
    let fire = "media/fire.vdb\"\ndensity_scale = 9\nalbedo = [0.8, 0.78, 0.75]\ntemperature = \"temperature\"\nflame = \"flame\"\nemission_scale = 0.02\nflame_color = [20, 5, 1]";
    assert_agree(&mut volume(&format!("{fire}\n{FOG}"), Vec::new()), "fire in fog");
}

#[test]
fn a_grid_of_colours() {
    let colours = "tests/scene_volumes/colored.vdb\"\ndensity_scale = 3\nalbedo = 0.9\ncolor = \"Cd\"\ntransform = { scale = 0.4, translate = [-1.2, -1.2, -1.2] }";
    assert_agree(&mut volume(colours, vec![sun(), white_sky()]), "colours");
}
