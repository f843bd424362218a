//! The ball about a place lit by a point: the power that a density which depends on the distance from the light alone
//! puts there.
//!
//! With p(t) the density at distance t, a ball of radius R about a place at distance r > R holds
//! P = int_{r-R}^{r+R} p(t) 4 pi t^2 (R^2 - (t - r)^2) / (4 t r) dt,
//! the last factor being the share of the sphere of radius t that lies in the ball.

use std::f64::consts::PI;

/// Nodes above 0 and weights of Gauss and Legendre's rule of 12 points on \[-1, 1\].
const GAUSS_LEGENDRE: [(f64, f64); 6] = [
    (0.125_233_408_511_468_9, 0.249_147_045_813_402_8),
    (0.367_831_498_998_180_2, 0.233_492_536_538_354_8),
    (0.587_317_954_286_617_5, 0.203_167_426_723_065_9),
    (0.769_902_674_194_304_7, 0.160_078_328_543_346_2),
    (0.904_117_256_370_474_9, 0.106_939_325_995_318_4),
    (0.981_560_634_246_719_3, 0.047_175_336_386_511_8),
];

/// P, of a ball of `radius` below `distance` from the light.
pub(super) fn ball_power(density: impl Fn(f64) -> f64, distance: f64, radius: f64) -> f64 {
    let slice = |x: f64| {
        let from_light = distance + radius * x;
        density(from_light) * from_light * (1.0 - x * x)
    };
    let nodes = GAUSS_LEGENDRE.iter();
    let sum: f64 = nodes.map(|&(x, weight)| weight * (slice(x) + slice(-x))).sum();
    PI * radius.powi(3) / distance * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// int_{r-R}^{r+R} exp(-t) (R^2 - (t-r)^2) / (4 t r) dt by the midpoint rule.
    #[test]
    fn balls_hold_what_slices_add_up_to() {
        let density = |t: f64| (-t).exp() / (4.0 * PI * t * t);
        for (distance, radius) in [(1.0, 0.01), (1.0, 0.3), (0.95, 0.6)] {
            let steps = 200_000;
            let width = 2.0 * radius / f64::from(steps);
            let slices = (0..steps).map(|i| {
                let t = distance - radius + (f64::from(i) + 0.5) * width;
                (-t).exp() * (radius * radius - (t - distance).powi(2)) / (4.0 * t * distance)
            });
            let sum: f64 = slices.sum::<f64>() * width;
            let power = ball_power(density, distance, radius);
            assert!((power / sum - 1.0).abs() < 1e-8, "{distance} {radius}: {power} {sum}");
        }
    }
}
