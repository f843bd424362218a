//! Integrals over balls by a fixed set of points.
//!
//! A ball is cut into shells of equal volume; the points of a shell sit at golden-angle steps (spherical
//! Fibonacci points). All carry the same weight.

use std::f64::consts::{PI, TAU};

use crate::math::{DMat3, DVec3};

/// Points a ball.
pub(super) const POINT_COUNT: usize = 48;
/// Different sets of points: a turn about one axis alone would leave errors along that axis.
const TURN_COUNT: usize = 16;

/// Sets of points in the unit ball.
#[derive(Debug)]
pub(super) struct BallPoints {
    turns: Vec<[DVec3; POINT_COUNT]>,
}

impl BallPoints {
    pub(super) fn new() -> Self {
        Self { turns: (0..TURN_COUNT).map(points_of_turn).collect() }
    }

    /// The points for `phase` in \[0, 1): the set it falls in, and the rotation to apply to it.
    pub(super) fn turned(&self, phase: f64) -> (&[DVec3; POINT_COUNT], DMat3) {
        let turns = phase.clamp(0.0, 1.0) * TURN_COUNT as f64;
        let turn = (turns as usize).min(TURN_COUNT - 1);
        (&self.turns[turn], DMat3::from_rotation_z((turns - turn as f64) * TAU))
    }
}

/// The set of one turn: a rank-1 lattice of the unit cube (R3 sequence, the powers of the plastic number's
/// relative in three dimensions), shifted by the turn and mapped to the ball with equal volumes.
fn points_of_turn(turn: usize) -> [DVec3; POINT_COUNT] {
    let golden = 0.618_033_988_749_895;
    let shift = |step: f64| (turn as f64 * step).fract();
    let (shift_radius, shift_height) = (shift(0.754_877_666_246_693), shift(0.569_840_290_998_053));
    std::array::from_fn(|n| {
        let n = n as f64;
        let count = POINT_COUNT as f64;
        let height = ((n + 0.5 + shift_height) / count).fract();
        // Radii take the strata in an order that scatters them over the heights.
        let radius = (n * 0.381_966_011_250_105 * 1.7 + shift_radius).fract().cbrt();
        let z = 1.0 - 2.0 * height;
        let (sin, cos) = (n * golden * 2.0 * PI).sin_cos();
        let ring = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(ring * cos, ring * sin, z) * radius
    })
}
