//! Radiance along rays past a point light at the centre of a ball of fog, all scattering orders, against the integral equation.

use crate::transport_support::*;
use photonvdb::math::{DVec3, Ray, Stream};
use photonvdb::medium::Bounds;
use photonvdb::render::{LitScene, Unobserved};

const SEEDS: u64 = 2;
const RAYS: usize = 400;
/// Views of one map, turned about the light.
const VIEWS: u32 = 60;

/// The largest error for a ray of impact parameter b. Near the surface, kernels reach inwards only, where the fluence is
/// larger, and a grazing ray sees nothing else.
fn largest_error(impact: f64) -> f64 {
    match impact {
        _ if impact < 0.8 => 0.01,
        _ if impact < 0.95 => 0.015,
        _ => 0.03,
    }
}

/// A million photons, averaged over two maps, come within 1 % where the surface is not all that a ray sees.
#[test]
fn glowing_balls() {
    for row in truth("glow.json").as_array().unwrap() {
        let (albedo, radius) = (number(row, "albedo"), number(row, "R"));
        if ![(0.5, 1.0), (0.9, 2.0)].contains(&(albedo, radius)) {
            continue;
        }
        let medium = grey_fog(ball(radius), 1.0, albedo, 0.0);
        let mut scene = scene(medium, one_watt(DVec3::ZERO), 1_000_000);
        scene.render.light_samples = 64;
        let impacts = numbers(row, "b_over_R");
        let mut found = vec![SeenLight::default(); impacts.len()];
        for seed in 0..SEEDS {
            scene.photons.seed = seed;
            let mut random = Stream::Experiment.random(seed, 0);
            let lit = LitScene::prepare(&scene, &Unobserved).unwrap();
            for (sum, impact) in found.iter_mut().zip(&impacts) {
                let rays: Vec<Ray> = (0..RAYS)
                    .map(|_| passing_ray(DVec3::ZERO, impact * radius, 5.0 * radius, &mut random))
                    .collect();
                let seen = seen_in(&lit, &rays, &mut random);
                sum.single += seen.single / SEEDS as f64;
                sum.multiple += seen.multiple / SEEDS as f64;
            }
        }
        for ((seen, &impact), exact) in found.iter().zip(&impacts).zip(numbers(row, "L")) {
            let ratio = seen.total().x / exact;
            let share = seen.multiple.x / seen.total().x;
            let what = format!("albedo {albedo}, radius {radius}, b/R {impact}");
            println!("{what}: {ratio:.5} of {exact:.6e}, {share:.2} of it multiple");
            assert!((ratio - 1.0).abs() < largest_error(impact), "{what}: {ratio}");
        }
    }
}

/// The same from inside a medium without end, where the ray starts at `camera_distance` from the light: half a million
/// photons, rays that start within three mean free paths.
#[test]
fn glow_in_a_medium_without_end() {
    let rows = truth("glow_infinite.json");
    for row in rows.as_array().unwrap() {
        let albedo = number(row, "albedo");
        let (distance, impact) = (number(row, "camera_distance"), number(row, "impact"));
        if distance > 3.0 || ![0.5, 0.9].contains(&albedo) {
            continue;
        }
        let medium = grey_fog(Bounds::Infinite, 1.0, albedo, 0.0);
        let mut scene = scene(medium, one_watt(DVec3::ZERO), 500_000);
        scene.render.light_samples = 256;
        scene.render.march_samples = 256;
        let along = (distance * distance - impact * impact).sqrt();
        let ray = Ray::new(DVec3::new(impact, 0.0, -along), DVec3::Z);
        let (mut single, mut total) = (0.0, 0.0);
        let lit = LitScene::prepare(&scene, &Unobserved).unwrap();
        let mut reader = lit.reader();
        let mut random = Stream::Experiment.random(0, 0);
        for _ in 0..VIEWS {
            let turn = glam::DQuat::from_rotation_arc(DVec3::Z, random_direction(&mut random));
            let ray = Ray::new(turn * ray.origin, turn * ray.direction);
            let seen = reader.radiance(&ray, f64::INFINITY, &mut random);
            single += seen.single_scatter.x / f64::from(VIEWS);
            total += (seen.single_scatter + seen.multiple_scatter).x / f64::from(VIEWS);
        }
        let exact = number(row, "L_total");
        let what = format!("albedo {albedo}, from {distance}, impact {impact}");
        println!("{what}: {:.5}, single {:.5}", total / exact, single / number(row, "L_single"));
        assert!((single / number(row, "L_single") - 1.0).abs() < 1e-3, "{what}: single");
        assert!((total / exact - 1.0).abs() < 0.015, "{what}: {}", total / exact);
    }
}
