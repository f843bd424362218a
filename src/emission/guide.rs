//! Where a light's photons are worth sending: a density over the first two primary dimensions, by how much of the
//! light collides there.
//!
//! Through sparse smoke most aimed photons would pass without a collision. The guide tabulates the opacity
//! 1 - T of rays over a grid of the primary square; sending photons by it, each with its power over the density,
//! makes the powers at first collisions nearly equal and spends none on empty space.

use crate::math::{DVec2, Random, uniform};

/// Cells a side.
const SIDE: usize = 64;

/// Share of photons spread evenly, so that what the probes missed is still found.
const EVEN_SHARE: f64 = 0.05;

/// A piecewise constant density over the unit square.
#[derive(Debug)]
pub struct Guide {
    /// Probability of the rows up to and including each.
    rows: Vec<f64>,
    /// The same of the cells within each row.
    cells: Vec<f64>,
}

impl Guide {
    /// Tabulates `opacity`, asked at points of the square. Returns the guide and the mean of opacity over density under it,
    /// which is the mean opacity; `None` if the opacity is 0 everywhere.
    pub fn new(random: &mut Random, opacity: impl Fn(DVec2) -> f64) -> Option<(Self, f64)> {
        let mut means = vec![0.0; SIDE * SIDE];
        for (cell, mean) in means.iter_mut().enumerate() {
            let place = |cell: usize, u: f64| (cell as f64 + u) / SIDE as f64;
            let x = place(cell % SIDE, uniform(random));
            let y = place(cell / SIDE, uniform(random));
            *mean = opacity(DVec2::new(x, y));
        }
        let mean = means.iter().sum::<f64>() / means.len() as f64;
        if mean <= 0.0 {
            return None;
        }
        // The largest of the neighbours: a cell that the medium's edge crosses is not underrated.
        let weight = |cell: usize| {
            let (x, y) = (cell % SIDE, cell / SIDE);
            let near = |c: usize| c.saturating_sub(1)..=(c + 1).min(SIDE - 1);
            let around = near(y).flat_map(|y| near(x).map(move |x| y * SIDE + x));
            around.map(|c| means[c]).fold(0.0, f64::max)
        };
        let weights: Vec<f64> = (0..SIDE * SIDE).map(weight).collect();
        let even = weights.iter().sum::<f64>() / weights.len() as f64 * EVEN_SHARE;
        let rows: Vec<f64> =
            weights.chunks(SIDE).map(|row| row.iter().map(|w| w + even).sum()).collect();
        let cells = weights.chunks(SIDE).flat_map(|row| cumulative(row.iter().map(|w| w + even)));
        Some((Self { cells: cells.collect(), rows: cumulative(rows.into_iter()) }, mean))
    }

    /// Bends a point of the unit square to the density; returns the point and the density there.
    pub fn warp(&self, u: DVec2) -> (DVec2, f64) {
        let (y, row_density) = invert(&self.rows, u.y);
        let row = ((y * SIDE as f64) as usize).min(SIDE - 1);
        let (x, cell_density) = invert(&self.cells[row * SIDE..(row + 1) * SIDE], u.x);
        (DVec2::new(x, y), row_density * cell_density)
    }
}

/// Running sums over their total.
fn cumulative(weights: impl Iterator<Item = f64> + Clone) -> Vec<f64> {
    let total: f64 = weights.clone().sum();
    let mut sum = 0.0;
    weights
        .map(|weight| {
            sum += weight / total;
            sum
        })
        .collect()
}

/// The quantile `u` of a piecewise constant density on \[0, 1), and the density there.
fn invert(cumulative: &[f64], u: f64) -> (f64, f64) {
    let last = cumulative.len() - 1;
    let cell = cumulative.partition_point(|&sum| sum <= u).min(last);
    let below = if cell == 0 { 0.0 } else { cumulative[cell - 1] };
    let probability = cumulative[cell] - below;
    let within = ((u - below) / probability).clamp(0.0, 1.0 - f64::EPSILON);
    let count = cumulative.len() as f64;
    ((cell as f64 + within) / count, probability * count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Stream;

    /// Weighted by 1 / density, warped points integrate any function; and the guided opacity is nearly constant.
    #[test]
    fn warped_points_integrate_and_equalise() {
        let opacity =
            |p: DVec2| (1.0 - 20.0 * (p - DVec2::new(0.3, 0.6)).length_squared()).max(0.0);
        let mut random = Stream::Experiment.random(3, 0);
        let (guide, mean) = Guide::new(&mut random, opacity).expect("some opacity");
        let exact = std::f64::consts::PI * 0.05 * 0.5;
        // One probe a cell.
        assert!((mean / exact - 1.0).abs() < 2e-2, "{mean} {exact}");
        let side = 2000;
        let (mut area, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for i in 0..side * side {
            let u = DVec2::new((i / side) as f64 + 0.5, (i % side) as f64 + 0.5) / side as f64;
            let (p, density) = guide.warp(u);
            area += 1.0 / density;
            sum += opacity(p) / density;
            squares += (opacity(p) / density).powi(2);
        }
        let count = (side * side) as f64;
        assert!((area / count - 1.0).abs() < 1e-2, "{}", area / count);
        assert!((sum / count / exact - 1.0).abs() < 1e-2);
        let variation = squares / count / (sum / count).powi(2) - 1.0;
        assert!(variation < 0.3, "{variation}");
        assert!(Guide::new(&mut random, |_| 0.0).is_none());
    }
}
