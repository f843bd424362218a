//! Moments of what fills a ball: how much, where its middle is, and how it is spread.
//!
//! Where a kernel reaches over the medium's edge, or into thinner parts, its photons come from one side. In a fluence with a
//! gradient their mean is then off by the gradient times the offset c of that middle from the query: an error of first
//! order in the radius. Weighing each photon at offset d by 1 - (d - c) . M^-1 c, with M the spread about the middle,
//! makes the estimate exact for every linear fluence (local linear regression; Fan and Gijbels 1996).

use crate::math::{Ball, DMat3, DVec3};
use crate::medium::Bounds;
use crate::medium::ball_points::{POINT_COUNT, turned_points};

/// Moments of a weight over a ball; lengths in units of its radius, from its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallMoments {
    /// Integral of the weight (for weight 1, the volume \[m^3\]).
    pub mass: f64,
    /// Mean place.
    pub middle: DVec3,
    /// M^-1 times the mean place.
    pub tilt: DVec3,
}

/// Added to the variances along each axis, in units of the squared radius: keeps M invertible where what fills the ball is flat,
/// and bounds the weights.
const LEAST_SPREAD: f64 = 0.005;

/// The weight to find before the points count as enough, the most sets of them, and how they are turned.
const ENOUGH: f64 = 0.5 * POINT_COUNT as f64;
const MOST_SETS: usize = 8;

/// Sets of points where a face cuts a ball. An error e of the middle makes estimates too high by e . M^-1 e on the average.
const SETS_AT_FACES: usize = 6;

const SET_STEP: f64 = 0.618_033_988_749_895;

impl BallMoments {
    /// Of what lies evenly about the centre.
    pub fn even(mass: f64) -> Self {
        Self { mass, middle: DVec3::ZERO, tilt: DVec3::ZERO }
    }

    /// By quadrature with at least `least_sets` sets of points: `share` is the weight at a point of the unit ball.
    pub fn by_points(
        ball: Ball,
        turn: f64,
        least_sets: usize,
        mut share: impl FnMut(DVec3) -> f64,
    ) -> Self {
        let (mut mass, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        let mut count = 0.0;
        for repeat in 0..MOST_SETS {
            let (points, rotation) = turned_points((turn + repeat as f64 * SET_STEP).fract());
            for &point in points {
                let place = rotation * point;
                let weight = share(place);
                mass += weight;
                first += place * weight;
                let outer = DMat3::from_cols(place * place.x, place * place.y, place * place.z);
                second += outer * weight;
            }
            count += POINT_COUNT as f64;
            // A ball that is nearly empty takes more points to know what little it holds.
            if mass >= ENOUGH && repeat + 1 >= least_sets {
                break;
            }
        }
        if mass <= 0.0 {
            return Self::even(0.0);
        }
        let middle = first / mass;
        let about = DMat3::from_cols(middle * middle.x, middle * middle.y, middle * middle.z);
        let spread =
            second * (1.0 / mass) - about + DMat3::from_diagonal(DVec3::splat(LEAST_SPREAD));
        let tilt = spread.inverse() * middle;
        let mass = mass / count * ball.volume();
        Self { mass, middle, tilt }
    }

    /// Of the part of a ball inside a uniform medium, weighted by 1 - `falloff` (d / r)^2: exact where nothing is cut off,
    /// else of exact mass.
    #[inline]
    pub fn inside(bounds: &Bounds, ball: Ball, turn: f64, falloff: f64) -> Self {
        let overlap = bounds.overlap(ball);
        let mass = overlap.mass - falloff * overlap.second_moment;
        if bounds.holds(ball) {
            return Self::even(mass);
        }
        let by_points = Self::by_points(ball, turn, SETS_AT_FACES, |place| {
            let inside = bounds.contains(ball.center + place * ball.radius);
            if inside { 1.0 - falloff * place.length_squared() } else { 0.0 }
        });
        Self { mass, ..by_points }
    }

    /// The factor on a photon at `offset` from the centre.
    #[inline]
    pub fn linear_weight(&self, offset: DVec3) -> f64 {
        1.0 - self.tilt.dot(offset - self.middle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Stream, uniform};

    /// Points spread evenly over the part of a ball inside a box, weighted, give a linear function's value at the centre:
    /// within a fifth of it in a corner, where the plain mean is off by two thirds.
    #[test]
    fn a_linear_function_is_read_at_the_centre() {
        let bounds = Bounds::Box { min: DVec3::ZERO, max: DVec3::ONE };
        for (center, slope) in [
            (DVec3::new(0.0, 0.5, 0.5), DVec3::X),
            (DVec3::new(0.02, 0.5, 1.0), DVec3::new(1.0, 0.5, -1.0)),
            (DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.3, -0.8, 1.0)),
        ] {
            let ball = Ball { center, radius: 0.2 };
            let mut random = Stream::Experiment.random(4, 0);
            let (mut plain, mut linear, mut mass) = (0.0, 0.0, 0.0);
            let turns = 200;
            for turn in 0..turns {
                let moments = BallMoments::inside(&bounds, ball, f64::from(turn) / 200.0, 0.0);
                let mut inside = 0;
                while inside < 500 {
                    let draw: [f64; 3] = std::array::from_fn(|_| 2.0 * uniform(&mut random) - 1.0);
                    let place = DVec3::from_array(draw);
                    if place.length() < 1.0 && bounds.contains(center + place * ball.radius) {
                        plain += slope.dot(place);
                        linear += moments.linear_weight(place) * (1.0 + slope.dot(place));
                        inside += 1;
                    }
                }
                mass += moments.mass;
            }
            let count = f64::from(turns * 500);
            assert!((mass / f64::from(turns) - bounds.overlap(ball).mass).abs() < 1e-15);
            assert!(plain.abs() / count > 0.2, "{}", plain / count);
            assert!((linear / count - 1.0).abs() < 0.2, "{center}: {}", linear / count);
        }
    }
}
