//! Henyey-Greenstein scattering at its ends, near 0 and below.

use super::super::check::{Check, Quantity};
use super::super::error::ValidateError;
use super::super::report::Row;
use super::super::slab::{Incidence, Slab};
use super::{SEED, noisy};
use crate::math::{DVec3, Stream, uniform};
use crate::medium::Phase;

const ENDS: &str = "g = +1, -1";
const SMALL: &str = "|g| < 1e-4";
const BACKWARD: &str = "negative g";

pub(super) fn rows() -> Result<Vec<Row>, ValidateError> {
    let mut rows = at_the_ends()?;
    rows.extend(near_zero());
    rows.extend(backward()?);
    Ok(rows)
}

/// Straight on is as good as no scattering. Straight back is a walk on a line: 1 / (1 + tau) passes.
fn at_the_ends() -> Result<Vec<Row>, ValidateError> {
    let slab = |albedo, g| Slab { sigma_t: 1.0, albedo, g, tau: 2.0 };
    let cases = [
        ("g = 1, albedo 0.9", slab(0.9, 1.0), 0.0, (-0.2_f64).exp()),
        ("g = 1 - 1e-12, albedo 0.9", slab(0.9, 1.0 - 1e-12), 0.0, (-0.2_f64).exp()),
        ("g = -1, albedo 1", slab(1.0, -1.0), 2.0 / 3.0, 1.0 / 3.0),
        ("g = -1 + 1e-12, albedo 1", slab(1.0, -1.0 + 1e-12), 2.0 / 3.0, 1.0 / 3.0),
    ];
    let checks = cases.map(|(name, slab, reflected, passed)| {
        let quantities = vec![
            Quantity::new(format!("{name}: slab reflects"), reflected),
            Quantity::new(format!("{name}: slab lets pass"), passed),
        ];
        Check::new(ENDS, quantities, 2000, move |batch| slab.shares(Incidence::Normal, batch))
    });
    let mut rows = noisy(&checks)?;
    for g in [-1.0, 1.0] {
        let phase = Phase::HenyeyGreenstein { g };
        let is_number = [-1.0, 0.0, 1.0].iter().all(|&c| phase.density(c).is_finite());
        rows.push(Row::holds(ENDS, format!("g = {g}: densities are numbers"), is_number));
    }
    Ok(rows)
}

/// cos = t + 1.5 g (1 - t^2) + O(g^2) at t = 2 u - 1, for the u that the sampler draws.
fn near_zero() -> Vec<Row> {
    let axis = DVec3::new(0.48, -0.6, 0.64);
    let largest = |g: f64| {
        let phase = Phase::HenyeyGreenstein { g };
        (0..2000).fold(0.0_f64, |largest, index| {
            let mut random = Stream::Experiment.random(SEED, index);
            let t = 2.0 * uniform(&mut random.clone()) - 1.0;
            let cosine = phase.sample_direction(axis, &mut random).dot(axis);
            largest.max((cosine - t - 1.5 * g * (1.0 - t * t)).abs())
        })
    };
    let row = |g: f64| {
        let name = format!("g = {g:e}: largest error of the cosine");
        Row::exact(SMALL, name, 0.0, largest(g), 3.0 * g * g + 1e-15)
    };
    [1e-4, -1e-4, 1e-6, 1e-8, 1e-300].map(row).to_vec()
}

fn backward() -> Result<Vec<Row>, ValidateError> {
    let axis = DVec3::new(0.48, -0.6, 0.64);
    let checks = [-1e-3, -0.3, -0.7, -0.99].map(|g| {
        let quantity = Quantity::new(format!("g = {g}: mean cosine"), g);
        Check::new(BACKWARD, vec![quantity], 4000, move |batch| {
            let mut random = Stream::Experiment.random(batch.seed, 0);
            let phase = Phase::HenyeyGreenstein { g };
            let cosines = (0..batch.count)
                .map(|_| phase.sample_direction(axis, &mut random).dot(axis))
                .sum::<f64>();
            Ok(vec![cosines / batch.count as f64])
        })
    });
    let mut rows = noisy(&checks)?;
    let phase = Phase::HenyeyGreenstein { g: -0.5 };
    let is_backward = phase.density(-1.0) > phase.density(1.0);
    rows.push(Row::holds(BACKWARD, "the density is larger backwards", is_backward));
    Ok(rows)
}
