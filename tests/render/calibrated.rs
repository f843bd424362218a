//! The divisor `calibrated`: what it leaves of the bias of `k` in media whose light is known.

use std::f64::consts::PI;

use crate::transport_support::*;
use photonvdb::emission::EmissionKind;
use photonvdb::estimate::Divisor;
use photonvdb::math::{DVec3, Random, Stream, uniform};
use photonvdb::render::{Calibration, LitScene, Unobserved};
use photonvdb::scene::Scene;

/// A scene whose every photon is in the map, asked with k calibrated photons.
fn calibrated(scene: Scene, kind: EmissionKind, k: usize) -> Scene {
    let mut scene = scene;
    scene.photons.emission = kind;
    scene.estimate.k = k;
    scene.estimate.divisor = Divisor::Calibrated;
    scene.render.photons_only = true;
    scene
}

fn point_light(kind: EmissionKind, k: usize) -> Scene {
    let medium = grey_fog(ball(8.0), 1.0, 0.0, 0.0);
    calibrated(scene(medium, one_watt(DVec3::ZERO), 50_000), kind, k)
}

fn furnace(k: usize) -> Scene {
    calibrated(
        scene(grey_fog(ball(1.0), 3.0, 1.0, 0.0), white_sky(), 4000),
        EmissionKind::Random,
        k,
    )
}

fn calibration(scene: &Scene) -> Calibration {
    LitScene::prepare(scene, &Unobserved).unwrap().report().calibration.unwrap()
}

/// Mean of estimates over the ball mean of exp(-t) / (4 pi t^2), at places where photons are: calibrated and with k.
fn point_light_means(scene: &Scene) -> [f64; 2] {
    let lit = LitScene::prepare(scene, &Unobserved).unwrap();
    let constant = lit.report().calibration.unwrap().constant;
    let mut reader = lit.reader();
    let mut random = Stream::Experiment.random(scene.photons.seed, 1);
    let queries = 1000;
    let mut sum = 0.0;
    for _ in 0..queries {
        let t = 0.1 - (1.0 - 0.9 * uniform(&mut random)).ln();
        let estimate = reader.power_density(t * random_direction(&mut random));
        let laplacian = 1.0 + 2.0 / t + 2.0 / (t * t);
        let smoothing = 1.0 + estimate.radius.powi(2) / 10.0 * laplacian;
        sum += estimate.value.x / (smoothing * (-t).exp() / (4.0 * PI * t * t));
    }
    let mean = sum / f64::from(queries);
    [mean, mean * scene.estimate.k as f64 / constant]
}

/// At least nine tenths of the bias of `k` go; of Sobol points, which strata stand in for, three quarters.
#[test]
fn first_collisions_are_read_without_bias() {
    for (kind, left) in
        [(EmissionKind::Random, 0.1), (EmissionKind::Stratified, 0.1), (EmissionKind::Sobol, 0.25)]
    {
        for k in [10, 30] {
            let mut scene = point_light(kind, k);
            let [mean, of_k] = over_seeds(&mut scene, point_light_means);
            let bias = of_k.mean - 1.0;
            assert!(bias > 10.0 * of_k.error, "{of_k:?}");
            mean.assert_within(1.0, left * bias, &format!("{kind:?} k {k}, bias {bias}"));
        }
    }
}

/// The fluence in a furnace is 4 pi. Paths come back to where they were: `k-1` reads too high, and c is below it.
#[test]
fn collisions_of_one_path_are_taken_off() {
    let k = 12;
    let mut scene = furnace(k);
    let [mean, of_less] = over_seeds(&mut scene, |scene| {
        let lit = LitScene::prepare(scene, &Unobserved).unwrap();
        let constant = lit.report().calibration.unwrap().constant;
        // All photons within a fixed radius of the same places: without bias, and it shares the noise of the map.
        let mut fixed = furnace(k);
        fixed.photons.seed = scene.photons.seed;
        fixed.estimate.k = 1_000_000;
        fixed.estimate.divisor = Divisor::K;
        fixed.estimate.max_radius = Some(0.2);
        let fixed = LitScene::prepare(&fixed, &Unobserved).unwrap();
        let (mut nearest, mut within) = (lit.reader(), fixed.reader());
        let mut random = Stream::Experiment.random(scene.photons.seed, 2);
        let mut sums = [0.0; 2];
        for _ in 0..2000 {
            let place = 0.7 * uniform(&mut random).cbrt() * random_direction(&mut random);
            sums[0] += nearest.fluence(place).value.x;
            sums[1] += within.fluence(place).value.x;
        }
        let mean = sums[0] / sums[1];
        [mean, mean * (k - 1) as f64 / constant]
    });
    let bias = of_less.mean - 1.0;
    assert!(bias > 4.0 * of_less.error, "{of_less:?}");
    mean.assert_within(1.0, 0.1 * bias, &format!("furnace, bias of k-1 {bias}"));
}

