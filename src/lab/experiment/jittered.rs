//! Photons in the cells of a cubic grid, one each, around a query at random in the middle cell.

use crate::lab::jitter::{certain_radius, reach, unit_ball};
use crate::math::{Random, uniform};

/// Cells that are filled for each trial.
pub(super) struct JitteredCells {
    dimension: usize,
    /// Lower corners of the cells, relative to that of the query's cell.
    cells: Vec<[f64; 3]>,
    /// Photons wanted, from 0 on.
    places: Vec<usize>,
    distances: Vec<f64>,
}

impl JitteredCells {
    /// The cells that can hold one of the nearest photons; `ks` ascends.
    pub(super) fn nearest(dimension: u32, ks: &[u64]) -> Self {
        let last = ks.last().copied().unwrap_or(1);
        let reach = reach(last, dimension) as i64;
        let limit = certain_radius(last, dimension).powi(2);
        let mut cells = Self::within(dimension, -reach, reach, ks);
        // The gap between the query's cell and another one.
        let gap = |corner: f64| (corner.abs() - 1.0).max(0.0);
        cells.cells.retain(|cell| cell.iter().map(|&c| gap(c).powi(2)).sum::<f64>() <= limit);
        cells
    }

    /// All cells of a grid of `edge` cells a side, the query in the middle one.
    pub(super) fn grid(dimension: u32, edge: u64, ks: &[u64]) -> Self {
        let first = -(edge as i64 / 2);
        Self::within(dimension, first, first + edge as i64 - 1, ks)
    }

    fn within(dimension: u32, first: i64, last: i64, ks: &[u64]) -> Self {
        let along = |axis: u32| if axis < dimension { first..=last } else { 0..=0 };
        let mut cells = Vec::new();
        for x in along(0) {
            for y in along(1) {
                cells.extend(along(2).map(|z| [x as f64, y as f64, z as f64]));
            }
        }
        let places = ks.iter().map(|&k| k as usize - 1).collect();
        Self { dimension: dimension as usize, cells, places, distances: Vec::new() }
    }

    /// Fills the cells: the expected count of the ball out to each photon wanted.
    pub(super) fn draw(&mut self, random: &mut Random, measures: &mut [f64]) {
        let query: [f64; 3] = std::array::from_fn(|_| uniform(random));
        self.distances.clear();
        self.distances.extend(self.cells.iter().map(|cell| {
            (0..self.dimension)
                .map(|axis| (cell[axis] + uniform(random) - query[axis]).powi(2))
                .sum::<f64>()
        }));
        let Some(&last) = self.places.last() else { return };
        self.distances.select_nth_unstable_by(last, f64::total_cmp);
        self.distances[..=last].sort_unstable_by(f64::total_cmp);
        let scale = unit_ball(self.dimension as u32);
        for (measure, &place) in measures.iter_mut().zip(&self.places) {
            *measure = scale * self.distances[place].powf(0.5 * self.dimension as f64);
        }
    }
}
