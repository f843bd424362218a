//! The lab's experiments, `cargo bench --bench lab`: drawing only the order statistics that the k asked for depend on,
//! placing all n photons and selecting, and the way of the thesis's program, placing all and sorting all.
//!
//! All three draw from the same law, so that at equal numbers of trials they have equal standard errors, and their
//! times compare as they are.

use divan::{Bencher, black_box};
use photonvdb::lab::{Experiment, Method, Model};
use photonvdb::math::{Stream, uniform};

fn main() {
    divan::main();
}

const TRIALS: u64 = 512;

/// Models and photons as in the thesis's experiments.
const SETUPS: [(Model, u64); 4] = [
    (Model::Random(1), 100_000),
    (Model::Stratified, 100_000),
    (Model::Basic(3), 1000),
    (Model::Order(3), 1000),
];

fn names() -> impl Iterator<Item = &'static str> {
    SETUPS.into_iter().map(|(model, _)| model.name())
}

fn run(name: &str, method: Method) {
    let ks: Vec<u64> = (2..=200).collect();
    for (model, n) in SETUPS.into_iter().filter(|(model, _)| model.name() == name) {
        let experiment = Experiment { model, n, ks: &ks, trials: TRIALS, method, seed: 0 };
        black_box(experiment.run().ok());
    }
}

#[divan::bench(args = names())]
fn fast(bencher: Bencher, name: &str) {
    bencher.bench(|| run(name, Method::Fast));
}

#[divan::bench(args = names(), sample_count = 5, sample_size = 1)]
fn direct(bencher: Bencher, name: &str) {
    bencher.bench(|| run(name, Method::Direct));
}

/// One-dimensional photons, stratified or not, all placed and all sorted, on one thread.
#[divan::bench(args = [false, true], sample_count = 3, sample_size = 1)]
fn place_all_and_sort_all(bencher: Bencher, stratified: bool) {
    let n = 100_000;
    bencher.bench(|| {
        let mut random = Stream::Experiment.random(0, 0);
        let mut sums = [0.0; 199];
        for _ in 0..TRIALS {
            let mut distances: Vec<f64> = (0..n)
                .map(|photon| {
                    let place = if stratified {
                        2.0 * (f64::from(photon) + uniform(&mut random)) - f64::from(n)
                    } else {
                        f64::from(n) * (2.0 * uniform(&mut random) - 1.0)
                    };
                    place.abs()
                })
                .collect();
            distances.sort_unstable_by(f64::total_cmp);
            for (index, sum) in sums.iter_mut().enumerate() {
                *sum += (index + 2) as f64 / distances[index + 1];
            }
        }
        black_box(sums);
    });
}
