//! Media that vary: optical depths in closed form, and how delta and ratio tracking scatter about the transmittance.
//!
//! Ratio tracking with majorant m has E\[w^2\] = exp(-2 tau + int sigma^2 / m); it is walked here over the grid's own lookups. Delta
//! tracking is the tracer's own: a flight escapes with probability T, variance T (1 - T).

use super::Extent;
use super::check::{Check, Quantity};
use super::error::ValidateError;
use super::field::{extinction, sparse};
use super::report::Row;
use super::truth::{FreeFlight, Hetero, Tracking, Truth};
use crate::math::{DAffine3, DVec3, Random, Ray, Rgb, Span, Stream, uniform};
use crate::medium::{Extinction, Flight, GridExtinction};

const GROUP: &str = "heterogeneous";

/// A grid and the part of a ray through it.
struct Crossing {
    extinction: GridExtinction,
    ray: Ray,
    span: Span,
}

impl Crossing {
    fn new(extinction: GridExtinction, from: DVec3, to: DVec3) -> Self {
        let length = (to - from).length();
        let ray = Ray::new(from, (to - from) / length);
        Self { extinction, ray, span: Span::new(0.0, length) }
    }
}

/// sigma_t = 0.75 x up to x = 8, in voxels of 1/8.
fn ramp() -> Result<GridExtinction, ValidateError> {
    let grid = sparse([-16, -3, -3], [64, 3, 3], 0.0, |[x, ..]| f64::from(x.max(0)) / 8.0);
    extinction(&grid, DAffine3::from_scale(DVec3::splat(0.125)), 0.75)
}

/// sigma_t = 3 exp(-2 r^2) about lines along x, in voxels of 1/32 (1/10 across): trapezia of a Gaussian are exact.
fn gaussian(y_steps: i32, z_steps: i32) -> Result<GridExtinction, ValidateError> {
    let step = DVec3::new(1.0 / 32.0, 0.1, 0.1);
    let (low, high) = ([-96, y_steps - 1, z_steps - 1], [96, y_steps + 1, z_steps + 1]);
    let grid = sparse(low, high, 0.0, |voxel| {
        let place = DVec3::from_array(voxel.map(f64::from)) * step;
        (-2.0 * place.length_squared()).exp()
    });
    extinction(&grid, DAffine3::from_scale(step), 3.0)
}

fn crossing(name: &str) -> Result<Option<Crossing>, ValidateError> {
    let corners = [[[0.5, 1.5], [2.0, 0.0]], [[3.0, 0.25], [0.0, 5.0]]];
    let two = || {
        let grid = sparse([0; 3], [1, 0, 0], 0.0, |[x, ..]| 4.0 * f64::from(x));
        extinction(&grid, DAffine3::IDENTITY, 1.0)
    };
    let x = |from: f64, to: f64, y: f64, z: f64| (DVec3::new(from, y, z), DVec3::new(to, y, z));
    let (extinction, (from, to)) = match name {
        "ramp_axis" | "ramp_axis_majorant3" => (ramp()?, x(0.0, 2.0, 0.0, 0.0)),
        "ramp_oblique" => {
            let step = 0.1;
            let grid = sparse([-1; 3], [19; 3], 0.0, |voxel| {
                let [x, y, z] = voxel.map(|c| step * f64::from(c));
                0.2 + x - 0.1 * y + 0.05 * z
            });
            let place = DAffine3::from_scale(DVec3::splat(step));
            let end = DVec3::splat(3.0_f64.sqrt());
            (extinction(&grid, place, 1.0)?, (DVec3::ZERO, end))
        }
        "gauss_center" => (gaussian(0, 0)?, x(-5.0, 5.0, 0.0, 0.0)),
        "gauss_offset" => (gaussian(7, 2)?, x(-5.0, 5.0, 0.7, 0.2)),
        "tri_2voxel_axis" => (two()?, x(0.0, 1.0, 0.0, 0.0)),
        "vdb_2voxel_background0_offset" => (two()?, x(0.0, 1.0, 0.5, 0.5)),
        "tri_8_diagonal" => {
            let grid = sparse([0; 3], [1; 3], 0.0, |voxel| {
                let [x, y, z] = voxel.map(|c| c as usize);
                corners[x][y][z]
            });
            (extinction(&grid, DAffine3::IDENTITY, 1.0)?, (DVec3::ZERO, DVec3::ONE))
        }
        _ => return Ok(None),
    };
    Ok(Some(Crossing::new(extinction, from, to)))
}

