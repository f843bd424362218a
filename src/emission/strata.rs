//! Strata of equal measure for any number of photons.
//!
//! The unit cube is cut along one dimension into slabs, each slab along the next into rows, and so on; the last
//! dimension is cut into as many cells as photons are left. Each cut is placed so that every slab's share
//! of the measure equals its share of the photons: all cells have measure 1 / count exactly, whatever the
//! count. The numbers of cuts follow the extents that the dimensions have in the medium, so that the cells
//! come out as cubic there as they can be: cubes have the least surface, and it is the surface of the strata
//! that makes the variance of a count.

use std::ops::{Add, Div, Mul, Sub};

/// The most dimensions that strata may have: place, direction and first flight.
pub const MAX_DIMENSIONS: usize = 5;

/// Strata of the unit cube.
#[derive(Clone, Debug)]
pub struct Strata {
    count: u64,
    /// (dimension, slabs), coarsest first; the last entry takes what is left.
    cuts: Vec<(usize, u32)>,
}

/// The interval of a stratum in one dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Strata {
    /// `count` strata, with `extents` \[m\] the size in the medium of each dimension's unit interval (at most
    /// [`MAX_DIMENSIONS`]).
    pub fn new(count: u64, extents: &[f64]) -> Self {
        let shares = division_counts(count as f64, extents);
        let mut order: Vec<usize> = (0..extents.len()).collect();
        order.sort_by(|&a, &b| shares[a].total_cmp(&shares[b]));
        let cuts = order.into_iter().map(|d| (d, (shares[d].round() as u32).max(1))).collect();
        Self { count, cuts }
    }

    /// The cell of photon `index` (below the count).
    pub fn cell(&self, index: u64) -> [Interval; MAX_DIMENSIONS] {
        // 64 bits hold the products of counts below 2^32, and divide many times faster than 128.
        match u32::try_from(self.count) {
            Ok(count) => self.cell_of::<u64>(index, u64::from(count)),
            Err(_) => self.cell_of::<u128>(u128::from(index), u128::from(self.count)),
        }
    }

    fn cell_of<N: Whole>(&self, mut index: N, mut left: N) -> [Interval; MAX_DIMENSIONS] {
        let mut cell = [Interval { low: 0.0, high: 1.0 }; MAX_DIMENSIONS];
        let one = N::from(1u32);
        let last = self.cuts.len().saturating_sub(1);
        for (level, &(dimension, slabs)) in self.cuts.iter().enumerate() {
            let slabs = if level == last { left } else { N::from(slabs).min(left) };
            // The slab whose photons include `index`: slab s begins at photon floor(s left / slabs).
            let slab = ((index + one) * slabs - one) / left;
            let (first, end) = (slab * left / slabs, (slab + one) * left / slabs);
            let per_photon = 1.0 / left.as_f64();
            let share = |photon: N| photon.as_f64() * per_photon;
            cell[dimension] = Interval { low: share(first), high: share(end).min(1.0) };
            index = index - first;
            left = end - first;
        }
        cell
    }
}

/// Whole numbers wide enough for the product of two counts.
trait Whole:
    Copy
    + Ord
    + From<u32>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    fn as_f64(self) -> f64;
}

impl Whole for u64 {
    fn as_f64(self) -> f64 {
        self as f64
    }
}

impl Whole for u128 {
    fn as_f64(self) -> f64 {
        self as f64
    }
}

impl Interval {
    /// The point at `u` in \[0, 1), kept below 1.
    pub fn at(self, u: f64) -> f64 {
        (self.low + (self.high - self.low) * u).min(1.0 - f64::EPSILON / 2.0)
    }
}

/// Real numbers of divisions with product `count`, in proportion to the extents, but none below 1.
fn division_counts(count: f64, extents: &[f64]) -> Vec<f64> {
    let mut fixed = vec![false; extents.len()];
    loop {
        let free = fixed.iter().filter(|f| !**f).count();
        if free == 0 {
            return vec![1.0; extents.len()];
        }
        let open = || extents.iter().zip(&fixed).filter(|(_, f)| !**f).map(|(e, _)| e.ln());
        let unit = ((count.ln() - open().sum::<f64>()) / free as f64).exp();
        let too_coarse = (0..extents.len())
            .filter(|&d| !fixed[d] && extents[d] * unit < 1.0)
            .min_by(|&a, &b| extents[a].total_cmp(&extents[b]));
        match too_coarse {
            Some(dimension) => fixed[dimension] = true,
            None => {
                let divisions = |d: usize| if fixed[d] { 1.0 } else { extents[d] * unit };
                return (0..extents.len()).map(divisions).collect();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn volume(cell: &[Interval; MAX_DIMENSIONS]) -> f64 {
        cell.iter().map(|i| i.high - i.low).product()
    }

    #[test]
    fn a_cube_number_makes_cubes() {
        let strata = Strata::new(1000, &[2.0, 2.0, 2.0]);
        let cell = strata.cell(123);
        for interval in &cell[..3] {
            assert!((interval.high - interval.low - 0.1).abs() < 1e-15, "{cell:?}");
        }
    }

    #[test]
    fn cells_are_cubic_in_the_medium() {
        let strata = Strata::new(1_000_000, &[1.0, 4.0, 0.5]);
        let cell = strata.cell(77_777);
        let sizes = [1.0, 4.0, 0.5].iter().zip(&cell).map(|(e, i)| e * (i.high - i.low));
        let sizes: Vec<f64> = sizes.collect();
        assert!(sizes.iter().all(|s| (s / sizes[0] - 1.0).abs() < 0.05), "{sizes:?}");
    }

    proptest! {
        /// Equal measure, inside the cube, and disjoint: no two cells share their centre's cell.
        #[test]
        fn any_count_gives_disjoint_cells_of_equal_measure(
            count in 1u64..3000, extents in prop::collection::vec(0.01f64..100.0, 1..=5),
        ) {
            let strata = Strata::new(count, &extents);
            let cells: Vec<_> = (0..count).map(|i| strata.cell(i)).collect();
            for cell in &cells {
                prop_assert!((volume(cell) * count as f64 - 1.0).abs() < 1e-9);
            }
            let step = (count / 40 + 1) as usize;
            for (i, cell) in cells.iter().enumerate().step_by(step) {
                let inside = |other: &[Interval; MAX_DIMENSIONS]| {
                    cell.iter().zip(other).all(|(a, b)| {
                        let middle = 0.5 * (a.low + a.high);
                        b.low <= middle && middle < b.high
                    })
                };
                let owners: Vec<usize> = (0..cells.len()).filter(|&j| inside(&cells[j])).collect();
                prop_assert_eq!(owners, vec![i]);
            }
        }
    }
}
