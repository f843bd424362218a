//! Identities that hold in every medium: balance of power, moments of random flights, mean chords, reciprocity, crossings.

use std::f64::consts::PI;

use super::Extent;
use super::check::{Batch, Check, Quantity};
use super::error::ValidateError;
use super::field::{Cloud, everywhere};
use super::report::Row;
use super::stage::{
    CUBE, ball, collided, emission, fog, frame, needle, one_watt, power, scene, smoke, trace,
    white_sky,
};
use crate::light::Light;
use crate::math::{DVec3, Rgb, Stream};
use crate::medium::{Bounds, Emissivity, Flame, Medium, MediumExtinction, Phase};
use crate::trace::PowerBalance;

const GROUP: &str = "identities";

/// Balances, which have no noise.
pub(super) fn exact_rows() -> Result<Vec<Row>, ValidateError> {
    let cloud = Cloud::new();
    let inside = DVec3::new(0.2, 0.1, -0.3);
    let media = [
        ("box, g 0.5", fog(CUBE, 2.0, 0.9, 0.5), inside),
        ("ball, light outside", fog(ball(1.0), 2.0, 0.7, -0.4), DVec3::new(3.0, 1.0, 0.0)),
        ("cloud", smoke(cloud.extinction(6.0)?, 0.95, 0.3), inside),
    ];
    let mut rows = Vec::new();
    for (name, medium, light) in media {
        let scene = scene(medium, vec![one_watt(light)], Batch { seed: 1, count: 20_000 })?;
        let PowerBalance { emitted, absorbed, escaped, truncated, .. } = trace(&scene).balance;
        let whole = (absorbed + escaped + truncated).x / emitted.x;
        let name = format!("E1, {name}: (absorbed + escaped) / emitted");
        rows.push(Row::exact(GROUP, name, 1.0, whole, 1e-12));
    }
    // What crosses the surface of a medium that keeps nothing, on balance: all of a light inside, nothing of one outside.
    for (name, light, exact) in [("inside", inside, 1.0), ("outside", DVec3::X * 3.0, 0.0)] {
        let medium = fog(ball(1.0), 3.0, 1.0, 0.5);
        let scene = scene(medium, vec![one_watt(light)], Batch { seed: 2, count: 20_000 })?;
        let balance = trace(&scene).balance;
        let entered = if exact == 0.0 { 1.0 } else { 0.0 };
        let crossings = balance.escaped.x / balance.emitted.x - entered;
        let name = format!("E15, light {name}: net crossings of a ball a photon, albedo 1");
        rows.push(Row::exact(GROUP, name, exact, crossings, 1e-12));
    }
    Ok(rows)
}

pub(super) fn checks<'a>(extent: Extent) -> Vec<Check<'a>> {
    let mut checks = vec![absorption(extent), reciprocity(extent), cloud_collisions(extent)];
    checks.extend([(0.8, 0.7), (0.5, 0.0), (0.8, -0.5)].map(|(a, g)| collisions(extent, a, g)));
    checks.extend([0.6, -0.5].map(|g| flights(extent, g)));
    checks.extend([-0.9, -0.5, 1e-6, 0.3, 0.85, 0.99].map(|g| legendre(extent, g)));
    let oblong = Bounds::Box { min: DVec3::ZERO, max: DVec3::new(1.0, 2.0, 3.0) };
    let shapes = [
        ("box 2x2x2", CUBE, 4.0 / 3.0, 24.0),
        ("box 1x2x3", oblong, 12.0 / 11.0, 22.0),
        ("ball 0.7", ball(0.7), 4.0 * 0.7 / 3.0, 4.0 * PI * 0.49),
    ];
    checks.extend(
        shapes.map(|(name, bounds, chord, area)| chords(extent, name, bounds, chord, area)),
    );
    checks.extend([0.1, 1.0, 5.0].map(|depth| uncollided(extent, depth)));
    checks
}

