//! How fast estimates come to the truth: error of the k nearest by photons at the best k, and noise by passes.
//!
//! In three dimensions MSE = f^2 / k + (lap f / 10)^2 (3 k / (4 pi n f))^(4/3) to leading order: least at
//! k = (3 f^2 / (4 B))^(3/7) n^(4/7), B = (lap f / 10)^2 (3 / (4 pi f))^(4/3), where it falls as n^(-4/7), its bias as n^(-2/7).
//! k has to grow with n for that. Passes average noise and keep k and n: their bias stays, which is tested, too.

use std::f64::consts::PI;

use photonvdb::emission::EmissionKind;
use photonvdb::lab::AnalyticScene;
use photonvdb::math::{DVec3, Stream};
use photonvdb::medium::Bounds;
use photonvdb::render::{Gather, LitScene, RenderOptions, Unobserved, render};

use crate::transport_support::*;

/// Distance of the queries from the light, where exp(-r) / (4 pi r^2) has a Laplacian of 5 times itself.
const DISTANCE: f64 = 1.0;
const PLACES: u32 = 100;

/// Relative bias and variance of the estimate with `n` photons at the best k, and that k.
fn error_of(n: u64, maps: u64) -> (f64, f64, f64) {
    let exact = AnalyticScene::PointAbsorbing.power_density(DISTANCE * DVec3::X);
    let slope = (0.5 * exact).powi(2) * (3.0 / (4.0 * PI * exact)).powf(4.0 / 3.0);
    let k = (3.0 * exact * exact / (4.0 * slope)).powf(3.0 / 7.0) * (n as f64).powf(4.0 / 7.0);
    let mut scene = scene(grey_fog(Bounds::Infinite, 1.0, 0.0, 0.0), one_watt(DVec3::ZERO), n);
    scene.photons.emission = EmissionKind::Random;
    scene.render.photons_only = true;
    scene.estimate.k = k.round() as usize;
    scene.estimate.max_radius = Some(10.0);
    let mut values = Vec::new();
    for seed in 0..maps {
        scene.photons.seed = seed;
        let lit = LitScene::prepare(&scene, &Unobserved).unwrap();
        let mut reader = lit.reader();
        let mut random = Stream::Experiment.random(seed, n);
        for _ in 0..PLACES {
            let place = random_direction(&mut random) * DISTANCE;
            values.push(reader.power_density(place).value.x / exact - 1.0);
        }
    }
    let count = values.len() as f64;
    let bias = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|value| (value - bias).powi(2)).sum::<f64>() / (count - 1.0);
    (bias, variance, scene.estimate.k as f64)
}

/// Slope of a straight line through points on logarithmic axes.
fn slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |sum, log| (sum.0 + log.0, sum.1 + log.1));
    let (x, y) = (x / count, y / count);
    let above: f64 = logs.iter().map(|log| (log.0 - x) * (log.1 - y)).sum();
    above / logs.iter().map(|log| (log.0 - x).powi(2)).sum::<f64>()
}

#[test]
fn errors_of_the_k_nearest_fall_as_foretold() {
    let runs = [(4_000, 120), (16_000, 60), (64_000, 30), (256_000, 14)];
    let errors: Vec<(f64, f64, f64, f64)> = runs
        .iter()
        .map(|&(n, maps)| {
            let (bias, variance, k) = error_of(n, maps);
            println!(
                "n {n}, k {k}: bias {bias:.4}, variance {variance:.5} for 1/(k-2) {:.5}",
                1.0 / (k - 2.0)
            );
            (n as f64, bias, variance, k)
        })
        .collect();
    for &(n, bias, variance, k) in &errors {
        // The ball that is expected to hold k - 1 photons, blurred as it is exactly.
        let scene = AnalyticScene::PointAbsorbing;
        let radius = scene.ball_radius(DISTANCE * DVec3::X, (k - 1.0) / n).unwrap();
        let blur = scene.smoothing(DISTANCE * DVec3::X, radius);
        assert!((bias / blur - 1.0).abs() < 0.08, "n {n}: bias {bias} for {blur}");
        let noise = variance * (k - 2.0);
        assert!((0.8..1.35).contains(&noise), "n {n}: variance {variance}, k {k}");
    }
    let of = |figure: fn(&(f64, f64, f64, f64)) -> f64| {
        slope(&errors.iter().map(|error| (error.0, figure(error))).collect::<Vec<_>>())
    };
    let mse = of(|error| error.1 * error.1 + error.2);
    let bias = of(|error| error.1);
    let variance = of(|error| error.2);
    println!("slopes: error {mse:.3}, bias {bias:.3}, variance {variance:.3}");
    assert!((mse + 4.0 / 7.0).abs() < 0.06, "{mse}");
    assert!((bias + 2.0 / 7.0).abs() < 0.05, "{bias}");
    assert!((variance + 4.0 / 7.0).abs() < 0.08, "{variance}");
}

