//! The light lattice: scattered light in cells, from the lengths that photons fly in them.
//!
//! The fluence in a cell of volume V is the sum of power times length over the flights in it, over V (the track-length
//! estimator). It needs no collision: photons that only pass count as well, and cells of thin medium are as well known as those of
//! dense. With every flight weighted by the phase function towards the camera the cell holds in-scattered radiance per
//! sigma_s, one number a channel whatever the phase function. Between cells light is interpolated; the error of that is of
//! second order in the size of a cell, and vanishes as cells shrink.
//!
//! Every task fills a lattice of its own, and they are added in order: results do not depend on the number of threads.

mod deposit;
mod light;
mod shape;
mod walk;

pub use deposit::Deposit;
pub use light::CellLight;
pub use shape::LatticeShape;

use glam::Vec3A;
use rayon::prelude::*;

use crate::math::{DVec3, Rgb};

/// In-scattered radiance per sigma_s towards one camera.
#[derive(Debug)]
pub enum LightLattice {
    /// The same in all channels.
    Grey(Cells<f32>),
    /// Of three channels.
    Colored(Cells<Vec3A>),
}

impl LightLattice {
    /// Where the cells lie.
    pub fn shape(&self) -> &LatticeShape {
        match self {
            Self::Grey(cells) => &cells.shape,
            Self::Colored(cells) => &cells.shape,
        }
    }

    /// Radiance scattered towards the camera at a place, per sigma_s \[W/(m^2 sr)\].
    #[inline]
    pub fn at(&self, position: DVec3) -> Rgb {
        match self {
            Self::Grey(cells) => cells.at(position).rgb(),
            Self::Colored(cells) => cells.at(position).rgb(),
        }
    }
}

/// The cells of a lattice.
#[derive(Debug)]
pub struct Cells<L> {
    shape: LatticeShape,
    /// \[W/(m^2 sr)\] times the share of the cell that the medium fills.
    light: Vec<L>,
    /// That share, where it is not 1 everywhere.
    shares: Vec<f32>,
}

/// Cells that one task adds up.
const SHARE: usize = 1 << 14;

impl<L: CellLight> Cells<L> {
    /// The sum of deposits of equal shape.
    pub fn from_sums(shape: &LatticeShape, mut sums: Vec<Vec<L>>) -> Self {
        let factor = (1.0 / shape.cell_volume()) as f32;
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

    /// Light at a place: trilinear between the middles of cells, and linear beyond the outermost, if the medium fills them.
    #[inline]
    fn at(&self, position: DVec3) -> L {
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
fn blend<L: CellLight>(cells: &[L], first: usize, strides: [usize; 3], weight: [f32; 3]) -> L {
    let Some(cube) = cells.get(first..=first + strides.iter().sum::<usize>()) else {
        return L::default();
    };
    let between = |low: L, high: L, weight: f32| low + (high - low) * weight;
    let along = |at: usize| between(cube[at], cube[at + 1], weight[0]);
    let sheet = |at: usize| between(along(at), along(at + strides[1]), weight[1]);
    between(sheet(0), sheet(strides[2]), weight[2])
}
