//! The white furnace: in a medium that absorbs nothing, under radiance 1 from all sides, every ray sees radiance 1.
//!
//! Direct light, single scattering and the photon map share the work; here is what the map must supply, as a share
//! of all scattered light, so that unscattered light does not hide an error.

mod grid_support;
mod transport_support;

use grid_support::cloud;
use photonvdb::math::{DAffine3, DVec3, Ray, Stream, uniform};
use photonvdb::medium::Medium;
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::Scene;
use transport_support::*;

/// A sphere of rays about a random place of the medium's inner half.
fn rays_through(medium: &Medium, seed: u64) -> (Vec<Ray>, photonvdb::math::Random) {
    let middle = medium.bounds.enclosing_ball().unwrap();
    let mut random = Stream::Experiment.random(seed, 1);
    let rays = (0..150)
        .map(|_| {
            let impact = 0.6 * middle.radius * uniform(&mut random).sqrt();
            passing_ray(middle.center, impact, 3.0 * middle.radius, &mut random)
        })
        .collect();
    (rays, random)
}

/// Scattered light along rays, over what should scatter there; and all light.
fn along_rays(scene: &mut Scene) -> [Runs; 3] {
    over_seeds(scene, |scene| {
        let (rays, mut random) = rays_through(&scene.medium, scene.photons.seed);
        let seen = mean_seen(scene, &rays, &mut random);
        let scattered = seen.single + seen.multiple;
        let exact = 1.0 - seen.emission.x;
        [scattered.x / exact, seen.total().x, seen.multiple.x / exact]
    })
}

fn smoke(g: f64) -> Medium {
    let place = DAffine3::from_scale(DVec3::splat(0.1));
    grid_medium(cloud(10).extinction(place, 6.0), DVec3::ONE, g)
}

fn check(name: &str, mut scene: Scene, bias: f64) {
    let [scattered, total, multiple] = along_rays(&mut scene);
    println!("{name}: total {:.5} ± {:.5}, map's share {:.2}", total.mean, total.error, multiple.mean);
    scattered.assert_within(1.0, bias, name);
}

#[test]
fn homogeneous_media() {
    for g in [-0.5, 0.0, 0.85] {
        for (name, bounds) in [("box", CUBE), ("ball", ball(1.0))] {
            let scene = scene(grey_fog(bounds, 2.0, 1.0, g), white_sky(), 10_000);
            check(&format!("{name}, g {g}"), scene, 0.0);
        }
    }
}

#[test]
fn a_grid() {
    for g in [-0.5, 0.0, 0.85] {
        check(&format!("cloud, g {g}"), scene(smoke(g), white_sky(), 10_000), 0.0);
    }
}

#[test]
fn a_smoke_of_a_file() {
    let mut scene = Scene::load(&tests().join("scenes/smoke_sun.toml")).unwrap();
    scene.medium.albedo = DVec3::ONE;
    scene.lights = vec![white_sky()];
    scene.photons.count = 10_000;
    check("smoke", scene, 0.0);
}

/// By pixels.
#[test]
fn images() {
    for (name, medium) in [("box", grey_fog(CUBE, 2.0, 1.0, 0.3)), ("cloud", smoke(0.3))] {
        let mut scene = scene(medium, white_sky(), 10_000);
        let [mean] = over_seeds(&mut scene, |scene| {
            let film = render(scene, &RenderOptions { passes: 1 }, &Unobserved).unwrap().film;
            let count = film.pixels.len() as f64;
            let radiance: f64 = film.pixels.iter().map(|pixel| pixel.radiance().x).sum();
            [radiance / count]
        });
        mean.assert_is(1.0, &format!("image of the {name}"));
    }
}
