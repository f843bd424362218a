//! The Morton (Z-order) curve: photons sorted along it are near in memory where they are near in space, and queries
//! answered along it find what the last one found.

use rayon::prelude::*;

use crate::trace::Photon;

/// Bits of the code per axis.
const BITS: u32 = 21;

/// Indices of the photons with finite place and power, in Morton order within their own bounding box; equal
/// codes stay in the order of emission, so that the result is the same for any number of threads.
pub fn sorted_indices(photons: &[Photon]) -> Vec<u32> {
    let finite = |p: &Photon| p.position.iter().chain(&p.power).all(|value| value.is_finite());
    let empty = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    let (low, high) =
        photons.par_iter().filter(|p| finite(p)).map(|p| (p.position, p.position)).reduce(
            || empty,
            |a, b| {
                let pick = |f: fn(f32, f32) -> f32, x: [f32; 3], y: [f32; 3]| {
                    std::array::from_fn(|axis| f(x[axis], y[axis]))
                };
                (pick(f32::min, a.0, b.0), pick(f32::max, a.1, b.1))
            },
        );
    let scale = ((1u32 << BITS) - 1) as f32;
    let cell = |position: [f32; 3], axis: usize| {
        let extent = high[axis] - low[axis];
        let share = if extent > 0.0 { (position[axis] - low[axis]) / extent } else { 0.0 };
        u64::from((share * scale) as u32)
    };
    let mut keyed: Vec<(u64, u32)> = photons
        .par_iter()
        .enumerate()
        .filter(|(_, p)| finite(p))
        .map(|(index, p)| {
            let cells = std::array::from_fn(|axis| cell(p.position, axis));
            (morton_code(cells), index as u32)
        })
        .collect();
    keyed.par_sort_unstable();
    keyed.into_par_iter().map(|(_, index)| index).collect()
}

/// The place on the curve of a cell with 21 bits an axis.
pub fn morton_code([x, y, z]: [u64; 3]) -> u64 {
    spread(x) << 2 | spread(y) << 1 | spread(z)
}

/// Puts two zero bits between the 21 low bits.
fn spread(value: u64) -> u64 {
    let mut x = value & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread_by_three() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
    }
}
