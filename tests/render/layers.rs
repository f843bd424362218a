//! Layers for compositing: depths in closed form, lights that add up, and backgrounds that are put back exactly.

use crate::grid_support::Voxels;
use crate::transport_support::*;
use photonvdb::camera::Camera;
use photonvdb::film::Film;
use photonvdb::light::{DirectionalLight, Environment, Light, PointLight};
use photonvdb::math::{DAffine3, DVec3, Ray, Rgb, mean_channel};
use photonvdb::medium::{Bounds, Medium};
use photonvdb::reference::{Limits, Unwatched, render_reference};
use photonvdb::render::{CostlyLayers, Gather, RenderOptions, Unobserved, render};
use photonvdb::scene::{Background, Scene};

/// A slab of depth 2 whose face is 3 m before the camera, which looks at it through a field of 1e-4 rad.
const SLAB: Bounds =
    Bounds::Box { min: DVec3::new(-1.0, -1.0, -1.0), max: DVec3::new(1.0, 1.0, 1.0) };
const FACE: f64 = 3.0;
const DEPTH: f64 = 2.0;

fn sun(irradiance: Rgb) -> Light {
    Light::Directional(DirectionalLight { direction: DVec3::NEG_Z, irradiance })
}

fn slab(medium: Medium) -> Scene {
    let mut scene = scene(medium, sun(Rgb::ONE), 100);
    let position = DVec3::new(0.0, 0.0, 1.0 + FACE);
    scene.camera = Camera::look_at(position, DVec3::ZERO, DVec3::Y, 1e-4, [4, 4]).unwrap();
    scene
}

fn film(scene: &Scene, layers: CostlyLayers) -> Film {
    let options = RenderOptions { layers, ..RenderOptions::passes(2) };
    render(scene, &options, &Unobserved).unwrap().film
}

const DEPTHS: CostlyLayers = CostlyLayers { depths: true, lights: false };
const LIGHTS: CostlyLayers = CostlyLayers { depths: false, lights: true };

/// The mean distance from the face of exponential distances within the slab: 1/s - d exp(-s d) / (1 - exp(-s d)).
fn mean_scattering_depth(sigma_t: f64) -> f64 {
    1.0 / sigma_t - DEPTH * (-sigma_t * DEPTH).exp() / -(-sigma_t * DEPTH).exp_m1()
}

#[test]
fn depths_of_a_slab_are_exact() {
    for sigma_t in [1e-9, 1e-3, 0.1, 0.3, 1.0, 7.0, 400.0] {
        let film = film(&slab(grey_fog(SLAB, sigma_t, 0.8, 0.3)), DEPTHS);
        for (pixel, depths) in film.pixels.iter().zip(film.depths.as_ref().unwrap()) {
            let transmittance = (-sigma_t * DEPTH).exp();
            assert!((pixel.transmittance.y - transmittance).abs() < 1e-8);
            assert!((pixel.alpha() - (1.0 - transmittance)).abs() < 1e-8);
            let half = FACE + std::f64::consts::LN_2 / sigma_t;
            match transmittance <= 0.5 {
                true => assert!((depths.half() - half).abs() < 1e-7, "{sigma_t}: {depths:?}"),
                false => assert_eq!(depths.half(), f64::INFINITY),
            }
            let mean = if sigma_t < 1e-6 { 0.5 * DEPTH } else { mean_scattering_depth(sigma_t) };
            assert!((depths.scatter() - FACE - mean).abs() < 1e-6, "{sigma_t}: {depths:?}");
        }
    }
}

/// Channels of their own extinction and albedo: half of the mean channel, and the mean over what all of them scatter.
#[test]
fn depths_of_a_chromatic_slab_are_exact() {
    let (sigma_t, albedo) = (Rgb::new(0.2, 1.0, 5.0), Rgb::new(0.9, 0.5, 0.1));
    let film = film(&slab(fog(SLAB, sigma_t, albedo, 0.0)), DEPTHS);
    let seen = |channel: usize| albedo[channel] * -(-sigma_t[channel] * DEPTH).exp_m1();
    let weight: f64 = (0..3).map(seen).sum();
    let mean: f64 =
        (0..3).map(|c| seen(c) * mean_scattering_depth(sigma_t[c])).sum::<f64>() / weight;
    for depths in film.depths.as_ref().unwrap() {
        let half = depths.half() - FACE;
        let transmittance =
            mean_channel(Rgb::from_array(sigma_t.to_array().map(|s| (-s * half).exp())));
        assert!((transmittance - 0.5).abs() < 1e-7, "{half}");
        assert!((depths.scatter() - FACE - mean).abs() < 1e-6, "{depths:?} {mean}");
    }
    for (pixel, channel) in film.pixels.iter().flat_map(|p| [(p, 0), (p, 1), (p, 2)]) {
        let exact = (-sigma_t[channel] * DEPTH).exp();
        assert!((pixel.transmittance[channel] - exact).abs() < 1e-8);
    }
}

