//! Owen-scrambled Sobol points in up to five dimensions.
//!
//! Direction numbers: Joe and Kuo, *Constructing Sobol sequences with better two-dimensional projections*,
//! 2008. Nested uniform scrambling by hashing (Laine and Karras 2011; Burley, *Practical Hash-based Owen
//! Scrambling*, JCGT 9(4), 2020, with Vegdahl's constants): any prefix of the sequence is stratified, and
//! each point is uniform over seeds.

use crate::math::Stream;

/// Dimensions provided.
pub const SOBOL_DIMENSIONS: usize = 5;

/// (degree, coefficients, initial numbers) of the primitive polynomials of dimensions 2 to 5.
const POLYNOMIALS: [(usize, u32, [u32; 3]); SOBOL_DIMENSIONS - 1] =
    [(1, 0, [1, 0, 0]), (2, 1, [1, 3, 0]), (3, 1, [1, 3, 1]), (3, 2, [1, 1, 1])];

/// The generator matrices, one column a bit of the index.
const DIRECTIONS: [[u32; 32]; SOBOL_DIMENSIONS] = direction_numbers();

/// A scrambled Sobol sequence.
#[derive(Clone, Debug)]
pub struct Sobol {
    scrambles: [u32; SOBOL_DIMENSIONS],
}

impl Sobol {
    /// The sequence of a seed; `index` tells sequences of one seed apart.
    pub fn new(seed: u64, index: u64) -> Self {
        let scramble = |d: usize| {
            let stream = index.wrapping_mul(SOBOL_DIMENSIONS as u64).wrapping_add(d as u64);
            (Stream::Scramble.hash(seed, stream) >> 32) as u32
        };
        Self { scrambles: std::array::from_fn(scramble) }
    }

    /// The first 32 bits of coordinate `dimension` (below five) of point `index`.
    pub fn coordinate(&self, index: u32, dimension: usize) -> u32 {
        let mut bits = 0;
        let mut rest = index;
        while rest != 0 {
            bits ^= DIRECTIONS[dimension][rest.trailing_zeros() as usize];
            rest &= rest - 1;
        }
        owen_scramble(bits, self.scrambles[dimension])
    }
}

/// A random permutation of each binary subtree of \[0, 1), by a hash in which a bit depends on higher bits only.
fn owen_scramble(value: u32, seed: u32) -> u32 {
    let mut x = value.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

const fn direction_numbers() -> [[u32; 32]; SOBOL_DIMENSIONS] {
    let mut directions = [[0u32; 32]; SOBOL_DIMENSIONS];
    let mut bit = 0;
    while bit < 32 {
        directions[0][bit] = 1 << (31 - bit);
        bit += 1;
    }
    let mut dimension = 1;
    while dimension < SOBOL_DIMENSIONS {
        let (degree, coefficients, initial) = POLYNOMIALS[dimension - 1];
        let mut bit = 0;
        while bit < 32 {
            directions[dimension][bit] = if bit < degree {
                initial[bit] << (31 - bit)
            } else {
                let earlier = directions[dimension][bit - degree];
                let mut value = earlier ^ (earlier >> degree);
                let mut term = 1;
                while term < degree {
                    if (coefficients >> (degree - 1 - term)) & 1 == 1 {
                        value ^= directions[dimension][bit - term];
                    }
                    term += 1;
                }
                value
            };
            bit += 1;
        }
        dimension += 1;
    }
    directions
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every power-of-two prefix has one point in each of its equal intervals, in every dimension.
    #[test]
    fn every_dimension_is_stratified() {
        let sobol = Sobol::new(7, 3);
        for dimension in 0..SOBOL_DIMENSIONS {
            for log in [4u32, 10] {
                let mut seen = vec![false; 1 << log];
                for index in 0..1 << log {
                    seen[(sobol.coordinate(index, dimension) >> (32 - log)) as usize] = true;
                }
                assert!(seen.iter().all(|&s| s), "dimension {dimension}, 2^{log}");
            }
        }
    }

    /// The first two dimensions are a (0, 2)-sequence: one point in every elementary interval of area 2^-m.
    #[test]
    fn the_first_pair_fills_elementary_intervals() {
        let sobol = Sobol::new(1, 0);
        let log = 8;
        for split in 0..=log {
            let mut seen = vec![false; 1 << log];
            for index in 0..1u32 << log {
                let x = u64::from(sobol.coordinate(index, 0)) >> (32 - split);
                let y = u64::from(sobol.coordinate(index, 1)) >> (32 - (log - split));
                seen[((x << (log - split)) | y) as usize] = true;
            }
            assert!(seen.iter().all(|&s| s), "split {split}");
        }
    }

    /// No pair of dimensions is correlated (a wrong table shows here).
    #[test]
    fn pairs_are_uncorrelated() {
        let sobol = Sobol::new(11, 0);
        let count = 1 << 14;
        let at = |index, d| f64::from(sobol.coordinate(index, d)) / 4_294_967_296.0 - 0.5;
        for first in 0..SOBOL_DIMENSIONS {
            for second in 0..first {
                let sum: f64 = (0..count).map(|i| at(i, first) * at(i, second)).sum();
                let correlation = 12.0 * sum / f64::from(count);
                assert!(correlation.abs() < 2e-3, "{first} {second}: {correlation}");
            }
        }
    }
}
