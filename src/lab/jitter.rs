//! Jittered grids: one photon, uniform at random, in each unit cell.
//!
//! No closed form of u_(k) is known, but a law: the count N in a ball of expected count u varies by
//! V(u) = c_d u^((d-1)/d), as only cells cut by the surface vary, and
//! E\[k/u_(k)\] = k / (k - 1/2 - g/2), g = ((d+1)/d) c_d k^(-1/d).

use std::f64::consts::PI;

use crate::estimate::CountLaw;

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

/// What the law predicts of a jittered grid, queries at random.
#[derive(Clone, Copy, Debug)]
pub(super) struct JitterLaw {
    dimension: f64,
    /// c_d: mean over the surface's directions of E|n (U - U')| / 2 for two points of a cell, times the surface of
    /// the ball of measure 1.
    surface: f64,
}

impl JitterLaw {
    pub(super) fn new(dimension: u32) -> Self {
        // 1/3 is exact; the others from the mean distance of two points of the unit square and cube, 0.5214054331647
        // and 0.6617071822672: 2 D_2 / sqrt(pi) and pi (3 / (4 pi))^(2/3) D_3.
        let surface = match dimension {
            1 => 1.0 / 3.0,
            2 => 0.588_343_028_393_482,
            _ => 0.799_999_990_297_198,
        };
        Self { dimension: f64::from(dimension), surface }
    }

    /// E\[k/u_(k)\] - 1.
    pub(super) fn bias(&self, k: f64) -> f64 {
        let d = self.dimension;
        let g = (d + 1.0) / d * self.surface * k.powf(-1.0 / d);
        k / (k - 0.5 - 0.5 * g) - 1.0
    }

    /// How the number of photons varies where k are expected.
    pub(super) fn counts(&self, k: f64) -> CountLaw {
        let exponent = (self.dimension - 1.0) / self.dimension;
        CountLaw { variance: self.surface * k.powf(exponent), exponent }
    }

    /// Var\[k/u_(k)\] = V(k) / k^2; on a line the law is exact with V - 1/12.
    pub(super) fn variance(&self, k: f64) -> f64 {
        let correction = if self.dimension == 1.0 { 1.0 / 12.0 } else { 0.0 };
        (self.counts(k).variance - correction) / (k * k)
    }
}
