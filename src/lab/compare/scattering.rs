//! Fluence about a point light in an infinite medium that scatters isotropically.
//!
//! With sigma_t = 1 and albedo c, by K. M. Case, F. de Hoffmann and G. Placzek, *Introduction to the Theory of Neutron
//! Diffusion* (1953), a watt gives at distance t
//! phi(t) = (A exp(-kappa t) + int_1^inf exp(-s t) / N(1/s) ds) / (4 pi t),
//! with c atanh(kappa) = kappa, A = 2 kappa^2 (1 - kappa^2) / (c (c - 1 + kappa^2)) and
//! N(m) = (1 - c m atanh m)^2 + (pi c m / 2)^2.
//! The integral is done once, by the exp-sinh rule: what is left is a sum of exponentials.

use std::f64::consts::{FRAC_PI_2, PI};

/// Step of the exp-sinh rule, and its first and last node: right to 12 digits between 0.5 and 2 m.
const STEP: f64 = 0.1;
const NODES: std::ops::RangeInclusive<i32> = -34..=18;

/// phi as a sum of exponentials over 4 pi t.
pub(super) struct ScatteredFluence {
    /// Rate s and weight of each.
    terms: Vec<(f64, f64)>,
}

impl ScatteredFluence {
    /// For an albedo between 0 and 1, both excluded.
    pub(super) fn new(albedo: f64) -> Self {
        let kappa = slowest_rate(albedo);
        let square = kappa * kappa;
        let weight = 2.0 * square * (1.0 - square) / (albedo * (albedo - 1.0 + square));
        let mut terms = vec![(kappa, weight)];
        terms.extend(NODES.map(|node| {
            let u = STEP * f64::from(node);
            let beyond = (FRAC_PI_2 * u.sinh()).exp();
            let rate = 1.0 + beyond;
            // atanh(1 / s), without cancellation where s is close to 1.
            let atanh = 0.5 * ((2.0 + beyond) / beyond).ln();
            let norm = (1.0 - albedo / rate * atanh).powi(2) + (FRAC_PI_2 * albedo / rate).powi(2);
            (rate, STEP * FRAC_PI_2 * u.cosh() * beyond / norm)
        }));
        Self { terms }
    }

    /// Fluence \[W/m^2\] at `distance` \[m\].
    pub(super) fn at(&self, distance: f64) -> f64 {
        let sum: f64 =
            self.terms.iter().map(|(rate, weight)| weight * (-rate * distance).exp()).sum();
        sum / (4.0 * PI * distance)
    }
}

/// kappa with c atanh(kappa) = kappa, by bisection: atanh(x) / x grows.
fn slowest_rate(albedo: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..100 {
        let middle: f64 = 0.5 * (low + high);
        if albedo * middle.atanh() < middle {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