/// Depths forwards and backwards; densities are of single precision.
pub(super) fn depths(truth: &Truth) -> Result<Vec<Row>, ValidateError> {
    let mut rows = Vec::new();
    for row in &truth.hetero.depths {
        let Some(Crossing { extinction, ray, span }) = crossing(&row.name)? else { continue };
        let forwards = extinction.optical_depth(&ray, span).x;
        let back = Ray::new(ray.at(span.end), -ray.direction);
        let backwards = extinction.optical_depth(&back, span).x;
        let name = &row.name;
        rows.push(Row::exact(GROUP, format!("{name}: depth"), row.tau, forwards, 1e-6 * row.tau));
        let tolerance = 1e-12 * row.tau;
        let reversed = format!("E17, {name}: depth of the reversed ray");
        rows.push(Row::exact(GROUP, reversed, forwards, backwards, tolerance));
    }
    Ok(rows)
}

pub(super) fn checks(extent: Extent, truth: &Hetero) -> Result<Vec<Check<'_>>, ValidateError> {
    let mut checks = Vec::new();
    for row in &truth.tracking {
        if let Some(crossing) = crossing(&row.name)? {
            checks.push(tracking(extent, row, crossing));
        }
    }
    checks.push(free_flight(extent, truth.free_flight, ramp()?));
    Ok(checks)
}

fn tracking(extent: Extent, row: &Tracking, crossing: Crossing) -> Check<'_> {
    let count = extent.pick(2000, 20_000);
    let name = &row.name;
    let quantities = vec![
        Quantity::new(format!("{name}: delta tracking, mean"), row.transmittance),
        Quantity::new(format!("{name}: delta tracking, variance"), row.delta_variance),
        Quantity::new(format!("{name}: ratio tracking, mean"), row.transmittance),
        Quantity::new(format!("{name}: ratio tracking, variance"), row.ratio_variance),
        Quantity::new(format!("{name}: ratio tracking, lookups"), row.lookups),
    ];
    Check::new(GROUP, quantities, count, move |batch| {
        let Crossing { extinction, ray, span } = &crossing;
        let mut random = Stream::Experiment.random(batch.seed, 0);
        let (mut delta, mut ratio, mut lookups) = (Vec::new(), Vec::new(), 0);
        for _ in 0..batch.count {
            let flight = extinction.sample_flight(ray, *span, Rgb::ONE, &mut random);
            delta.push(f64::from(u8::from(matches!(flight, Flight::Escape { .. }))));
            let (weight, looked) = ratio_track(&crossing, row.majorant, &mut random);
            ratio.push(weight);
            lookups += looked;
        }
        let [delta, ratio] = [delta, ratio].map(|values| mean_and_variance(&values));
        let lookups = f64::from(lookups) / batch.count as f64;
        Ok(vec![delta.0, delta.1, ratio.0, ratio.1, lookups])
    })
}

/// One estimate of the transmittance, and the lookups it took.
fn ratio_track(crossing: &Crossing, majorant: f64, random: &mut Random) -> (f64, u32) {
    let (mut weight, mut lookups, mut distance) = (1.0, 0, 0.0);
    loop {
        distance -= (-uniform(random)).ln_1p() / majorant;
        if distance >= crossing.span.end {
            return (weight, lookups);
        }
        lookups += 1;
        weight *= 1.0 - crossing.extinction.sigma_t(crossing.ray.at(distance)).x / majorant;
    }
}

fn free_flight<'a>(extent: Extent, truth: FreeFlight, extinction: GridExtinction) -> Check<'a> {
    let quantities = vec![
        Quantity::new("free flight on a ramp: mean", truth.mean),
        Quantity::new("free flight on a ramp: variance", truth.variance),
    ];
    Check::new(GROUP, quantities, extent.pick(2000, 20_000), move |batch| {
        let mut random = Stream::Experiment.random(batch.seed, 0);
        let ray = Ray::new(DVec3::ZERO, DVec3::X);
        let span = Span::new(0.0, 8.0);
        let mut flight = || match extinction.sample_flight(&ray, span, Rgb::ONE, &mut random) {
            Flight::Collision { distance, .. } => distance,
            Flight::Escape { .. } => span.end,
        };
        let flights: Vec<f64> = (0..batch.count).map(|_| flight()).collect();
        let (mean, variance) = mean_and_variance(&flights);
        Ok(vec![mean, variance])
    })
}

fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, squares / (count - 1.0))
}
