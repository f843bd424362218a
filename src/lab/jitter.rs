//! Jittered grids: one photon, uniform at random, in each unit cell.
//!
//! No closed form of u_(k) is known, but a law: the count N in a ball of expected count u varies by
//! V(u) = c_d u^((d-1)/d), as only cells cut by the surface vary, and
//! E\[k/u_(k)\] = k / (k - 1/2 - g/2), g = ((d+1)/d) c_d k^(-1/d).

use std::f64::consts::PI;

/// A radius in cells that holds k photons for certain, wherever its centre: it holds all cells that touch the ball
/// of measure k.
pub(super) fn certain_radius(k: u64, dimension: u32) -> f64 {
    let radius = (k as f64 / unit_ball(dimension)).powf(1.0 / f64::from(dimension));
    radius + f64::from(dimension).sqrt()
}

/// How many cells beyond that of the query, along each axis, the k nearest photons can lie.
pub(super) fn reach(k: u64, dimension: u32) -> u64 {
    certain_radius(k, dimension).ceil() as u64
}

/// Measure of the ball of radius 1 in 1, 2 or 3 dimensions.
pub(super) fn unit_ball(dimension: u32) -> f64 {
    match dimension {
        1 => 2.0,
        2 => PI,
        _ => 4.0 / 3.0 * PI,
    }
}