/// E2 and E13: how many collisions, and where, of light along z. A path ends at its n-th with probability (1 - a) a^(n-1).
fn collisions<'a>(extent: Extent, albedo: f64, g: f64) -> Check<'a> {
    let name = |what: &str| format!("{what}, albedo {albedo}, g {g}");
    let lost = 1.0 - albedo;
    let quantities = vec![
        Quantity::new(name("E2: collisions"), 1.0 / lost),
        Quantity::new(name("E2: chi^2 of their distribution"), 1.0),
        Quantity::new(name("E13: sum of z"), 1.0 / (lost * (1.0 - albedo * g))),
        Quantity::new(name("E13: sum of r^2"), 2.0 / (lost * lost * (1.0 - albedo * g))),
    ];
    Check::new(GROUP, quantities, extent.pick(4000, 20_000), move |batch| {
        let medium = fog(Bounds::Infinite, 1.0, albedo, g);
        let scene = scene(medium, vec![needle(DVec3::ZERO, DVec3::Z, 1e-5)], batch)?;
        let frame = frame(&scene);
        let photons = trace(&scene).photons;
        let count = batch.count as f64;
        let (mut height, mut square, mut reached) = (0.0, 0.0, vec![0.0; 9]);
        for photon in &photons {
            let place = frame.to_world(photon.position);
            height += place.z;
            square += place.length_squared();
            if let Some(reached) = reached.get_mut(photon.order as usize) {
                *reached += 1.0;
            }
        }
        let chi = reached.windows(2).enumerate().map(|(n, pair)| {
            let share = lost * albedo.powi(n as i32);
            let expected = count * share;
            (pair[0] - pair[1] - expected).powi(2) / (expected * (1.0 - share))
        });
        let chi = chi.sum::<f64>() / 8.0;
        Ok(vec![photons.len() as f64 / count, chi, height / count, square / count])
    })
}

/// E3: absorbed power against (1 - albedo) times the power that collided, photon by photon.
fn absorption<'a>(extent: Extent) -> Check<'a> {
    let name = "E3: 1 + absorbed - (1 - albedo) collided";
    let quantities = vec![Quantity::new(name, 1.0)];
    Check::new(GROUP, quantities, extent.pick(4000, 20_000), move |batch| {
        let light = one_watt(DVec3::new(0.3, 0.5, 0.2));
        let scene = scene(fog(CUBE, 1.5, 0.8, 0.5), vec![light], batch)?;
        let traced = trace(&scene);
        Ok(vec![1.0 + traced.balance.absorbed.x - 0.2 * collided(&traced)])
    })
}

/// E4 and E5: under the same radiance from all sides the mean path is 4 V / S, whatever scatters, and collisions are even.
fn chords<'a>(
    extent: Extent,
    name: &'static str,
    bounds: Bounds,
    chord: f64,
    area: f64,
) -> Check<'a> {
    let (sigma_t, g) = (3.0, 0.7);
    let mut quantities = vec![
        Quantity::new(format!("E4, {name}: mean chord"), chord),
        Quantity::new(format!("E5, {name}: collisions"), chord * sigma_t),
    ];
    let octant =
        |n: usize| Quantity::new(format!("E5, {name}: in octant {n}"), chord * sigma_t / 8.0);
    quantities.extend((0..8).map(octant));
    let middle = bounds.enclosing_ball().map_or(DVec3::ZERO, |ball| ball.center);
    Check::new(GROUP, quantities, extent.pick(2000, 20_000), move |batch| {
        let scene = scene(fog(bounds, sigma_t, 1.0, g), vec![white_sky()], batch)?;
        let MediumExtinction::Uniform(extinction) = &scene.medium.extinction else {
            return Err(ValidateError::Scene);
        };
        let emission = emission(&scene, extinction);
        let photons = (0..emission.count()).filter_map(|index| emission.photon(index));
        let lengths = photons.map(|photon| {
            let span = bounds.intersect(&photon.ray);
            photon.power.x * span.map_or(0.0, |span| span.length())
        });
        let entering = PI * area;
        let mut figures = vec![lengths.sum::<f64>() / entering];
        let traced = trace(&scene);
        figures.push(collided(&traced) / entering);
        let mut octants = [0.0; 8];
        for photon in &traced.photons {
            let place = frame(&scene).to_world(photon.position) - middle;
            let side = |axis: usize| usize::from(place[axis] > 0.0) << axis;
            octants[side(0) | side(1) | side(2)] += power(photon) / entering;
        }
        figures.extend(octants);
        Ok(figures)
    })
}

/// E5 in a grid: 4 / S times the integral of sigma_t.
fn cloud_collisions<'a>(extent: Extent) -> Check<'a> {
    let cloud = Cloud::new();
    let area = 6.0 * Cloud::BOUNDS * Cloud::BOUNDS;
    let exact = 4.0 * 6.0 * cloud.mass() / area;
    let quantities = vec![Quantity::new("E5, cloud: collisions", exact)];
    Check::new(GROUP, quantities, extent.pick(2000, 20_000), move |batch| {
        let medium = smoke(cloud.extinction(6.0)?, 1.0, 0.6);
        let traced = trace(&scene(medium, vec![white_sky()], batch)?);
        Ok(vec![collided(&traced) / (PI * area)])
    })
}