/// A grid that holds the same everywhere: exact, too, but for the strata of the scattering depth.
#[test]
fn depths_of_a_grid_are_those_of_fog() {
    let mut voxels = Voxels { background: 0.75, ..Voxels::default() };
    for voxel in [[-3, -3, -3], [3, 3, 3], [0, 0, 0]] {
        voxels.set(voxel, 0.75);
    }
    let extinction = voxels.extinction(DAffine3::from_scale(DVec3::splat(0.25)), 2.0);
    let medium = grid_medium(extinction, Rgb::splat(0.6), 0.0);
    let middle = Ray::new(DVec3::new(0.0, 0.0, 1.0 + FACE), DVec3::NEG_Z);
    let span = medium.bounds.intersect(&middle).unwrap();
    let (face, depth) = (span.start, span.length());
    let mut scene = slab(medium);
    scene.render.samples_per_pixel = 64;
    let film = film(&scene, DEPTHS);
    let sigma_t: f64 = 1.5;
    let attenuation = (-sigma_t * depth).exp();
    let mean = 1.0 / sigma_t - depth * attenuation / (1.0 - attenuation);
    for (pixel, depths) in film.pixels.iter().zip(film.depths.as_ref().unwrap()) {
        assert!((pixel.transmittance.x - attenuation).abs() < 1e-6);
        assert!((depths.half() - face - 2f64.ln() / sigma_t).abs() < 1e-6, "{depths:?}");
        // 128 rays of 16 strata.
        assert!((depths.scatter() - face - mean).abs() < 3e-4 * depth, "{depths:?} {mean}");
    }
}

/// Rays that miss the medium have no depth, and those of a pixel that sees both count by what they see.
#[test]
fn depths_end_where_the_medium_does() {
    let mut scene = slab(grey_fog(SLAB, 2.0, 0.8, 0.0));
    let position = DVec3::new(0.0, 0.0, 4.0);
    scene.camera = Camera::look_at(position, DVec3::ZERO, DVec3::Y, 1.5, [16, 16]).unwrap();
    let film = film(&scene, DEPTHS);
    let depths = film.depths.as_ref().unwrap();
    assert_eq!(depths[0].half(), f64::INFINITY);
    assert_eq!(depths[0].scatter(), f64::INFINITY);
    assert!(depths.iter().any(|d| d.half_share > 0.0 && d.half_share < 1.0));
    for depth in depths.iter().filter(|depth| depth.half_share > 0.0) {
        assert!((FACE..FACE + 2.0).contains(&depth.half()), "{depth:?}");
    }
    // And nothing is spent where nobody asks.
    assert_eq!(render(&scene, &RenderOptions::passes(1), &Unobserved).unwrap().film.depths, None);
}

fn many_lights(gather: Gather) -> Scene {
    let mut scene = scene(grey_fog(CUBE, 1.5, 0.9, 0.4), sun(Rgb::new(2.0, 1.0, 0.5)), 4000);
    scene.lights.push(Light::Environment(Environment::Constant(Rgb::new(0.1, 0.2, 0.4))));
    let point = |x: f64, intensity: Rgb| {
        Light::Point(PointLight { position: DVec3::new(x, 0.2, 0.1), intensity })
    };
    scene.lights.extend([point(0.5, Rgb::ONE), point(-0.5, Rgb::X), point(0.0, Rgb::ZERO)]);
    let name = |name: &str| Some(name.to_string());
    scene.light_names = vec![name("sun"), None, name("bulbs"), name("bulbs")];
    scene.camera =
        Camera::look_at(DVec3::new(2.2, 1.8, 4.2), DVec3::ZERO, DVec3::Y, 0.66, [12, 12]).unwrap();
    scene.render.gather = gather;
    scene.render.photons_only = false;
    scene
}

