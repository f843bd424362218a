//! The estimate from the k nearest photons against kiddo's tree as it comes, payload included: processor time of both, turn by
//! turn, and the ratio of their medians. Both find the same photons, sum the same powers by the same phase function.
//!
//! `cargo bench --bench gather -- [PHOTONS]`

mod clouds;

use std::num::NonZeroUsize;

use clouds::Cloud;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use photonvdb::estimate::{EstimateOptions, Estimator, Kernel};
use photonvdb::map::PhotonMap;
use photonvdb::math::{DVec3, Rgb, Stream, uniform};
use photonvdb::medium::{Bounds, Medium, MediumExtinction, Phase, UniformExtinction};

const EXTINCTION: UniformExtinction = UniformExtinction { sigma_t: 1.0 };
const TOWARDS: DVec3 = DVec3::Z;
const ROUNDS: usize = 5;

fn main() {
    let count = std::env::args().filter_map(|arg| arg.parse().ok()).next().unwrap_or(1_000_000);
    println!("{count} photons, thousand estimates a second and core; ratio to plain kiddo");
    println!(
        "{:8} {:>4} {:>12} {:8} {:>8} {:>8} {:>6}",
        "cloud", "k", "phase", "order", "kiddo", "ours", "ratio"
    );
    for cloud in Cloud::ALL {
        for phase in [Phase::Isotropic, Phase::HenyeyGreenstein { g: 0.5 }] {
            let Some(map) = cloud.map(count, phase != Phase::Isotropic) else { return };
            let stored: Vec<[f32; 3]> =
                (0..map.len() as u32).map(|i| map.offset(i, [0.0; 3]).to_array()).collect();
            let Ok(tree) = ImmutableKdTree::<f32, 3>::new_from_slice(&stored) else { return };
            for k in [8, 50, 200].into_iter().filter_map(NonZeroUsize::new) {
                for order in ["tile", "random"] {
                    let mut places = clouds::queries();
                    if order == "random" {
                        shuffle(&mut places);
                    }
                    let [theirs, ours] = race(&map, &tree, phase, k, &places);
                    let rate = |seconds: f64| places.len() as f64 / seconds / 1000.0;
                    println!(
                        "{:8} {:>4} {:>12} {:8} {:>8.0} {:>8.0} {:>6.1}",
                        cloud.name(),
                        k,
                        if phase == Phase::Isotropic { "isotropic" } else { "HG" },
                        order,
                        rate(theirs),
                        rate(ours),
                        theirs / ours
                    );
                }
            }
        }
    }
}

/// Median processor seconds of both.
fn race(
    map: &PhotonMap,
    tree: &ImmutableKdTree<f32, 3>,
    phase: Phase,
    k: NonZeroUsize,
    places: &[DVec3],
) -> [f64; 2] {
    let medium = Medium {
        bounds: Bounds::Infinite,
        extinction: MediumExtinction::Uniform(EXTINCTION),
        albedo: Rgb::splat(0.9),
        color: None,
        emissivity: None,
        phase,
    };
    let options = EstimateOptions {
        k,
        constant: k.get() as f64,
        kernel: Kernel::Constant,
        max_radius: f64::INFINITY,
    };
    let mut estimator = Estimator::new(&medium, &EXTINCTION, map, options);
    let mut seconds = [Vec::new(), Vec::new()];
    for _ in 0..ROUNDS {
        let start = thread_seconds();
        let theirs: f64 = places.iter().map(|&p| by_kiddo(map, tree, phase, k, p).x).sum();
        let middle = thread_seconds();
        let ours: f64 =
            places.iter().map(|&p| estimator.in_scattered(p, TOWARDS, 0.5).multiple.x).sum();
        seconds[0].push(middle - start);
        seconds[1].push(thread_seconds() - middle);
        assert!((ours / theirs - 1.0).abs() < 1e-4, "{ours} {theirs}");
    }
    seconds.map(|mut seconds| {
        seconds.sort_by(f64::total_cmp);
        seconds[ROUNDS / 2]
    })
}

/// The estimate from kiddo's nearest photons.
fn by_kiddo(
    map: &PhotonMap,
    tree: &ImmutableKdTree<f32, 3>,
    phase: Phase,
    k: NonZeroUsize,
    place: DVec3,
) -> Rgb {
    let query = place.as_vec3().to_array();
    let nearest = tree.query(&query).nearest_n::<SquaredEuclidean<f32>>(k).execute();
    let mut sum = Rgb::ZERO;
    for found in &nearest {
        let [r, g, b] = map.power(found.item).map(f64::from);
        let density = match map.direction(found.item) {
            Some(incoming) => phase.density(incoming.dot(TOWARDS)),
            None => phase.density(1.0),
        };
        sum += Rgb::new(r, g, b) * density;
    }
    let square = nearest.last().map_or(0.0, |farthest| f64::from(farthest.distance));
    sum / (4.0 / 3.0 * std::f64::consts::PI * square * square.sqrt())
}

fn shuffle(places: &mut [DVec3]) {
    let mut random = Stream::Experiment.random(2, 0);
    for i in (1..places.len()).rev() {
        places.swap(i, (uniform(&mut random) * (i + 1) as f64) as usize);
    }
}

/// Processor time of this thread, which other programs do not lengthen; elapsed time where there is none.
#[cfg(unix)]
fn thread_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

#[cfg(not(unix))]
fn thread_seconds() -> f64 {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed().as_secs_f64()
}
