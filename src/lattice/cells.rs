//! The cells of a lattice: filled, made coarser, sharpened, and read between.

use rayon::prelude::*;

use crate::lattice::{CellSum, LatticeShape};
use crate::math::DVec3;

/// The cells of a lattice.
#[derive(Debug)]
pub struct Cells<L> {
    pub(super) shape: LatticeShape,
    /// \[W/(m^2 sr)\] times the share of the cell that the medium fills, times the weight of lamps.
    light: Vec<L>,
    /// That share, where it is not 1 everywhere.
    shares: Vec<f32>,
}

/// Cells that one task adds up.
const SHARE: usize = 1 << 14;

impl<L: CellSum> Cells<L> {
    /// The sum of deposits of equal shape, whose power was scaled by [`LatticeShape::power_scale`].
    pub fn from_sums(shape: &LatticeShape, mut sums: Vec<Vec<L>>) -> Self {
        let factor = (1.0 / (shape.cell_volume() * shape.power_scale())) as f32;
        let mut light = sums.pop().unwrap_or_else(|| vec![L::default(); shape.cell_count()]);
        light.par_chunks_mut(SHARE).enumerate().for_each(|(share, cells)| {
            let first = share * SHARE;
            for other in &sums {
                let others = &other[first..first + cells.len()];
                cells.iter_mut().zip(others).for_each(|(cell, other)| *cell += *other);
            }
            cells.iter_mut().for_each(|cell| *cell = *cell * factor);
        });
        let [width, height, _] = shape.counts();
        let filled = |index: usize| {
            shape.filled_share([index % width, index / width % height, index / width / height])
        };
        let shares = match shape.is_full() {
            true => Vec::new(),
            false => (0..light.len()).into_par_iter().map(filled).collect(),
        };
        Self { shape: shape.clone(), light, shares }
    }

    /// Takes back what averaging over cells and interpolating between them flatten: together h^2 / 8 times the second
    /// derivatives of the light, for cells of edge h. Lattices that the medium does not fill stay as they are.
    pub fn sharpened(self) -> Self {
        if !self.shares.is_empty() {
            return self;
        }
        let counts = self.shape.counts();
        let strides = [1, counts[0], counts[0] * counts[1]];
        let sharp = |index: usize| {
            let cell = [index % counts[0], index / strides[1] % counts[1], index / strides[2]];
            let own = self.light[index];
            let mut bend = L::default();
            for axis in 0..3 {
                if cell[axis] > 0 && cell[axis] + 1 < counts[axis] {
                    let (low, high) = (index - strides[axis], index + strides[axis]);
                    bend += self.light[low] + self.light[high] - own * 2.0;
                }
            }
            own - bend * 0.125
        };
        let light = (0..self.light.len()).into_par_iter().map(sharp).collect();
        Self { shape: self.shape, light, shares: Vec::new() }
    }

    /// The same light in cells twice as long.
    pub fn coarser(&self) -> Self {
        let shape = self.shape.coarser();
        let [width, height, _] = shape.counts();
        let strides = [1, self.shape.counts()[0], self.shape.counts()[0] * self.shape.counts()[1]];
        let corner = |index: usize| {
            let cell = [index % width, index / width % height, index / width / height];
            (0..3).map(|axis| 2 * cell[axis] * strides[axis]).sum::<usize>()
        };
        let parts: [usize; 8] =
            std::array::from_fn(|part| (0..3).map(|axis| (part >> axis & 1) * strides[axis]).sum());
        let mean_light = |index: usize| {
            let first = corner(index);
            parts.iter().fold(L::default(), |sum, part| sum + self.light[first + part]) * 0.125
        };
        let mean_share = |index: usize| {
            let first = corner(index);
            parts.iter().map(|part| self.shares[first + part]).sum::<f32>() * 0.125
        };
        let light = (0..shape.cell_count()).map(mean_light).collect();
        let shares = match self.shares.is_empty() {
            true => Vec::new(),
            false => (0..shape.cell_count()).map(mean_share).collect(),
        };
        Self { shape, light, shares }
    }

    /// Light at a place.
    #[inline]
    pub fn at(&self, position: DVec3) -> L {
        let held = self.held_at(position);
        match self.shape.lamps() {
            None => held,
            Some(lamps) => held * (1.0 / lamps.weight(position)) as f32,
        }
    }

    /// What cells hold of it: trilinear between their middles, and linear beyond the outermost, if the medium fills them.
    #[inline]
    fn held_at(&self, position: DVec3) -> L {
        let counts = self.shape.counts();
        let place = self.shape.point(position).as_vec3() - 0.5;
        let (mut low, mut weight) = ([0usize; 3], [0.0f32; 3]);
        for axis in 0..3 {
            low[axis] = (place[axis] as usize).min(counts[axis] - 2);
            weight[axis] = place[axis] - low[axis] as f32;
        }
        let strides = [1, counts[0], counts[0] * counts[1]];
        let first = low[0] + low[1] * strides[1] + low[2] * strides[2];
        if self.shares.is_empty() {
            return blend(&self.light, first, strides, weight);
        }
        // Cells that the medium does not reach must not count.
        let weight = weight.map(|w| w.clamp(0.0, 1.0));
        let share = blend(&self.shares, first, strides, weight);
        let light = blend(&self.light, first, strides, weight);
        if share > 0.0 { light * (1.0 / share) } else { L::default() }
    }
}

/// Trilinear interpolation in the cube of cells whose lowest is `first`.
#[inline]
fn blend<L: CellSum>(cells: &[L], first: usize, strides: [usize; 3], weight: [f32; 3]) -> L {
    let Some(cube) = cells.get(first..=first + strides.iter().sum::<usize>()) else {
        return L::default();
    };
    let between = |low: L, high: L, weight: f32| low + (high - low) * weight;
    let along = |at: usize| between(cube[at], cube[at + 1], weight[0]);
    let sheet = |at: usize| between(along(at), along(at + strides[1]), weight[1]);
    between(sheet(0), sheet(strides[2]), weight[2])
}
