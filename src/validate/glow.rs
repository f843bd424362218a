//! Radiance along rays past a point light in fog, all scattering orders: single scattering without bias, the rest read from
//! the photon map, whose kernel blurs.

use super::Extent;
use super::check::{Check, Quantity};
use super::stage::{ball, fog, one_watt, passing_ray, random_direction, scene};
use super::truth::{GlowSeen, GlowingBall, Truth};
use crate::math::{DVec3, Frame, Ray, Stream};
use crate::medium::Bounds;
use crate::render::{LitScene, Unobserved};

const GROUP: &str = "glow";

/// Rays of one impact parameter a batch.
const RAYS: usize = 60;

/// The bias of 100 000 photons: the square of the kernel's radius, n^(-2/3). Near the surface kernels reach inwards only.
fn bias(impact: f64, count: u64) -> f64 {
    let at_100_000 = match impact {
        _ if impact < 0.8 => 0.01,
        _ if impact < 0.95 => 0.015,
        _ => 0.03,
    };
    at_100_000 * (1e5 / count as f64).powf(2.0 / 3.0)
}

pub(super) fn checks(extent: Extent, truth: &Truth) -> Vec<Check<'_>> {
    let quick_ball = |row: &&GlowingBall| (row.albedo, row.radius) == (0.9, 2.0);
    let balls = truth.glow.iter().filter(|row| extent.is_full() || quick_ball(row));
    let quick_seen = |row: &&GlowSeen| (row.albedo, row.camera_distance) == (0.5, 1.0);
    let seen = truth.glow_infinite.iter().filter(|row| extent.is_full() || quick_seen(row));
    balls.map(|row| glowing(extent, row)).chain(seen.map(|row| around(extent, row))).collect()
}

fn glowing(extent: Extent, row: &GlowingBall) -> Check<'_> {
    let GlowingBall { albedo, radius, impacts, radiance } = row;
    let count = extent.pick(15_000, 60_000);
    let name = |impact: &f64| format!("ball, albedo {albedo}, radius {radius}, b/R {impact}");
    let quantities = impacts
        .iter()
        .zip(radiance)
        .map(|(impact, exact)| Quantity::new(name(impact), *exact).within(bias(*impact, count)));
    Check::new(GROUP, quantities.collect(), count, move |batch| {
        let medium = fog(ball(*radius), 1.0, *albedo, 0.0);
        let mut scene = scene(medium, vec![one_watt(DVec3::ZERO)], batch)?;
        scene.render.light_samples = 32;
        let lit = LitScene::prepare(&scene, &Unobserved)?;
        let mut reader = lit.reader();
        let mut random = Stream::Experiment.random(batch.seed, 0);
        let mut mean = |impact: f64| {
            let sum: f64 = (0..RAYS)
                .map(|_| {
                    let ray = passing_ray(impact * radius, 5.0 * radius, &mut random);
                    let seen = reader.radiance(&ray, f64::INFINITY, &mut random);
                    seen.single_scatter.x + seen.multiple_scatter.x
                })
                .sum();
            sum / RAYS as f64
        };
        Ok(impacts.iter().map(|&impact| mean(impact)).collect())
    })
}

/// Light scattered once along a ray that starts inside a medium without end, and all of it where photons come in numbers.
fn around(extent: Extent, row: &GlowSeen) -> Check<'_> {
    let &GlowSeen { albedo, camera_distance, impact, total, single } = row;
    // The kernel's radius, and so its bias, is that of the collisions, of which there are 1 / (1 - albedo) a photon.
    let collisions = extent.pick(10_000, 50_000);
    let count = ((1.0 - albedo) * collisions as f64) as u64 + 1;
    let name = format!("infinite, albedo {albedo}, from {camera_distance}, impact {impact}");
    let quantities = vec![
        Quantity::new(format!("{name}: single"), single),
        // Along the way from far away photons are few, and the kernel wide.
        Quantity::new(format!("{name}: all"), total)
            .within(1.5 * bias(0.0, collisions))
            .seen_by(if camera_distance > 5.0 { 0.0 } else { f64::INFINITY }),
    ];
    let along = (camera_distance * camera_distance - impact * impact).max(0.0).sqrt();
    Check::new(GROUP, quantities, count, move |batch| {
        let medium = fog(Bounds::Infinite, 1.0, albedo, 0.0);
        let mut scene = scene(medium, vec![one_watt(DVec3::ZERO)], batch)?;
        (scene.render.light_samples, scene.render.march_samples) = (64, 64);
        let lit = LitScene::prepare(&scene, &Unobserved)?;
        let mut reader = lit.reader();
        let mut random = Stream::Experiment.random(batch.seed, 0);
        let (mut once, mut all) = (0.0, 0.0);
        for _ in 0..RAYS {
            let turned = Frame::about(random_direction(&mut random));
            let origin = turned.to_world(DVec3::new(impact, 0.0, -along));
            let seen = reader.radiance(&Ray::new(origin, turned.axis), f64::INFINITY, &mut random);
            once += seen.single_scatter.x / RAYS as f64;
            all += (seen.single_scatter.x + seen.multiple_scatter.x) / RAYS as f64;
        }
        Ok(vec![once, all])
    })
}
