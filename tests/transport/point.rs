//! A point light in an infinite medium and at the centre of a ball, against transport theory.
//!
//! Truths are in `src/validate/truth`, exact to nine digits or more.

use std::f64::consts::PI;

use crate::transport_support::*;
use photonvdb::emission::EmissionKind;
use photonvdb::math::DVec3;
use photonvdb::medium::Bounds;
use photonvdb::render::{LitScene, Unobserved};
use photonvdb::scene::Scene;
use photonvdb::trace::{Photon, TracedPhotons};

/// Squared distance from the light and power of every collision, where sigma_t = 1 and the light sends 1 W.
fn collisions<'a>(
    scene: &Scene,
    traced: &'a TracedPhotons,
) -> impl Iterator<Item = (f64, f64)> + 'a {
    let frame = frame(scene);
    let light = scene.lights[0].position().unwrap();
    let distance_squared = move |p: &Photon| frame.to_world(p.position).distance_squared(light);
    traced.photons.iter().map(move |p| (distance_squared(p), power(p, 0)))
}

/// Collisions per photon within a radius: independent of how photons are emitted.
#[test]
fn collisions_within_a_radius_of_an_infinite_medium() {
    let radii = [0.1, 0.5, 1.0, 2.0, 5.0, 20.0];
    let enclosed = &truth("infinite.json")["enclosed"];
    for (albedo, kind) in [
        ("0", EmissionKind::Stratified),
        ("0.5", EmissionKind::Random),
        ("0.9", EmissionKind::Stratified),
        ("0.9", EmissionKind::Sobol),
    ] {
        let medium = grey_fog(Bounds::Infinite, 1.0, albedo.parse().unwrap(), 0.0);
        let mut scene = scene(medium, one_watt(DVec3::new(3.0, -2.0, 7.0)), 4000);
        scene.photons.emission = kind;
        let counts = over_seeds(&mut scene, |scene| {
            let traced = trace(scene);
            radii.map(|radius| {
                let inside = collisions(scene, &traced).filter(|(r, _)| *r < radius * radius);
                inside.map(|(_, power)| power).sum()
            })
        });
        for (count, radius) in counts.iter().zip(["0.1", "0.5", "1", "2", "5", "20"]) {
            let exact = number(&enclosed[albedo], radius);
            // Powers are of single precision.
            let rounding = 1e-7 * exact;
            count.assert_within(
                exact,
                rounding,
                &format!("albedo {albedo}, {kind:?}, within {radius}"),
            );
        }
    }
}

/// Fluence by radius for Henyey-Greenstein scattering: collisions in thin shells. phi r^2 is so nearly straight
/// across a shell of half-width r / 20 that its mean differs from its middle by less than 1e-3.
#[test]
fn fluence_by_radius_of_an_anisotropic_infinite_medium() {
    let table = truth("infinite.json")["hg"].as_array().unwrap().clone();
    for row in table.iter().filter(|row| number(row, "albedo") == 0.9) {
        let g = number(row, "g");
        let medium = grey_fog(Bounds::Infinite, 1.0, 0.9, g);
        let mut scene = scene(medium, one_watt(DVec3::ZERO), 4000);
        let radii: [f64; 4] = [0.5, 1.0, 2.0, 5.0];
        let fluences = over_seeds(&mut scene, |scene| {
            let traced = trace(scene);
            radii.map(|radius| {
                let shell = (0.95 * radius).powi(2)..(1.05 * radius).powi(2);
                let inside = collisions(scene, &traced).filter(|(r, _)| shell.contains(r));
                let by_area = inside.map(|(r, power)| power / (4.0 * PI * r));
                by_area.sum::<f64>() / (0.1 * radius)
            })
        });
        for ((fluence, radius), exact) in fluences.iter().zip(radii).zip(numbers(row, "phi")) {
            let straight = 1e-3 * exact;
            fluence.assert_within(exact, straight, &format!("g {g}, fluence at {radius}"));
        }
    }
}

