//! Photon maps of photons that coincide, of fewer than k, and queries on a photon.

use std::f64::consts::PI;
use std::num::NonZeroUsize;
use std::time::Instant;

use super::super::error::ValidateError;
use super::super::report::Row;
use super::super::stage::fog;
use super::SEED;
use crate::estimate::{Estimate, EstimateOptions, Estimator, Kernel};
use crate::map::{Columns, PhotonMap, RADIUS_FLOOR};
use crate::math::{DVec3, Stream, uniform};
use crate::medium::{Bounds, UniformExtinction};
use crate::trace::{MapFrame, Photon};

const ON_PHOTON: &str = "query on a photon";
const IDENTICAL: &str = "identical photons";
const FEW: &str = "k > photons";

/// Largest radius of a query.
const REACH: f64 = 2.0;

pub(super) fn rows() -> Result<Vec<Row>, ValidateError> {
    let mut rows = on_a_photon()?;
    rows.extend(identical()?);
    rows.extend(fewer_than_k()?);
    Ok(rows)
}

fn map_of(positions: impl Iterator<Item = [f32; 3]>) -> Result<PhotonMap, ValidateError> {
    let photon = |position| Photon {
        position,
        direction: [0.0, 0.0, 1.0],
        power: [1.0; 3],
        sigma_t: 1.0,
        order: 0,
    };
    let photons: Vec<Photon> = positions.map(photon).collect();
    let frame = MapFrame { origin: DVec3::ZERO, unit: 1.0 };
    Ok(PhotonMap::build(&photons, frame, Columns::default())?)
}

/// The power density at a place, all k photons counted.
fn density(map: &PhotonMap, place: DVec3, k: usize) -> Estimate {
    let medium = fog(Bounds::Infinite, 1.0, 0.0, 0.0);
    let options = EstimateOptions {
        k: NonZeroUsize::new(k).unwrap_or(NonZeroUsize::MIN),
        constant: k as f64,
        kernel: Kernel::Constant,
        max_radius: REACH,
    };
    let extinction = UniformExtinction { sigma_t: 1.0 };
    Estimator::new(&medium, &extinction, map, options).power_density(place)
}

fn ball(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

fn on_a_photon() -> Result<Vec<Row>, ValidateError> {
    let map = map_of([[0.0; 3], [0.5, 0.0, 0.0], [0.0, 1.0, 0.0]].into_iter())?;
    let two = density(&map, DVec3::ZERO, 2);
    let one = density(&map, DVec3::ZERO, 1);
    let floor = f64::from(RADIUS_FLOOR);
    Ok(vec![
        Row::exact(ON_PHOTON, "k = 2: radius", 0.5, two.radius, 1e-7),
        Row::exact(ON_PHOTON, "k = 2: density", 2.0 / ball(0.5), two.value.x, 1e-6),
        Row::exact(
            ON_PHOTON,
            "k = 1: radius, in sizes of the medium, is floored",
            floor,
            one.radius,
            0.0,
        ),
        Row::holds(ON_PHOTON, "k = 1: density is a number", one.value.is_finite()),
    ])
}

fn identical() -> Result<Vec<Row>, ValidateError> {
    let count = 1_000_000;
    let mut random = Stream::Experiment.random(SEED, 0);
    let started = Instant::now();
    map_of((0..count).map(|_| std::array::from_fn(|_| uniform(&mut random) as f32)))?;
    let by_chance = started.elapsed();
    let started = Instant::now();
    let map = map_of((0..count).map(|_| [0.25, 0.5, -0.125]))?;
    let alike = density(&map, DVec3::new(0.25, 0.5, -0.125), 50);
    let far = density(&map, DVec3::new(0.25, 0.5, 0.875), 50);
    let elapsed = started.elapsed();
    let floor = f64::from(RADIUS_FLOOR);
    Ok(vec![
        Row::exact(IDENTICAL, "photons found", 50.0, alike.photon_count as f64, 0.0),
        Row::exact(IDENTICAL, "radius is floored", floor, alike.radius, 0.0),
        Row::holds(IDENTICAL, "density is a number", alike.value.is_finite()),
        Row::exact(IDENTICAL, "density 1 m away", 50.0 / ball(1.0), far.value.x, 1e-4),
        Row::holds(
            IDENTICAL,
            "a million are built and asked in 10 times the time of random ones",
            elapsed < 10 * by_chance,
        ),
    ])
}

/// All photons within the largest radius, over its ball: the rule where there are fewer than k.
fn fewer_than_k() -> Result<Vec<Row>, ValidateError> {
    let mut rows = Vec::new();
    for n in [0, 1, 2, 5] {
        let distance = |i: usize| 0.1 * (i + 1) as f32;
        let map = map_of((0..n).map(|i| [distance(i), 0.0, 0.0]))?;
        let worst = (1..=n + 2).map(|k| {
            let found = density(&map, DVec3::ZERO, k);
            let (count, radius) = match k <= n {
                true => (k, f64::from(distance(k - 1))),
                false => (n, REACH),
            };
            let exact = count as f64 / ball(radius);
            (found.value.x - exact).abs() / exact.max(1e-300)
        });
        let name = format!("{n} photons, k up to {}: largest relative error", n + 2);
        rows.push(Row::exact(FEW, name, 0.0, worst.fold(0.0, f64::max), 1e-6));
    }
    Ok(rows)
}
