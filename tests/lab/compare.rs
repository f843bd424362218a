//! Random against stratified emission in a scene of known power density: the renderer's own photons against the laws.

use photonvdb::emission::EmissionKind;
use photonvdb::lab::{AnalyticScene, CompareRequest, CompareRow, CompareTable, LabError};
use photonvdb::math::DVec3;

/// |z| that 1 of 150 000 standard normal numbers exceeds.
const LIMIT: f64 = 4.5;

fn request(n: u64, runs: u64, queries: u64) -> CompareRequest {
    CompareRequest {
        scene: AnalyticScene::PointAbsorbing,
        emissions: vec![EmissionKind::Random, EmissionKind::Stratified],
        ks: vec![5, 10, 20],
        n,
        runs,
        queries,
        seed: 11,
    }
}

fn tabulate(request: &CompareRequest, threads: usize) -> CompareTable {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| request.tabulate(|| None, || ()).unwrap())
}

fn row<'a>(table: &'a CompareTable, emission: &str, k: u64) -> &'a CompareRow {
    table.rows.iter().find(|row| row.emission == emission && row.k == k).unwrap()
}

#[test]
fn biases_are_those_of_the_laws() {
    let table = tabulate(&request(100_000, 40, 1000), 2);
    for k in [5, 10, 20] {
        let random = row(&table, "random", k);
        assert!(random.law_z.abs() < LIMIT, "{random:?}");
        assert!((random.law_bias - 1.0 / (k as f64 - 1.0)).abs() < 1e-15);
        // Of independent photons the number in a ball has its mean as variance.
        assert!((random.count_variance / k as f64 - 1.0).abs() < 0.05, "{random:?}");
        assert!((random.variance / random.law_variance - 1.0).abs() < 0.1, "{random:?}");

        let stratified = row(&table, "stratified", k);
        let error = stratified.std_error;
        let gain =
            (random.intrinsic_bias - stratified.intrinsic_bias) / random.std_error.hypot(error);
        assert!(gain > 5.0 || k != 10, "k = {k}: z = {gain}");
        // One photon a cell: as the numbers of photons in balls vary, so are estimates biased.
        let difference = (stratified.intrinsic_bias - stratified.count_law_bias).abs();
        let allowed = 3.0 * error + 0.05 * stratified.count_law_bias;
        assert!(difference < allowed, "{stratified:?}");
        // Cells are cubic where queries are: the law of one photon a cubic cell holds.
        let difference = (stratified.intrinsic_bias - stratified.law_bias).abs();
        let allowed = 3.0 * error + 0.05 * stratified.law_bias;
        assert!(difference < allowed, "{stratified:?}");
        // The maps of one half calibrate the other.
        for row in [random, stratified] {
            let left = row.intrinsic_bias_calibrated.abs();
            assert!(left < 0.1 * row.intrinsic_bias + 3.0 * row.std_error, "{row:?}");
        }
        assert!((random.calibrated_k - (k as f64 - 1.0)).abs() < 0.05, "{random:?}");
        assert!(stratified.calibrated_removed > 0.9 || k < 10, "{stratified:?}");
        assert!(stratified.variance_ratio.is_some_and(|ratio| ratio > 2.3), "{stratified:?}");

        for row in [random, stratified] {
            let both = (1.0 + row.intrinsic_bias) * (1.0 + row.smoothing_bias) - 1.0;
            // Up to their correlation: small balls are smoothed less and estimate more.
            assert!((row.total_bias / both - 1.0).abs() < 0.02, "{row:?}");
            assert!(row.low_95 < row.intrinsic_bias && row.intrinsic_bias < row.high_95);
        }
    }
}

/// Collisions of a photon between two distances, 4 pi int t^2 p dt by Simpson's rule, against transport theory.
#[test]
fn power_densities_add_up_to_known_collisions() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/validate/truth/infinite.json");
    let truth: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    for (scene, albedo) in
        [(AnalyticScene::PointAbsorbing, "0"), (AnalyticScene::PointScattering, "0.9")]
    {
        for (from, to) in [("0.5", "1"), ("1", "2")] {
            let within = |radius: &str| truth["enclosed"][albedo][radius].as_f64().unwrap();
            let (low, high): (f64, f64) = (from.parse().unwrap(), to.parse().unwrap());
            let steps = 1000;
            let width = (high - low) / f64::from(steps);
            let terms = (0..=steps).map(|i| {
                let t = low + f64::from(i) * width;
                let weight = if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
                weight * t * t * scene.power_density(DVec3::new(0.0, t, 0.0))
            });
            let sum = 4.0 * std::f64::consts::PI * width / 3.0 * terms.sum::<f64>();
            let exact = within(to) - within(from);
            assert!((sum / exact - 1.0).abs() < 1e-10, "{scene:?} {from}..{to}: {sum} {exact}");
        }
    }
}

