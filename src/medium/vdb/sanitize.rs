//! Making a density grid safe to trace: an infinite density would stop a photon's flight for ever,
//! and a negative or NaN one has no meaning.

use rayon::prelude::*;

use super::sparse::SparseGrid;
use super::tree::LEAF_LEN;

/// How many values were set to 0, tiles and the background counted as one each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SanitizeCount {
    /// Not a number.
    pub nan: u64,
    /// Infinite, of either sign.
    pub infinite: u64,
    /// Finite and below 0.
    pub negative: u64,
}

impl SanitizeCount {
    /// All values that were set to 0.
    pub fn total(&self) -> u64 {
        self.nan + self.infinite + self.negative
    }

    fn sanitize(mut self, value: &mut f32) -> Self {
        if value.is_nan() {
            self.nan += 1;
        } else if value.is_infinite() {
            self.infinite += 1;
        } else if *value < 0.0 {
            self.negative += 1;
        } else {
            return self;
        }
        *value = 0.0;
        self
    }

    /// Both counts together.
    pub fn sum(self, other: Self) -> Self {
        Self {
            nan: self.nan + other.nan,
            infinite: self.infinite + other.infinite,
            negative: self.negative + other.negative,
        }
    }
}

/// Sets every value that cannot be a density to 0, of active and inactive voxels, tiles and the
/// background, and counts them.
pub fn sanitize_density(grid: &mut SparseGrid<f32>) -> SanitizeCount {
    let constants = grid.tiles.iter_mut().map(|tile| &mut tile.value);
    let count = constants
        .chain([&mut grid.background])
        .fold(SanitizeCount::default(), SanitizeCount::sanitize);
    grid.values
        .par_chunks_mut(64 * LEAF_LEN)
        .map(|values| {
            let mut count = SanitizeCount::default();
            for values in values.chunks_mut(LEAF_LEN) {
                // By the bits and without a branch a value: nearly always there is nothing to do.
                let is_sound = |value: &f32| value.to_bits() < f32::INFINITY.to_bits();
                if !values.iter().fold(true, |sound, value| sound & is_sound(value)) {
                    count = values.iter_mut().fold(count, SanitizeCount::sanitize);
                }
            }
            count
        })
        .reduce(SanitizeCount::default, SanitizeCount::sum)
        .sum(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DAffine3;
    use crate::medium::vdb::Tile;

    #[test]
    fn what_cannot_be_a_density_becomes_zero_and_is_counted() {
        let mut values = vec![1.0; 512];
        values[..5].copy_from_slice(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -2.0, -0.0]);
        let tile = |value| Tile { origin: [0; 3], dim: 8, value, active: false };
        let mut grid = SparseGrid {
            background: -1.0,
            index_to_world: DAffine3::IDENTITY,
            leaves: vec![[0; 3]],
            masks: vec![[0; 8]],
            values,
            tiles: vec![tile(f32::NAN), tile(3.0)],
        };
        let count = sanitize_density(&mut grid);
        assert_eq!((count.nan, count.infinite, count.negative), (2, 2, 2));
        assert_eq!(count.total(), 6);
        assert_eq!(grid.background, 0.0);
        assert_eq!(grid.values[..6], [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(grid.tiles, [tile(0.0), tile(3.0)]);
        assert_eq!(sanitize_density(&mut grid).total(), 0);
    }
}