#[test]
fn independent_photons_count_as_one_less() {
    let Calibration { constant, std_error, law } =
        calibration(&point_light(EmissionKind::Random, 10));
    println!("c = {constant} +- {std_error}, {law:?}");
    assert!((constant - 9.0).abs() < LARGEST_Z * std_error + 1e-3, "{constant} +- {std_error}");
    assert!(std_error < 0.01);
    assert!((law.variance / 10.0 - 1.0).abs() < 0.01, "{law:?}");
}

/// Variance over mean of the number of photons in balls of fixed radius, over independent maps, the mean of each ball
/// removed. `ball` draws the centre and the radius of one.
fn variance_of_counts(scene: &mut Scene, ball: impl Fn(&mut Random) -> (DVec3, f64)) -> (f64, f64) {
    let mut random = Stream::Experiment.random(5, 0);
    let balls: Vec<(DVec3, f64)> = (0..300).map(|_| ball(&mut random)).collect();
    let maps = 64;
    let mut sums = vec![[0.0; 2]; balls.len()];
    for seed in 0..maps {
        scene.photons.seed = seed;
        let frame = frame(scene);
        let photons = trace(scene).photons;
        let places: Vec<DVec3> = photons.iter().map(|p| frame.to_world(p.position)).collect();
        for ((center, radius), [sum, squares]) in balls.iter().zip(&mut sums) {
            let within = |p: &&DVec3| p.distance_squared(*center) < radius * radius;
            let count = places.iter().filter(within).count() as f64;
            *sum += count;
            *squares += count * count;
        }
    }
    let maps = maps as f64;
    let mean = sums.iter().map(|[sum, _]| sum / maps).sum::<f64>() / balls.len() as f64;
    let variances = sums.iter().map(|[sum, squares]| (squares - sum * sum / maps) / (maps - 1.0));
    (variances.sum::<f64>() / balls.len() as f64, mean)
}

/// Pairs of photons drawn anew tell how the numbers of photons in balls vary, in one map.
#[test]
fn counts_vary_as_pairs_foretell() {
    let k = 20;
    let mut furnace = furnace(k);
    let law = calibration(&furnace).law;
    // 16 000 collisions, evenly spread.
    let radius = (k as f64 / 16_000.0).cbrt();
    let (variance, mean) = variance_of_counts(&mut furnace, |random| {
        (0.7 * uniform(random).cbrt() * random_direction(random), radius)
    });
    println!("furnace: counted {variance} of {mean}, {law:?}");
    assert!((mean / k as f64 - 1.0).abs() < 0.02, "{mean}");
    assert!(law.variance > 1.2 * k as f64, "{law:?}");
    assert!((variance / law.variance - 1.0).abs() < 0.07, "{variance} {law:?}");

    let mut stratified = point_light(EmissionKind::Stratified, k);
    let law = calibration(&stratified).law;
    // Balls of other photons, out to the k-th nearest: places as likely as the calibration's own.
    stratified.photons.seed = 1000;
    let frame = frame(&stratified);
    let others = trace(&stratified).photons;
    let places: Vec<DVec3> = others.iter().map(|p| frame.to_world(p.position)).collect();
    let (variance, mean) = variance_of_counts(&mut stratified, |random| {
        let center = places[(uniform(random) * places.len() as f64) as usize];
        let mut squares: Vec<f64> = places.iter().map(|p| p.distance_squared(center)).collect();
        let (_, square, _) = squares.select_nth_unstable_by(k, f64::total_cmp);
        (center, square.sqrt())
    });
    println!("point light: counted {variance} of {mean}, {law:?}");
    let expected = law.variance * (mean / k as f64).powf(law.exponent);
    assert!((mean / k as f64 - 1.0).abs() < 0.05, "{mean}");
    assert!((variance / expected - 1.0).abs() < 0.07, "{variance} {law:?}");
}

#[test]
fn any_number_of_threads_gives_the_same_constant() {
    let scene = furnace(20);
    let of_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| calibration(&scene))
    };
    assert_eq!(of_threads(1), of_threads(3));
}