#[test]
fn lights_add_up_to_the_image() {
    for gather in [Gather::Knn, Gather::Lattice, Gather::Bounce] {
        let film = film(&many_lights(gather), LIGHTS);
        let names: Vec<&str> = film.lights.iter().map(|light| light.name.as_str()).collect();
        assert_eq!(names, ["sun", "1", "bulbs", "4"]);
        for (index, pixel) in film.pixels.iter().enumerate() {
            let sum: Rgb = film.lights.iter().map(|light| light.radiance[index]).sum();
            let error = (sum - pixel.radiance()).abs().max_element();
            assert!(error <= 1e-12 * pixel.radiance().max_element(), "{gather:?} {index}: {error}");
            assert_eq!(film.lights[3].radiance[index], Rgb::ZERO);
        }
        let sees = |layer: usize| film.lights[layer].radiance.iter().any(|r| *r != Rgb::ZERO);
        assert!(sees(0) && sees(1) && sees(2));
    }
}

/// The mean of each layer, and of the whole, is that of an image with these lights alone.
#[test]
fn a_layer_is_the_image_of_its_light() {
    let mean = |radiance: &mut dyn Iterator<Item = Rgb>| {
        let values: Vec<f64> = radiance.map(mean_channel).collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    for gather in [Gather::Knn, Gather::Lattice, Gather::Bounce] {
        let layered: [Runs; 4] = over_seeds(&mut many_lights(gather), |scene| {
            let film = film(scene, LIGHTS);
            let layer = |index: usize| mean(&mut film.lights[index].radiance.iter().copied());
            let all = mean(&mut film.pixels.iter().map(|pixel| pixel.radiance()));
            [layer(0), layer(1), layer(2), all]
        });
        for (layer, lights) in [0..1, 1..2, 2..4, 0..5].into_iter().enumerate() {
            let mut alone = many_lights(gather);
            let kept = lights.clone();
            let mut index = 0;
            alone.lights.retain(|_| {
                index += 1;
                kept.contains(&(index - 1))
            });
            let alone: [Runs; 1] = over_seeds(&mut alone, |scene| {
                let film = film(scene, CostlyLayers::default());
                [mean(&mut film.pixels.iter().map(|pixel| pixel.radiance()))]
            });
            // Balls of fewer photons are larger: they may be off by a hundredth.
            let bias = if gather == Gather::Knn { 0.01 } else { 0.002 };
            let what = format!("{gather:?}, lights {lights:?}");
            layered[layer].minus(alone[0]).assert_within(0.0, bias * alone[0].mean, &what);
        }
    }
}

/// A background that is held out is put back by coverage alone, channel by channel: in the whole image and in its lights.
#[test]
fn a_background_is_composited_exactly() {
    let background = Rgb::new(0.3, 0.5, 0.9);
    for sigma_t in [Rgb::splat(0.7), Rgb::new(0.3, 1.0, 3.0)] {
        let mut scene = scene(fog(CUBE, sigma_t, Rgb::splat(0.8), 0.2), sun(Rgb::ONE), 2000);
        scene.lights.push(Light::Environment(Environment::Constant(background)));
        let whole = film(&scene, CostlyLayers::default());
        scene.render.background = Background::Holdout;
        let held_out = film(&scene, CostlyLayers::default());
        let lights = film(&scene, LIGHTS);
        let mut covered = 0;
        for (index, (over, pixel)) in held_out.pixels.iter().zip(&whole.pixels).enumerate() {
            let composited = over.radiance() + over.transmittance * background;
            let error = (composited - pixel.radiance()).abs().max_element();
            assert!(error < 1e-12, "{error}");
            assert_eq!(over.emission, Rgb::ZERO);
            if sigma_t.x == sigma_t.y {
                let by_alpha = over.radiance() + background * (1.0 - over.alpha());
                assert!((by_alpha - pixel.radiance()).abs().max_element() < 1e-12);
            }
            covered += usize::from(over.alpha() > 0.0);
            let sum: Rgb = lights.lights.iter().map(|light| light.radiance[index]).sum();
            assert!((sum - lights.pixels[index].radiance()).abs().max_element() < 1e-12);
        }
        assert!(covered > 100 && covered < held_out.pixels.len());
        let limits = Limits { samples: Some(2), ..Limits::default() };
        let paths = render_reference(&scene, &limits, &Unwatched).unwrap().film;
        assert!(paths.pixels.iter().all(|pixel| pixel.emission == Rgb::ZERO));
        assert_eq!(paths.pixels[0].radiance(), Rgb::ZERO);
    }
}