/// E9: what a medium absorbs of light from all sides is what escapes of its own, times 4 V / S sigma_a.
fn reciprocity<'a>(extent: Extent) -> Check<'a> {
    let (sigma_t, albedo, g) = (2.0, 0.8, 0.4);
    let name = "E9: absorbed under a sky - 4V/S sigma_a times the share of even light that escapes";
    let quantities = vec![Quantity::new(name, 0.0)];
    Check::new(GROUP, quantities, extent.pick(3000, 20_000), move |batch| {
        let medium = || fog(ball(1.0), sigma_t, albedo, g);
        let lit = trace(&scene(medium(), vec![white_sky()], batch)?);
        let absorbed = (1.0 - albedo) * collided(&lit) / (4.0 * PI * PI);
        let other = Batch { seed: Stream::Scramble.hash(batch.seed, 1), ..batch };
        let escape = escape_of_even_light(medium(), other)?;
        Ok(vec![absorbed - 4.0 / 3.0 * sigma_t * (1.0 - albedo) * escape])
    })
}

/// Share that escapes of light that a ball of radius 1 emits evenly.
fn escape_of_even_light(medium: Medium, batch: Batch) -> Result<f64, ValidateError> {
    let flame = Flame { grid: everywhere(1.0)?, color: Rgb::ONE };
    let glowing = medium.with_emissivity(Emissivity::new(None, Some(flame), 1.0));
    let lights: Vec<Light> = Vec::new();
    let balance = trace(&scene(glowing, lights, batch)?).balance;
    Ok(balance.escaped.x / (4.0 * PI * 4.0 / 3.0 * PI))
}

/// E10 and E11: of light from all sides, and of light emitted evenly, the share that crosses a ball without a collision.
fn uncollided<'a>(extent: Extent, depth: f64) -> Check<'a> {
    let t: f64 = depth;
    let through = (1.0 - (1.0 + 2.0 * t) * (-2.0 * t).exp()) / (2.0 * t * t);
    let out = 3.0 / (8.0 * t.powi(3)) * (2.0 * t * t - 1.0 + (1.0 + 2.0 * t) * (-2.0 * t).exp());
    let quantities = vec![
        Quantity::new(format!("E10, radius {t}: passes without a collision"), through),
        Quantity::new(format!("E11, radius {t}: escapes without a collision"), out),
    ];
    Check::new(GROUP, quantities, extent.pick(3000, 20_000), move |batch| {
        let medium = || fog(ball(1.0), depth, 0.0, 0.0);
        let lit = trace(&scene(medium(), vec![white_sky()], batch)?);
        let passed = 1.0 - collided(&lit) / (4.0 * PI * PI);
        Ok(vec![passed, escape_of_even_light(medium(), batch)?])
    })
}

/// E12: where light along z is after n flights.
fn flights<'a>(extent: Extent, g: f64) -> Check<'a> {
    let flights: i32 = 6;
    let mut quantities = Vec::new();
    for n in 1..=flights {
        let lost = 1.0 - g.powi(n);
        let height = lost / (1.0 - g);
        let square = 2.0 * f64::from(n) / (1.0 - g) - 2.0 * g * lost / (1.0 - g).powi(2);
        quantities.push(Quantity::new(format!("E12, g {g}: mean z after {n} flights"), height));
        quantities.push(Quantity::new(format!("E12, g {g}: mean r^2 after {n} flights"), square));
    }
    Check::new(GROUP, quantities, extent.pick(4000, 20_000), move |batch| {
        let medium = fog(Bounds::Infinite, 1.0, 1.0, g);
        let mut scene = scene(medium, vec![needle(DVec3::ZERO, DVec3::Z, 1e-5)], batch)?;
        scene.photons.max_order = flights as u32 - 1;
        let frame = frame(&scene);
        let mut figures = vec![0.0; 2 * flights as usize];
        for photon in trace(&scene).photons {
            let place = frame.to_world(photon.position);
            let n = 2 * photon.order as usize;
            figures[n] += place.z / batch.count as f64;
            figures[n + 1] += place.length_squared() / batch.count as f64;
        }
        Ok(figures)
    })
}

/// E14: means of Legendre polynomials of the cosine of scattering are powers of g.
fn legendre<'a>(extent: Extent, g: f64) -> Check<'a> {
    let quantity = |l: i32| Quantity::new(format!("E14, g {g}: mean of P_{l}"), g.powi(l));
    let quantities = (1..=3).map(quantity).collect();
    Check::new(GROUP, quantities, extent.pick(4000, 50_000), move |batch| {
        let mut random = Stream::Experiment.random(batch.seed, 0);
        let phase = Phase::HenyeyGreenstein { g };
        let axis = DVec3::new(0.48, -0.6, 0.64);
        let mut sums = vec![0.0; 3];
        for _ in 0..batch.count {
            let c = phase.sample_direction(axis, &mut random).dot(axis);
            sums[0] += c;
            sums[1] += 0.5 * (3.0 * c * c - 1.0);
            sums[2] += 0.5 * (5.0 * c * c * c - 3.0 * c);
        }
        Ok(sums.into_iter().map(|sum| sum / batch.count as f64).collect())
    })
}
