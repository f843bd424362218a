//! Where a medium's own light comes from: places drawn in proportion to what is emitted there.
//!
//! A lattice of cells over the medium's bounds, about one a voxel, each with the mean emissivity of 2^3 points (Gauss and
//! Legendre's, exact where it is a cubic). A place is drawn axis by axis, by inverting the marginal distribution, then the
//! conditional ones, and evenly within the cell: strata of the unit cube stay strata of space. One place in a hundred is
//! drawn evenly from the bounds, and a tenth from the neighbourhoods of what glows: what the points have missed is found too, at
//! a bounded weight. In volumes of more voxels than there may be cells, cells are coarser and photons less equal.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::{Bounds, Medium, Parallelepiped};
use crate::math::{Ball, DVec3, Rgb, mean_channel};

/// Most cells: 16 MB, and about a second to fill.
const MAX_CELLS: f64 = (1 << 21) as f64;

/// Share of the places drawn from all cells alike.
const EVEN_SHARE: f64 = 0.01;

/// Share of the places drawn from the 3^3 cells about each.
const NEAR_SHARE: f64 = 0.1;

/// Gauss and Legendre's two points on the unit interval.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_13, 0.788_675_134_594_812_9];

/// Cells with their probabilities.
#[derive(Debug)]
pub struct EmissiveCells {
    shape: Parallelepiped,
    counts: [usize; 3],
    /// Sums of the cells' probabilities up to and with each; cell (x, y, z) is number (x n_y + y) n_z + z.
    sums: Vec<f64>,
    power: Rgb,
}

/// A place drawn.
#[derive(Clone, Copy, Debug)]
pub struct EmissivePlace {
    /// World space.
    pub position: DVec3,
    /// The inverse of its density \[m^3\].
    pub volume: f64,
}

impl EmissiveCells {
    /// The cells of a medium that emits nothing outside of `bounds`, of edges near `voxel_size` \[m\]; `None` if it emits
    /// nothing or the bounds are infinite.
    pub(super) fn new(medium: &Medium, bounds: &Bounds, voxel_size: f64) -> Option<Self> {
        let shape = match bounds.parallelepiped() {
            Some(shape) => shape,
            None => box_about(bounds.enclosing_ball()?),
        };
        let counts = cell_counts(shape.edges().map(|edge| edge.length() / voxel_size));
        let cell_count = counts.iter().product::<usize>();
        let means: Vec<Rgb> = (0..cell_count)
            .into_par_iter()
            .map(|number| mean_emissivity(medium, &shape, counts, number))
            .collect();
        let total: Rgb = means.iter().sum();
        let brightness = mean_channel(total);
        if !(brightness > 0.0 && brightness.is_finite()) {
            return None;
        }
        let own: Vec<f64> = means.iter().map(|mean| mean_channel(*mean) / brightness).collect();
        let near = mean_of_neighbours(&own, counts);
        let even = EVEN_SHARE / cell_count as f64;
        let mut sum = 0.0;
        let add = |(own, near): (&f64, &f64)| {
            sum += (1.0 - NEAR_SHARE - EVEN_SHARE) * own + NEAR_SHARE * near + even;
            sum
        };
        let sums = own.iter().zip(&near).map(add).collect();
        let power = total * (4.0 * PI * volume(&shape) / cell_count as f64);
        Some(Self { shape, counts, sums, power })
    }

    /// The power emitted in all directions, by the cells' points \[W\].
    pub fn power(&self) -> Rgb {
        self.power
    }

    /// Edges of the lattice \[m\].
    pub fn edges(&self) -> [f64; 3] {
        self.shape.edges().map(DVec3::length)
    }

    /// The place at a point of the unit cube.
    pub fn sample_place(&self, u: [f64; 3]) -> EmissivePlace {
        let mut place = self.shape.corner();
        // The range of cells that is left: first one, and how many.
        let (mut first, mut count) = (0, self.sums.len());
        for (axis, share) in u.into_iter().enumerate() {
            let slabs = self.counts[axis];
            let stride = count / slabs;
            let (before, total) = (self.sum_before(first), self.sum_before(first + count));
            let target = before + share * (total - before);
            let end = |slab: usize| self.sum_before(first + (slab + 1) * stride);
            let slab = partition_point(slabs - 1, |slab| end(slab) <= target);
            let low = self.sum_before(first + slab * stride);
            let within = ((target - low) / (end(slab) - low)).clamp(0.0, 1.0);
            place += self.shape.edges()[axis] * ((slab as f64 + within) / slabs as f64);
            (first, count) = (first + slab * stride, stride);
        }
        let probability = self.sum_before(first + 1) - self.sum_before(first);
        let all = self.sum_before(self.sums.len());
        let cell_volume = volume(&self.shape) / self.sums.len() as f64;
        EmissivePlace { position: place, volume: cell_volume * all / probability }
    }

    fn sum_before(&self, cell: usize) -> f64 {
        cell.checked_sub(1).map_or(0.0, |last| self.sums[last])
    }
}

fn box_about(ball: Ball) -> Parallelepiped {
    let edge = 2.0 * ball.radius;
    let corner = ball.center - DVec3::splat(ball.radius);
    Parallelepiped::new(corner, [DVec3::X * edge, DVec3::Y * edge, DVec3::Z * edge])
}

fn volume(shape: &Parallelepiped) -> f64 {
    let [a, b, c] = shape.edges();
    a.cross(b).dot(c).abs()
}

/// The mean over each cell and its neighbours along all axes; there are none beyond the lattice.
fn mean_of_neighbours(cells: &[f64], [n_x, n_y, n_z]: [usize; 3]) -> Vec<f64> {
    let mut means = cells.to_vec();
    for (stride, count) in [(1, n_z), (n_z, n_y), (n_y * n_z, n_x)] {
        let mean = |cell: usize| {
            let place = cell / stride % count;
            let before = if place > 0 { means[cell - stride] } else { 0.0 };
            let after = if place + 1 < count { means[cell + stride] } else { 0.0 };
            (before + means[cell] + after) / 3.0
        };
        means = (0..cells.len()).into_par_iter().map(mean).collect();
    }
    means
}

/// The first of 0..`count` for which `is_below` does not hold, else `count`.
fn partition_point(count: usize, is_below: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, count);
    while low < high {
        let middle = low.midpoint(high);
        if is_below(middle) { low = middle + 1 } else { high = middle }
    }
    low
}

/// Cells along each axis, in proportion to the voxels along it, and no more than there may be.
fn cell_counts(mut voxels: [f64; 3]) -> [usize; 3] {
    let bounded = |count: f64| count.clamp(1.0, MAX_CELLS);
    voxels = voxels.map(bounded);
    while voxels.iter().map(|count| count.ceil()).product::<f64>() > MAX_CELLS {
        voxels = voxels.map(|count| bounded(0.95 * count));
    }
    voxels.map(|count| count.ceil() as usize)
}

fn mean_emissivity(
    medium: &Medium,
    shape: &Parallelepiped,
    [n_x, n_y, n_z]: [usize; 3],
    number: usize,
) -> Rgb {
    let cell = [number / (n_y * n_z), number / n_z % n_y, number % n_z];
    let mut sum = Rgb::ZERO;
    for corner in 0..8 {
        let point = [corner >> 2, corner >> 1 & 1, corner & 1];
        let along = |axis: usize, count: usize| {
            shape.edges()[axis] * ((cell[axis] as f64 + GAUSS[point[axis]]) / count as f64)
        };
        let place = shape.corner() + along(0, n_x) + along(1, n_y) + along(2, n_z);
        sum += medium.emissivity_at(place);
    }
    sum * 0.125
}
