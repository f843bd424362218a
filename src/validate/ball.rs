//! A point light at the centre of a ball: collisions, escape, and fluence by radius, counted in shells and read from the map.

use std::f64::consts::PI;

use super::Extent;
use super::check::{Batch, Check, Quantity};
use super::error::ValidateError;
use super::kernel::{at_end, centered};
use super::stage::{ball, collided, fog, frame, one_watt, power, random_direction, scene, trace};
use super::truth::BallTruth;
use crate::math::{DVec3, Stream};
use crate::render::{LitScene, Unobserved};

const GROUP: &str = "ball";

/// Thickness of the shell by which fluence on the surface is read, over the radius.
const SURFACE_SHELL: f64 = 0.01;

/// Places asked for fluence at each radius, a batch.
const PLACES: usize = 40;

pub(super) fn checks(extent: Extent, truth: &[BallTruth]) -> Vec<Check<'_>> {
    let rows = truth.iter().filter(|row| extent.is_full() || row.albedo == 0.9);
    rows.flat_map(|row| [in_shells(extent, row), by_map(extent, row)]).collect()
}

fn name(row: &BallTruth, what: &str) -> String {
    format!("albedo {}, radius {}, {what}", row.albedo, row.radius)
}

/// Half-width of the shell at a radius; `None` on the surface.
fn width(radius: f64, ball_radius: f64) -> Option<f64> {
    let outside = ball_radius - radius;
    (outside > 0.0).then(|| (0.25 * radius).min(outside))
}

fn in_shells(extent: Extent, row: &BallTruth) -> Check<'_> {
    let count = extent.pick(4000, 20_000);
    let mut quantities = vec![
        Quantity::new(name(row, "collisions"), row.mean_collisions),
        Quantity::new(name(row, "share that escapes"), row.escape),
    ];
    for (r, phi) in row.r.iter().zip(&row.phi) {
        // On the surface the fluence falls with a logarithm.
        let bias = if *r < row.radius { 2e-3 } else { 1.5e-2 };
        quantities.push(Quantity::new(name(row, &format!("fluence at {r}")), *phi).within(bias));
    }
    Check::new(GROUP, quantities, count, move |batch| {
        let medium = fog(ball(row.radius), 1.0, row.albedo, 0.0);
        let scene = scene(medium, vec![one_watt(DVec3::ZERO)], batch)?;
        let traced = trace(&scene);
        let frame = frame(&scene);
        let mut figures = vec![collided(&traced), traced.balance.escaped.x];
        figures.extend(row.r.iter().map(|&r| {
            let weigh = |t: f64| match width(r, row.radius) {
                Some(width) => centered(t, r, width),
                None => at_end((r - t).max(0.0), SURFACE_SHELL * r),
            };
            let photons = traced.photons.iter();
            let sum: f64 = photons
                .map(|photon| weigh(frame.to_world(photon.position).length()) * power(photon))
                .sum();
            sum / (4.0 * PI * r * r)
        }));
        Ok(figures)
    })
}

/// Fluence as the estimator reads it. Over a ball of radius h the constant kernel adds h^2 / 10 of the Laplacian, which here
/// is below (1 + 2 / r + 2 / r^2) phi.
fn by_map(extent: Extent, row: &BallTruth) -> Check<'_> {
    let count = extent.pick(10_000, 40_000);
    let inner = |r: f64| r > 0.2 * row.radius && r < 0.8 * row.radius;
    let rows = row.r.iter().zip(&row.phi).filter(move |(r, _)| inner(**r));
    let places: Vec<f64> = rows.clone().map(|(r, _)| *r).collect();
    let quantities = rows
        .map(|(&r, &phi)| {
            // The radius that holds 12 photons.
            let h = (12.0 / (count as f64 * phi * 4.0 / 3.0 * PI)).cbrt();
            let bias = 0.1 * h * h * (1.0 + 2.0 / r + 2.0 / (r * r));
            Quantity::new(name(row, &format!("fluence at {r} by the map")), phi).within(1.3 * bias)
        })
        .collect();
    Check::new(GROUP, quantities, count, move |batch| fluences(row, &places, batch))
}

fn fluences(row: &BallTruth, radii: &[f64], batch: Batch) -> Result<Vec<f64>, ValidateError> {
    let medium = fog(ball(row.radius), 1.0, row.albedo, 0.0);
    let mut scene = scene(medium, vec![one_watt(DVec3::ZERO)], batch)?;
    scene.render.photons_only = true;
    let lit = LitScene::prepare(&scene, &Unobserved)?;
    let mut reader = lit.reader();
    let mut random = Stream::Experiment.random(batch.seed, 0);
    let mut mean = |radius: f64| {
        let places = (0..PLACES).map(|_| random_direction(&mut random) * radius);
        places.map(|place| reader.fluence(place).value.x).sum::<f64>() / PLACES as f64
    };
    Ok(radii.iter().map(|&radius| mean(radius)).collect())
}