/// Scattered photons are as good as independent: stratification is worth less, and the variance of counts tells how much.
#[test]
fn scattering_undoes_strata_as_counts_foretell() {
    let scattering = CompareRequest {
        scene: AnalyticScene::PointScattering,
        ks: vec![10, 20],
        ..request(20_000, 32, 300)
    };
    let table = tabulate(&scattering, 2);
    for row in &table.rows {
        let difference = (row.intrinsic_bias - row.count_law_bias).abs();
        assert!(difference < LIMIT * row.std_error + 0.05 * row.count_law_bias, "{row:?}");
        if row.emission == "stratified" {
            assert!(row.variance_ratio.is_some_and(|ratio| ratio < 2.0), "{row:?}");
        }
    }
}

/// A furnace has the same density up to its faces and corners, photons of unequal power, and clusters of the collisions of one
/// photon: random emission reads 1/(k-1) too much all the same, k - 1 nothing.
#[test]
fn furnaces_are_read_evenly_up_to_their_faces() {
    for scene in [AnalyticScene::UniformBall, AnalyticScene::UniformBox] {
        let furnace = CompareRequest { scene, ..request(50_000, 40, 500) };
        let table = tabulate(&furnace, 2);
        for row in &table.rows {
            assert_eq!((row.smoothing_bias, row.total_bias), (0.0, row.intrinsic_bias));
            let allowed = LIMIT * row.std_error + 0.05 * row.count_law_bias;
            let difference = (row.intrinsic_bias - row.count_law_bias).abs();
            assert!(difference < allowed, "{row:?}");
            if row.emission == "random" {
                assert!(row.law_z.abs() < LIMIT, "{row:?}");
                let z = row.intrinsic_bias_k_minus_1 / row.std_error;
                assert!(z.abs() < LIMIT, "{row:?}");
            } else {
                // Five dimensions of strata, and photons that have scattered, leave little.
                assert!(row.variance_ratio.is_some_and(|r| (0.8..1.5).contains(&r)), "{row:?}");
            }
        }
    }
}

/// Parallel light is stratified in three dimensions as light of a point is.
#[test]
fn a_beam_obeys_the_laws() {
    let beam = CompareRequest { scene: AnalyticScene::Beam, ..request(100_000, 40, 500) };
    let table = tabulate(&beam, 2);
    for k in [5, 10, 20] {
        let random = row(&table, "random", k);
        assert!(random.law_z.abs() < LIMIT, "{random:?}");
        let stratified = row(&table, "stratified", k);
        let difference = (stratified.intrinsic_bias - stratified.law_bias).abs();
        let allowed = 3.0 * stratified.std_error + 0.05 * stratified.law_bias;
        assert!(difference < allowed, "{stratified:?}");
        assert!(stratified.variance_ratio.is_some_and(|ratio| ratio > 2.3), "{stratified:?}");
        // 0.1 R^2, up to the spread of R.
        let smoothing = stratified.smoothing_bias / stratified.smoothing_bias_exact;
        assert!((0.9..1.4).contains(&smoothing), "{stratified:?}");
    }
}

/// What is saved is told against the random emission of the same k.
#[test]
fn savings_are_photons_and_seconds_of_random_emission() {
    let time = std::cell::Cell::new(0.0);
    let request = request(20_000, 3, 50);
    let processor_seconds = || {
        time.set(time.get() + 1.0);
        Some(time.get())
    };
    let table = request.tabulate(processor_seconds, || ()).unwrap();
    assert_eq!(table.savings.len(), 3);
    for saving in &table.savings {
        let [random, own] = ["random", saving.emission].map(|name| row(&table, name, saving.k));
        assert_eq!(saving.photons, own.photon_ratio / random.photon_ratio);
        // All maps took as long.
        assert_eq!(saving.seconds, Some(saving.photons));
    }
    let (plain, timed) = (table.to_csv(), table.to_csv_with_times());
    for (plain, timed) in plain.lines().zip(timed.lines()) {
        assert!(
            timed.starts_with(plain) && timed.split(',').count() == plain.split(',').count() + 3
        );
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let request = CompareRequest {
        emissions: vec![EmissionKind::Stratified, EmissionKind::Sobol],
        ..request(20_000, 3, 50)
    };
    let csv = tabulate(&request, 1).to_csv();
    assert_eq!(csv, tabulate(&request, 2).to_csv());
    assert_eq!(csv.lines().count(), 7);
    let columns = csv.lines().next().unwrap().split(',').count();
    assert!(csv.lines().all(|line| line.split(',').count() == columns));
}

#[test]
fn balls_that_would_reach_the_light_are_refused() {
    let few = CompareRequest { ks: vec![100], ..request(500, 2, 10) };
    let refused = few.tabulate(|| None, || ()).map(|table| table.rows.len());
    assert_eq!(refused, Err(LabError::BallTooLarge { k: 100, n: 500 }));
    let one = CompareRequest { ks: vec![1], ..request(500, 2, 10) };
    let refused = one.tabulate(|| None, || ()).map(|table| table.rows.len());
    assert_eq!(refused, Err(LabError::InfiniteMean { k: 1 }));
}