/// Passes with the k and n of one pass: the noise falls as their number, the mean stays where it was.
#[test]
fn passes_average_noise_and_keep_the_bias() {
    let mut scene = scene(grey_fog(CUBE, 2.0, 0.9, 0.0), one_watt(DVec3::ZERO), 400);
    (scene.camera.width, scene.camera.height) = (8, 8);
    scene.render.samples_per_pixel = 1;
    scene.estimate.k = 50;
    let mut statistics = Vec::new();
    for passes in [1, 4, 16] {
        let images: Vec<f64> = (0..64)
            .map(|seed| {
                scene.photons.seed = 1000 + seed;
                let film =
                    render(&scene, &RenderOptions::passes(passes), &Unobserved).unwrap().film;
                film.pixels.iter().map(|pixel| pixel.multiple_scatter.x).sum::<f64>() / 64.0
            })
            .collect();
        let runs = Runs::of(images.into_iter());
        println!("{passes} passes: {runs:?}");
        statistics.push((f64::from(passes), runs));
    }
    let errors: Vec<(f64, f64)> =
        statistics.iter().map(|(passes, runs)| (*passes, runs.error * runs.error)).collect();
    let rate = slope(&errors);
    // Of 64 images a variance is known to 18 %.
    assert!((rate + 1.0).abs() < 0.25, "{rate}");
    let [one, _, sixteen] = statistics[..] else { unreachable!() };
    one.1.minus(sixteen.1).assert_is(0.0, "mean of 1 and of 16 passes");
}

/// Towards a limit k shrinks from pass to pass: what is left of the mean of many passes gets smaller, where passes of one k
/// keep it.
#[test]
fn passes_of_shrinking_k_converge() {
    let mut scene = scene(grey_fog(CUBE, 2.0, 0.9, 0.0), one_watt(DVec3::ZERO), 4000);
    (scene.camera.width, scene.camera.height) = (8, 8);
    scene.render.samples_per_pixel = 1;
    scene.estimate.k = 800;
    scene.estimate.max_radius = Some(10.0);
    // Fine cells and many photons: off by less than 1 %.
    scene.render.gather = Gather::Lattice;
    scene.render.lattice = Some(64);
    scene.photons.count = 400_000;
    scene.render.samples_per_pixel = 128;
    let truth = render(&scene, &RenderOptions::passes(4), &Unobserved).unwrap().film;
    scene.render.gather = Gather::Knn;
    scene.photons.count = 4000;
    scene.render.samples_per_pixel = 1;
    let truth: Vec<f64> = truth.pixels.iter().map(|pixel| pixel.multiple_scatter.x).collect();
    let mut bias = |passes: u32, seconds: Option<f64>| {
        let images: Vec<Vec<f64>> = (0..6)
            .map(|seed| {
                scene.photons.seed = 2000 + seed;
                let options = RenderOptions { seconds, ..RenderOptions::passes(passes) };
                let film = render(&scene, &options, &Unobserved).unwrap().film;
                film.pixels.iter().map(|pixel| pixel.multiple_scatter.x).collect()
            })
            .collect();
        let squares = truth.iter().enumerate().map(|(pixel, truth)| {
            let values = images.iter().map(|image| image[pixel]);
            let mean = values.clone().sum::<f64>() / 6.0;
            let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / 5.0 / 6.0;
            (mean - truth).powi(2) - variance
        });
        (squares.sum::<f64>().max(0.0) / truth.iter().map(|t| t * t).sum::<f64>()).sqrt()
    };
    let (fixed, shrinking) = (bias(32, None), bias(32, Some(1e9)));
    println!("bias of 32 passes: {fixed:.4}, with shrinking k {shrinking:.4}");
    assert!(shrinking < 0.5 * fixed, "{fixed} {shrinking}");
}