/// E13: sums over collisions of z and r^2 for light along +z (here: a thin spot) have closed forms, and so
/// does E2, the distribution of the number of collisions.
#[test]
fn moments_and_counts_of_collisions() {
    use photonvdb::light::{Light, SpotLight};
    let spot = SpotLight {
        position: DVec3::ZERO,
        axis: DVec3::Z,
        intensity: DVec3::ONE,
        cone_angle: 1e-5,
        falloff_angle: 1e-5,
    };
    for (albedo, g) in [(0.5, 0.0), (0.8, 0.7), (0.8, -0.5)] {
        let count = 4000;
        let medium = grey_fog(Bounds::Infinite, 1.0, albedo, g);
        let mut scene = scene(medium, Light::Spot(spot), count);
        let share = 1.0 / count as f64;
        let [height, square, collisions, chi] = over_seeds(&mut scene, |scene| {
            let traced = trace(scene);
            let frame = frame(scene);
            let height: f64 = traced.photons.iter().map(|p| frame.to_world(p.position).z).sum();
            let square: f64 = collisions(scene, &traced).map(|(square, _)| square).sum();
            // A photon dies after its n-th collision with probability (1 - a) a^(n-1).
            let mut reached = vec![0.0; 2000];
            traced.photons.iter().for_each(|p| reached[p.order as usize] += 1.0);
            let mut chi = 0.0;
            for n in 0..8 {
                let expected = count as f64 * (1.0 - albedo) * f64::powi(albedo, n as i32);
                let died: f64 = reached[n] - reached[n + 1];
                chi += (died - expected).powi(2) / (expected * (1.0 - expected * share));
            }
            [height * share, square * share, traced.photons.len() as f64 * share, chi / 8.0]
        });
        let case = |what: &str| format!("albedo {albedo}, g {g}: {what}");
        height.assert_is(1.0 / ((1.0 - albedo) * (1.0 - albedo * g)), &case("sum of z"));
        let exact = 2.0 / ((1.0 - albedo).powi(2) * (1.0 - albedo * g));
        square.assert_is(exact, &case("sum of r^2"));
        collisions.assert_is(1.0 / (1.0 - albedo), &case("collisions"));
        chi.assert_is(1.0, &case("chi^2 of their distribution"));
    }
}

/// Stratified first flights change nothing in the mean, and every way of emission gives the same.
#[test]
fn collisions_and_escape_of_a_ball() {
    for (row, kind) in truth("sphere.json").as_array().unwrap().iter().zip(
        [EmissionKind::Stratified, EmissionKind::Random, EmissionKind::Sobol].into_iter().cycle(),
    ) {
        let (albedo, radius) = (number(row, "a"), number(row, "R"));
        let mut scene =
            scene(grey_fog(ball(radius), 1.0, albedo, 0.0), one_watt(DVec3::ZERO), 4000);
        scene.photons.emission = kind;
        let [collisions, escape] = over_seeds(&mut scene, |scene| {
            let traced = trace(scene);
            let collided = traced.photons.iter().map(|p| power(p, 0)).sum();
            [collided, traced.balance.escaped.x]
        });
        let case = format!("albedo {albedo}, radius {radius}, {kind:?}");
        collisions.assert_is(number(row, "mean_collisions"), &format!("{case}: collisions"));
        escape.assert_is(number(row, "escape"), &format!("{case}: escape"));
    }
}

/// Fluence by the estimator. Over a ball of radius h about a place at r from the light, the constant kernel reads
/// h^2 / 10 of the Laplacian too much; the fluence here falls between exp(-r) / r^2 and exp(-r) / r, whose
/// Laplacians are below (1 + 2 / r + 2 / r^2) phi. On the surface only the inner half of the ball holds photons,
/// 3/8 h further in on average, where the fluence is larger by its slope, below (1 + 2 / r) phi.
#[test]
fn fluence_in_a_ball_by_the_estimator() {
    for row in truth("sphere.json").as_array().unwrap().iter().filter(|r| number(r, "a") != 0.99) {
        let (albedo, ball_radius) = (number(row, "a"), number(row, "R"));
        let medium = grey_fog(ball(ball_radius), 1.0, albedo, 0.0);
        let mut scene = scene(medium, one_watt(DVec3::ZERO), 20_000);
        scene.render.photons_only = true;
        scene.estimate.k = 20;
        let radii: [f64; 6] = numbers(row, "r").try_into().unwrap();
        let figures: [Runs; 12] = over_seeds(&mut scene, |scene| {
            let lit = LitScene::prepare(scene, &Unobserved).unwrap();
            let mut reader = lit.reader();
            let mut random = photonvdb::math::Stream::Experiment.random(scene.photons.seed, 0);
            let places = 40;
            let mut sums = [0.0; 12];
            for (n, radius) in radii.into_iter().enumerate() {
                for _ in 0..places {
                    let place = random_direction(&mut random) * radius;
                    let fluence = reader.fluence(place);
                    let density = reader.power_density(place).value;
                    if radius + fluence.radius < ball_radius {
                        assert!((fluence.value - density).abs().max_element() < 1e-9 * density.x);
                    }
                    sums[n] += fluence.value.x / f64::from(places);
                    sums[6 + n] += fluence.radius / f64::from(places);
                }
            }
            sums
        });
        for ((n, r), exact) in radii.into_iter().enumerate().zip(numbers(row, "phi")) {
            let h = figures[6 + n].mean;
            let curvature = 0.1 * h * h * (1.0 + 2.0 / r + 2.0 / (r * r));
            let outside = (r + h - ball_radius).clamp(0.0, h);
            let slope = 0.375 * outside * (1.0 + 2.0 / r);
            let what = format!("albedo {albedo}, radius {ball_radius}, fluence at {r}, h {h:.3}");
            figures[n].assert_within(exact, 2.0 * (curvature + slope) * exact, &what);
        }
    }
}
