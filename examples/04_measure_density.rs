//! Measures the power density around a point light against its exact value, with each divisor.
//!
//! A ball of absorbing fog around a point light: every photon ends at its first collision, and the power density
//! is Phi sigma_t exp(-sigma_t r) / (4 pi r^2) exactly. Two errors add up. The estimator's own is that of the
//! k-th photon: 1 / (k - 1) with the divisor `k` and random emission, 0 with `k-1`. Smoothing is the rest: the mean
//! of a curved density over the query's ball is not the density at its centre. It is printed beside.
//!
//! ```sh
//! cargo run --release --example 04_measure_density
//! ```

use std::f64::consts::PI;
use std::num::NonZeroUsize;

use photonvdb::emission::{Emission, EmissionKind};
use photonvdb::estimate::{Divisor, EstimateOptions, Estimator, Kernel};
use photonvdb::light::{Light, PointLight};
use photonvdb::map::{Columns, MapError, PhotonMap};
use photonvdb::math::square_maps::square_to_sphere;
use photonvdb::math::{DVec2, DVec3, Ray, Rgb, Stream, uniform};
use photonvdb::medium::{Bounds, Medium, MediumExtinction, Phase, UniformExtinction};
use photonvdb::trace::{MapFrame, TraceSettings, trace_photons};

const PHOTONS: u64 = 100_000;
const K: usize = 10;
/// Independent photon maps; the standard errors come from them.
const MAPS: u64 = 200;
/// Places asked per map and radius, in random directions.
const PLACES: usize = 100;

const SIGMA_T: f64 = 1.0;
/// Power of the light \[W\].
const PHI: f64 = 1.0;
const RADII: [f64; 3] = [0.5, 1.0, 2.0];
const DIVISORS: [Divisor; 3] = [Divisor::K, Divisor::KMinusHalf, Divisor::KMinus1];

fn main() -> Result<(), MapError> {
    let center = DVec3::ZERO;
    let medium = Medium {
        bounds: Bounds::Sphere { center, radius: 4.0 },
        extinction: MediumExtinction::Uniform(UniformExtinction { sigma_t: SIGMA_T }),
        albedo: Rgb::ZERO,
        color: None,
        emissivity: None,
        phase: Phase::Isotropic,
    };
    let intensity = Rgb::splat(PHI / (4.0 * PI));
    let lights = [Light::Point(PointLight { position: center, intensity })];

    println!("{PHOTONS} photons, k = {K}, {MAPS} maps of {PLACES} places a radius");
    println!("1 / (k - 1) = {:+.2} %\n", 100.0 / (K as f64 - 1.0));
    println!("emission    r [m]  exact [W/m^3]  divisor  measured  relative error      smoothing");
    for (name, kind) in [("random", EmissionKind::Random), ("stratified", EmissionKind::Stratified)]
    {
        let maps = (0..MAPS)
            .map(|seed| measure_map(&medium, &lights, kind, seed))
            .collect::<Result<Vec<_>, _>>()?;
        print_rows(name, &maps);
    }
    Ok(())
}

/// Means over the places of one map: per radius, the estimate of each divisor and the squared radius.
type MapMeans = [([f64; DIVISORS.len()], f64); RADII.len()];

fn measure_map(
    medium: &Medium,
    lights: &[Light],
    kind: EmissionKind,
    seed: u64,
) -> Result<MapMeans, MapError> {
    let extinction = UniformExtinction { sigma_t: SIGMA_T };
    // Emission -> photons -> map: the library's stages, one by one.
    let opacity = |ray: &Ray| match medium.bounds.intersect(ray) {
        Some(span) => -(-SIGMA_T * span.length()).exp_m1(),
        None => 0.0,
    };
    let mean_free_path = 1.0 / SIGMA_T;
    let emission = Emission::new(lights, medium, opacity, mean_free_path, kind, PHOTONS, seed);
    let frame = MapFrame::of(medium, None);
    let settings = TraceSettings { max_order: 1, min_stored_order: 0, max_stored: 1 << 24 };
    let traced = trace_photons(&emission, medium, &extinction, frame, settings, |_| {});
    let map = PhotonMap::build(&traced.photons, frame, Columns::default())?;

    let mut estimators = DIVISORS.map(|divisor| {
        let k = NonZeroUsize::MIN.saturating_add(K - 1);
        let constant = divisor.constant(k).unwrap_or(K as f64);
        let options =
            EstimateOptions { k, constant, kernel: Kernel::Constant, max_radius: f64::INFINITY };
        Estimator::new(medium, &extinction, &map, options)
    });
    let mut random = Stream::Experiment.random(seed, 0);
    Ok(RADII.map(|radius| {
        let (mut means, mut squared_radius) = ([0.0; DIVISORS.len()], 0.0);
        for _ in 0..PLACES {
            let u = DVec2::new(uniform(&mut random), uniform(&mut random));
            let place = radius * square_to_sphere(u);
            for (mean, estimator) in means.iter_mut().zip(&mut estimators) {
                let estimate = estimator.power_density(place);
                *mean += estimate.value.x / PLACES as f64;
                squared_radius += estimate.radius.powi(2) / (PLACES * DIVISORS.len()) as f64;
            }
        }
        (means, squared_radius)
    }))
}

fn print_rows(emission: &str, maps: &[MapMeans]) {
    for (row, r) in RADII.into_iter().enumerate() {
        let exact = PHI * SIGMA_T * (-SIGMA_T * r).exp() / (4.0 * PI * r * r);
        let squared_radius = maps.iter().map(|map| map[row].1).sum::<f64>() / maps.len() as f64;
        for (column, divisor) in DIVISORS.into_iter().enumerate() {
            let errors = maps.iter().map(|map| map[row].0[column] / exact - 1.0);
            let (error, std_error) = mean_and_std_error(errors.collect());
            println!(
                "{emission:<10}  {r:>5.2}  {exact:>13.6}  {:<7}  {:>8.6}  {:>+6.2} ± {:.2} %  {:>+10.2} %",
                divisor.name(),
                exact * (1.0 + error),
                100.0 * error,
                100.0 * std_error,
                100.0 * smoothing(r, squared_radius),
            );
        }
    }
}

/// Relative error of the mean over a small ball: (R^2 / 10) (p'' + 2 p' / r) / p.
fn smoothing(r: f64, squared_radius: f64) -> f64 {
    let slope = SIGMA_T + 2.0 / r;
    squared_radius / 10.0 * (2.0 / (r * r) + slope * slope - 2.0 * slope / r)
}

fn mean_and_std_error(values: Vec<f64>) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    (mean, (squares / (count - 1.0) / count).sqrt())
}
