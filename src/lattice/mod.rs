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

/// In-scattered radiance per sigma_s towards one camera, in cells and in cells twice as long.
#[derive(Debug)]
pub enum LightLattice {
    /// The same in all channels.
    Grey([Cells<f32>; 2]),
    /// Of three channels.
    Colored([Cells<Vec3A>; 2]),
}

impl LightLattice {
    /// Where the cells lie.
    pub fn shape(&self) -> &LatticeShape {
        match self {
            Self::Grey([fine, _]) => &fine.shape,
            Self::Colored([fine, _]) => &fine.shape,
        }
    }

    /// Radiance scattered towards the camera at a place, per sigma_s \[W/(m^2 sr)\].
    #[inline]
    pub fn at(&self, position: DVec3) -> Rgb {
        match self {
            Self::Grey([fine, _]) => fine.at(position).rgb(),
            Self::Colored([fine, _]) => fine.at(position).rgb(),
        }
    }

    /// The same from the cells twice as long.
    pub fn coarse_at(&self, position: DVec3) -> Rgb {
        match self {
            Self::Grey([_, coarse]) => coarse.at(position).rgb(),
            Self::Colored([_, coarse]) => coarse.at(position).rgb(),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::Bounds;

    /// A light that varies linearly is read exactly up to the faces of a box, and within a ball from the cells that it fills.
    #[test]
    fn linear_light_is_read_exactly() {
        let slope = DVec3::new(0.3, -0.2, 0.5);
        let value = |place: DVec3| 2.0 + slope.dot(place);
        let boxed = Bounds::Box { min: DVec3::new(-1.0, 0.0, 0.5), max: DVec3::new(1.0, 1.0, 2.5) };
        let shape = LatticeShape::new(&boxed, 16).unwrap();
        assert_eq!(shape.counts(), [16, 8, 16]);
        let size = DVec3::new(2.0, 1.0, 2.0) / DVec3::new(16.0, 8.0, 16.0);
        assert!((shape.cell_volume() - size.element_product()).abs() < 1e-15);
        let middle = |index: usize| {
            let cell = [index % 16, index / 16 % 8, index / 128].map(|c| c as f64 + 0.5);
            DVec3::new(-1.0, 0.0, 0.5) + DVec3::from_array(cell) * size
        };
        let sums: Vec<f32> = (0..shape.cell_count())
            .map(|i| (value(middle(i)) * shape.cell_volume()) as f32)
            .collect();
        // Two deposits of half the light each.
        let halves = vec![sums.iter().map(|s| 0.5 * s).collect::<Vec<f32>>(); 2];
        let cells = Cells::from_sums(&shape, halves);
        let lattice = LightLattice::Grey([cells.coarser(), cells]);
        for place in [
            DVec3::new(-1.0, 0.0, 0.5),
            DVec3::new(1.0, 1.0, 2.5),
            DVec3::new(0.01, 0.52, 1.7),
            DVec3::new(-0.99, 0.5, 2.49),
        ] {
            for found in [lattice.at(place), lattice.coarse_at(place)] {
                assert!((found.x - value(place)).abs() < 1e-5, "{place}: {found}");
                assert_eq!(found.x, found.z);
            }
        }
    }

    #[test]
    fn cells_at_the_edge_of_a_ball_count_by_what_it_fills() {
        let ball = Bounds::Sphere { center: DVec3::new(5.0, 0.0, 0.0), radius: 2.0 };
        let shape = LatticeShape::new(&ball, 12).unwrap();
        assert!(!shape.is_full());
        let share = |index: usize| shape.filled_share([index % 12, index / 12 % 12, index / 144]);
        let volume: f64 =
            (0..shape.cell_count()).map(|i| f64::from(share(i)) * shape.cell_volume()).sum();
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
        assert!((volume / exact - 1.0).abs() < 2e-3, "{volume} {exact}");
        // An even fluence of 3 leaves power times length in proportion to what is filled.
        let sums: Vec<Vec3A> = (0..shape.cell_count())
            .map(|i| Vec3A::new(3.0, 1.0, 0.0) * share(i) * shape.cell_volume() as f32)
            .collect();
        let cells = Cells::from_sums(&shape, vec![sums]);
        let lattice = LightLattice::Colored([cells.coarser(), cells]);
        for direction in [DVec3::X, DVec3::NEG_Y, DVec3::ONE.normalize()] {
            for radius in [0.0, 1.0, 1.9, 1.999] {
                let place = DVec3::new(5.0, 0.0, 0.0) + direction * radius;
                for found in [lattice.at(place), lattice.coarse_at(place)] {
                    let error = (found - Rgb::new(3.0, 1.0, 0.0)).abs().max_element();
                    assert!(error < 1e-4, "{place}: {found}");
                }
            }
        }
    }
}
