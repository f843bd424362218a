//! A point light in a medium without end: collisions within a radius and fluence at it, by Case, de Hoffmann and Placzek
//! (1953), and with Henyey-Greenstein scattering.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::Extent;
use super::check::{Batch, Check, Quantity};
use super::error::ValidateError;
use super::kernel::centered;
use super::stage::{fog, frame, one_watt, power, scene, trace};
use super::truth::{FluenceByRadius, Infinite};
use crate::math::DVec3;
use crate::medium::{Bounds, Medium};
use crate::scene::Scene;

const GROUP: &str = "infinite medium";

/// Where the light stands: nowhere near the origin.
const LIGHT: DVec3 = DVec3::new(3.0, -2.0, 7.0);

/// What the kernel over shells may read wrong, as a share.
const SHELL_BIAS: f64 = 5e-4;

/// Radius of the ball that stands in for an endless medium without absorption, where photons would fly for ever.
const CONSERVATIVE_BALL: f64 = 60.0;

/// Extrapolated end of such a medium, beyond its surface (Milne's problem).
const EXTRAPOLATION: f64 = 0.710_446;

pub(super) fn checks(extent: Extent, truth: &Infinite) -> Vec<Check<'_>> {
    let mut checks = Vec::new();
    for (albedo, enclosed) in &truth.enclosed {
        let (Ok(a), Some(phi)) = (albedo.parse::<f64>(), truth.phi.get(albedo)) else { continue };
        if extent.is_full() || a == 0.9 {
            checks.push(by_radius(extent, a, enclosed, phi));
        }
    }
    checks.push(by_order(extent, &truth.orders_albedo1));
    let hg = truth.hg.iter().filter(|row| extent.is_full() || (row.albedo, row.g) == (0.9, 0.85));
    checks.extend(hg.map(|row| anisotropic(extent, row)));
    checks
}

/// Collisions within radii, and fluence at them.
fn by_radius<'a>(
    extent: Extent,
    albedo: f64,
    enclosed: &BTreeMap<String, f64>,
    phi: &BTreeMap<String, f64>,
) -> Check<'a> {
    let is_conservative = albedo == 1.0;
    // So many that all albedos cost about the same.
    let count = if is_conservative {
        200
    } else {
        ((extent.pick(2e4, 5e4) * (1.0 - albedo)) as u64).max(400)
    };
    // An endless medium holds more than its ball by the fluence that comes back from beyond, which is even.
    let (bounds, beyond) = match is_conservative {
        true => {
            let far = CONSERVATIVE_BALL + EXTRAPOLATION;
            (Bounds::Sphere { center: LIGHT, radius: CONSERVATIVE_BALL }, 3.0 / (4.0 * PI * far))
        }
        false => (Bounds::Infinite, 0.0),
    };
    let radii = numbers(enclosed);
    let mut quantities: Vec<Quantity> = radii
        .iter()
        .map(|&(r, exact)| {
            let exact = exact - beyond * 4.0 / 3.0 * PI * r.powi(3);
            Quantity::new(format!("albedo {albedo}, collisions within {r}"), exact)
                .within(if is_conservative { 1e-4 } else { 0.0 })
        })
        .collect();
    quantities.extend(numbers(phi).iter().map(|&(r, exact)| {
        fluence_at(format!("albedo {albedo}, fluence at {r}"), r, exact - beyond, count)
    }));
    let radii: Vec<f64> = radii.into_iter().map(|(r, _)| r).collect();
    let medium = move || fog(bounds, 1.0, albedo, 0.0);
    Check::new(GROUP, quantities, count, move |batch| {
        let collisions = collisions(medium(), batch, u32::MAX)?;
        let within = radii.iter().map(|radius| {
            collisions.iter().filter(|(r, ..)| r < radius).map(|(_, power, _)| power).sum()
        });
        let at = radii.iter().map(|&r| fluence(r, collisions.iter().map(|(t, p, _)| (*t, *p))));
        Ok(within.chain(at).collect())
    })
}

/// Fluence of light scattered so many times.
fn by_order<'a>(extent: Extent, truth: &BTreeMap<String, BTreeMap<String, f64>>) -> Check<'a> {
    let count = extent.pick(5000, 50_000);
    let mut quantities = Vec::new();
    let mut places: Vec<(f64, u32)> = Vec::new();
    for (r, orders) in numbers(truth) {
        for (order, exact) in numbers(orders) {
            let order = order as u32;
            let name = format!("albedo 1, fluence at {r} of order {order}");
            quantities.push(fluence_at(name, r, *exact, count));
            places.push((r, order));
        }
    }
    let highest = places.iter().map(|place| place.1).max().unwrap_or(0);
    Check::new(GROUP, quantities, count, move |batch| {
        let collisions = collisions(fog(Bounds::Infinite, 1.0, 1.0, 0.0), batch, highest)?;
        let of = |&(r, order): &(f64, u32)| {
            let own = collisions.iter().filter(|collision| collision.2 == order);
            fluence(r, own.map(|(t, p, _)| (*t, *p)))
        };
        Ok(places.iter().map(of).collect())
    })
}

fn anisotropic(extent: Extent, row: &FluenceByRadius) -> Check<'_> {
    let FluenceByRadius { albedo, g, r, phi } = row;
    let count = extent.pick(3000, 20_000);
    let name = |r: &f64| format!("albedo {albedo}, g {g}, fluence at {r}");
    let at = r.iter().zip(phi).map(|(r, phi)| fluence_at(name(r), *r, *phi, count));
    Check::new(GROUP, at.collect(), count, move |batch| {
        let collisions = collisions(fog(Bounds::Infinite, 1.0, *albedo, *g), batch, u32::MAX)?;
        let at = r.iter().map(|&r| fluence(r, collisions.iter().map(|(t, p, _)| (*t, *p))));
        Ok(at.collect())
    })
}

/// (distance from the light, power, order) of every collision.
fn collisions(
    medium: Medium,
    batch: Batch,
    max_order: u32,
) -> Result<Vec<(f64, f64, u32)>, ValidateError> {
    let mut scene: Scene = scene(medium, vec![one_watt(LIGHT)], batch)?;
    scene.photons.max_order = max_order.min(scene.photons.max_order);
    let frame = frame(&scene);
    let traced = trace(&scene);
    let of = traced.photons.iter().map(|photon| {
        (frame.to_world(photon.position).distance(LIGHT), power(photon), photon.order)
    });
    Ok(of.collect())
}

fn fluence_at(name: String, r: f64, exact: f64, count: u64) -> Quantity {
    let seen = Check::total(count) * exact * 4.0 * PI * r * r * 2.0 * width(r);
    Quantity::new(name, exact).within(SHELL_BIAS).seen_by(seen)
}

/// Half-width of the shell at a radius: phi r^2 is smooth but at 0.
fn width(radius: f64) -> f64 {
    (0.25 * radius).min(0.4)
}

fn fluence(radius: f64, collisions: impl Iterator<Item = (f64, f64)>) -> f64 {
    let density: f64 =
        collisions.map(|(r, power)| power * centered(r, radius, width(radius))).sum();
    density / (4.0 * PI * radius * radius)
}

/// A table whose keys are numbers, in their order.
fn numbers<T>(table: &BTreeMap<String, T>) -> Vec<(f64, &T)> {
    let mut numbers: Vec<(f64, &T)> =
        table.iter().filter_map(|(key, value)| Some((key.parse().ok()?, value))).collect();
    numbers.sort_by(|a, b| a.0.total_cmp(&b.0));
    numbers
}
