//! Random against stratified emission in a scene of known power density: the renderer's own photons against the laws.

use photonvdb::emission::EmissionKind;
use photonvdb::lab::{AnalyticScene, CompareRequest, CompareRow, CompareTable, LabError};

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
        assert!(stratified.variance_ratio.is_some_and(|ratio| ratio > 2.0), "{stratified:?}");

        for row in [random, stratified] {
            let both = (1.0 + row.intrinsic_bias) * (1.0 + row.smoothing_bias) - 1.0;
            // Up to their correlation: small balls are smoothed less and estimate more.
            assert!((row.total_bias / both - 1.0).abs() < 0.02, "{row:?}");
            assert!(row.low_95 < row.intrinsic_bias && row.intrinsic_bias < row.high_95);
        }
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
}
