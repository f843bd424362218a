//! The white furnace: in a medium that absorbs nothing, under radiance 1 from all sides, every ray sees radiance 1.
//!
//! With everything from photons, the fluence that the map holds is the same everywhere, and the estimate has no bias
//! to speak of: not at a boundary, nor where a density falls to 0. With single scattering computed apart, the map holds a
//! fluence that falls towards the boundary, where kernels reach inwards only: linear weights read its slope, and what
//! is left of its curvature falls with the square of the kernel's radius.

use crate::grid_support::cloud;
use crate::transport_support::*;
use photonvdb::math::{DAffine3, DVec3, Random, Ray, Stream, uniform};
use photonvdb::medium::{Medium, Phase};
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::Scene;

/// What 10 000 photons may read too little, of all scattered light: a twentieth of that with a million.
const BOUNDARY_BIAS: f64 = 0.02;

/// k - 1 serves photons that are independent. The collisions of one photon lie together: where sigma_t r_k further ones
/// fall into the ball, the estimate is too high by sigma_t r_k / k of itself.
const CLUSTER_BIAS: f64 = 0.005;

/// Rays that pass the middle of the medium.
fn rays_through(medium: &Medium, seed: u64) -> (Vec<Ray>, Random) {
    let middle = medium.bounds.enclosing_ball().unwrap();
    let mut random = Stream::Experiment.random(seed, 1);
    let rays = (0..70)
        .map(|_| {
            let impact = 0.6 * middle.radius * uniform(&mut random).sqrt();
            passing_ray(middle.center, impact, 3.0 * middle.radius, &mut random)
        })
        .collect();
    (rays, random)
}

/// Scattered light along rays, over what should scatter there: unscattered light would hide an error.
fn scattered_along_rays(scene: &mut Scene) -> Runs {
    let [scattered] = over_seeds(scene, |scene| {
        let (rays, mut random) = rays_through(&scene.medium, scene.photons.seed);
        let seen = mean_seen(scene, &rays, &mut random);
        let scattered = seen.single + seen.multiple;
        [scattered.x / (1.0 - seen.emission.x)]
    });
    scattered
}

fn box_of_fog(g: f64) -> Medium {
    grey_fog(CUBE, 2.0, 1.0, g)
}

fn ball_of_fog(g: f64) -> Medium {
    grey_fog(ball(1.0), 2.0, 1.0, g)
}

fn smooth_cloud(g: f64) -> Medium {
    let place = DAffine3::from_scale(DVec3::splat(0.1));
    grid_medium(cloud(10).extinction(place, 6.0), DVec3::ONE, g)
}

/// Sparse smoke with wisps of all densities.
fn smoke(g: f64) -> Medium {
    let medium = Scene::load(&tests().join("scenes/smoke_sun.toml")).unwrap().medium;
    let phase = Phase::HenyeyGreenstein { g };
    Medium { albedo: DVec3::ONE, phase, ..medium }
}

/// A medium that absorbs nothing, of mean scattering cosine g.
type White = fn(f64) -> Medium;

const MEDIA: [(&str, White); 4] =
    [("box", box_of_fog), ("ball", ball_of_fog), ("cloud", smooth_cloud), ("smoke", smoke)];

#[test]
fn rays_of_photons_alone_see_one() {
    for (name, medium) in MEDIA {
        for g in [-0.5, 0.0, 0.85] {
            let mut scene = scene(medium(g), white_sky(), 10_000);
            scene.render.photons_only = true;
            // The smaller balls follow the density, the larger reach over the boundary.
            scene.estimate.k = if g == 0.0 { 12 } else { 100 };
            let what = format!("{name}, g {g}, photons only");
            scattered_along_rays(&mut scene).assert_within(1.0, CLUSTER_BIAS, &what);
        }
    }
}

#[test]
fn rays_of_both_see_one_but_for_the_boundary() {
    for (name, medium) in MEDIA {
        for g in [-0.5, 0.85] {
            let mut scene = scene(medium(g), white_sky(), 10_000);
            let what = format!("{name}, g {g}");
            scattered_along_rays(&mut scene).assert_within(1.0, BOUNDARY_BIAS, &what);
        }
    }
}

#[test]
fn pixels_see_one() {
    for (name, medium) in [("box", box_of_fog(0.3)), ("cloud", smooth_cloud(0.3))] {
        let mut scene = scene(medium, white_sky(), 10_000);
        scene.render.samples_per_pixel = 1;
        for (photons_only, bias) in [(true, CLUSTER_BIAS), (false, BOUNDARY_BIAS)] {
            scene.render.photons_only = photons_only;
            let [mean] = over_seeds(&mut scene, |scene| {
                let film = render(scene, &RenderOptions::passes(1), &Unobserved).unwrap().film;
                let count = film.pixels.len() as f64;
                [film.pixels.iter().map(|pixel| pixel.radiance().x).sum::<f64>() / count]
            });
            mean.assert_within(1.0, bias, &format!("{name}, photons only: {photons_only}"));
        }
    }
}
