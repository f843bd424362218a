//! Random against stratified emission in scene files, where theory knows the answer as well.

use photonvdb::emission::EmissionKind;
use photonvdb::film::RgbImage;
use photonvdb::lab::{PointRow, SceneComparison, SceneComparisonError, SceneTable};
use photonvdb::scene::Scene;

/// |z| that 1 of 150 000 standard normal numbers exceeds.
const LIMIT: f64 = 4.5;

const CAMERA: &str = "[camera]
position = [0.0, 0.0, -6.0]
look_at = [0.0, 0.0, 0.0]
vertical_fov = 12.0
resolution = [8, 6]
";

/// Parallel light on a box that absorbs nearly all of it.
const BEAM: &str = r#"
[medium]
kind = "homogeneous"
bounds = { min = [-1.0, -1.0, 0.0], max = [1.0, 1.0, 2.0] }
sigma_t = 1.0
albedo = 0.02
[[light]]
kind = "directional"
direction = [0.0, 0.0, 1.0]
irradiance = 1.0
[render]
photons_only = true
"#;

/// Radiance 1 all around a ball that absorbs nothing: radiance 1 everywhere.
const FURNACE: &str = r#"
[medium]
kind = "homogeneous"
bounds = { center = [0.0, 0.0, 0.0], radius = 1.0 }
sigma_t = 1.0
albedo = 1.0
[[light]]
kind = "environment"
radiance = 1.0
"#;

fn scene(rest: &str) -> Scene {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("scene.toml");
    std::fs::write(&path, format!("{CAMERA}{rest}")).unwrap();
    Scene::load(&path).unwrap()
}

fn request(n: u64, runs: u64, queries: u64) -> SceneComparison {
    SceneComparison {
        emissions: vec![EmissionKind::Random, EmissionKind::Stratified],
        ks: vec![10, 20],
        n,
        runs,
        queries,
        reference_photons: 2 * n,
        seed: 3,
    }
}

fn tabulate(request: &SceneComparison, rest: &str, reference: Option<&RgbImage>) -> SceneTable {
    request.tabulate(&mut scene(rest), reference, || None, || ()).unwrap()
}

fn point<'a>(table: &'a SceneTable, emission: &str, k: u64) -> &'a PointRow {
    table.points.iter().find(|row| row.emission == emission && row.k == k).unwrap()
}

#[test]
fn points_of_a_beam_obey_the_laws() {
    let table = tabulate(&request(50_000, 40, 400), BEAM, None);
    for k in [10, 20] {
        let random = point(&table, "random", k);
        let error = random.std_error.hypot(random.reference_std_error);
        let z = (random.intrinsic_bias - 1.0 / (k as f64 - 1.0)) / error;
        assert!(z.abs() < LIMIT, "z = {z}: {random:?}");
        let z = random.intrinsic_bias_k_minus_1 / error;
        assert!(z.abs() < LIMIT, "z = {z}: {random:?}");
        assert!((random.low_95..random.high_95).contains(&random.intrinsic_bias));

        // One photon a cell, which is a little longer than wide where light is weak.
        let stratified = point(&table, "stratified", k);
        let k = k as f64;
        let law = k / (k - 0.5 - 0.533 * k.powf(-1.0 / 3.0)) - 1.0;
        let error = stratified.std_error.hypot(stratified.reference_std_error);
        let difference = (stratified.intrinsic_bias - law).abs();
        assert!(difference < LIMIT * error + 0.1 * law, "{law}: {stratified:?}");
        assert!(stratified.variance_ratio.is_some_and(|ratio| ratio > 2.0), "{stratified:?}");
    }
    let saving = &table.point_savings[1];
    assert_eq!((saving.emission, saving.k, saving.seconds), ("stratified", 20, None));
    assert_eq!(Some(saving.photons), point(&table, "stratified", 20).error_ratio);
}

/// The furnace's image is 1 in every pixel.
#[test]
fn pixels_of_a_furnace_are_held_against_a_given_image() {
    let ones = RgbImage { width: 16, height: 12, pixels: vec![[1.0; 3]; 16 * 12] };
    let table = tabulate(&request(10_000, 40, 20), FURNACE, Some(&ones));
    assert_eq!((table.reference.image_runs, table.reference.image_photons), (0, 0));
    for row in &table.pixels {
        // Boundaries bias k-nearest estimates a little.
        assert!(row.bias.abs() < LIMIT * row.std_error + 0.01, "{row:?}");
        assert!(row.local_bias < 0.02 && row.reference_std_error == 0.0, "{row:?}");
        let parts = row.variance + row.local_bias.powi(2);
        assert!((row.squared_error / parts - 1.0).abs() < 0.1, "{row:?}");
        assert!((row.rel_rmse / row.squared_error.sqrt() - 1.0).abs() < 1e-12, "{row:?}");
    }
    assert_eq!(table.pixels[0].variance_ratio, Some(1.0));
}

/// Without an image given, one is made: the same truth but for its own noise, which is told.
#[test]
fn pixels_of_a_furnace_are_held_against_an_image_made_here() {
    let table = tabulate(&request(10_000, 32, 20), FURNACE, None);
    assert_eq!((table.reference.image_runs, table.reference.image_photons), (8, 20_000));
    for row in &table.pixels {
        let error = row.std_error.hypot(row.reference_std_error);
        assert!(row.bias.abs() < LIMIT * error + 0.01, "{row:?}");
        assert!(row.reference_std_error > 0.0 && table.reference.image_noise > 0.0);
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let request = SceneComparison { reference_photons: 4000, ..request(4000, 2, 40) };
    let csv = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let table = pool.install(|| tabulate(&request, FURNACE, None));
        assert!(table.to_csv_with_times().starts_with("target,emission,k,"));
        table.to_csv()
    };
    let one = csv(1);
    assert_eq!(one, csv(2));
    assert_eq!(one.lines().count(), 1 + 2 * 2 + 2);
    let columns = one.lines().next().unwrap().split(',').count();
    assert!(one.lines().all(|line| line.split(',').count() == columns));
}

#[test]
fn what_cannot_be_compared_says_the_way_out() {
    let request = request(1000, 2, 10);
    let refused = |request: &SceneComparison, rest: &str, reference: Option<&RgbImage>| {
        request.tabulate(&mut scene(rest), reference, || None, || ()).unwrap_err()
    };
    let scattered = BEAM.replace("photons_only = true", "");
    let error = refused(&request, &scattered, None);
    assert!(matches!(error, SceneComparisonError::TooFewPhotons { n: 1000, .. }), "{error}");
    assert!(error.to_string().contains("--photons-only"), "{error}");

    let many = SceneComparison { ks: vec![5000], ..request.clone() };
    let error = refused(&many, BEAM, None);
    assert!(error.to_string().contains("raise --n or lower --k"), "{error}");

    let error = refused(&request, &BEAM.replace("albedo = 0.02", "albedo = 0.0"), None);
    assert!(matches!(error, SceneComparisonError::BlackReference), "{error}");
    let image = |light: f32| RgbImage { width: 8, height: 6, pixels: vec![[light; 3]; 48] };
    let error = refused(&request, FURNACE, Some(&image(0.0)));
    assert!(matches!(error, SceneComparisonError::BlackReference), "{error}");
    let wide = RgbImage { width: 12, height: 4, ..image(1.0) };
    let error = refused(&request, FURNACE, Some(&wide));
    assert!(error.to_string().contains("--pixels"), "{error}");
    let vast = SceneComparison { queries: 1 << 40, ..request };
    let error = refused(&vast, FURNACE, None);
    assert!(error.to_string().contains("lower --queries"), "{error}");
}
