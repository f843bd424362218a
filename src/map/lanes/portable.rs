//! Plain loops over sixteen lanes, for processors without instructions of their own here.

use crate::map::lanes::{Block, LANES, Lanes, Parted};

/// No instructions but the target's own.
#[derive(Clone, Copy, Debug)]
pub(in crate::map) struct Portable;

#[inline(always)]
fn by_lane(a: [f32; LANES], b: [f32; LANES], f: impl Fn(f32, f32) -> f32) -> [f32; LANES] {
    let mut made = a;
    for (made, b) in made.iter_mut().zip(b) {
        *made = f(*made, b);
    }
    made
}

#[inline(always)]
fn compress<T: Copy>(from: [T; LANES], mask: u32, to: &mut [T; LANES]) {
    let mut kept = 0;
    let mut lanes = mask;
    while lanes != 0 {
        to[kept % LANES] = from[lanes.trailing_zeros() as usize % LANES];
        kept += 1;
        lanes &= lanes - 1;
    }
}

impl Lanes for Portable {
    type Floats = [f32; LANES];

    #[inline(never)]
    fn call<R>(self, function: impl FnOnce() -> R) -> R {
        function()
    }

    #[inline(always)]
    fn load(self, block: &Block<f32>) -> [f32; LANES] {
        block.0
    }

    #[inline(always)]
    fn splat(self, value: f32) -> [f32; LANES] {
        [value; LANES]
    }

    #[inline(always)]
    fn add(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        by_lane(a, b, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        by_lane(a, b, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        by_lane(a, b, |a, b| a * b)
    }

    #[inline(always)]
    fn max(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        by_lane(a, b, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn not_above(self, a: [f32; LANES], b: [f32; LANES]) -> u32 {
        let mut mask = 0;
        for (lane, (a, b)) in a.iter().zip(b).enumerate() {
            mask |= u32::from(*a <= b) << lane;
        }
        mask
    }

    #[inline(always)]
    fn compress(self, floats: [f32; LANES], mask: u32, to: &mut [f32; LANES]) {
        compress(floats, mask, to);
    }

    #[inline(always)]
    fn compress_numbers(self, first: u32, mask: u32, to: &mut [u32; LANES]) {
        compress(std::array::from_fn(|lane| first + lane as u32), mask, to);
    }

    #[inline(always)]
    fn compress_block(self, block: [u32; LANES], mask: u32, to: &mut [u32; LANES]) {
        compress(block, mask, to);
    }

    #[inline(always)]
    fn part(self, numbers: &[[f32; LANES]], threshold: f32) -> Parted {
        let (mut counts, mut largest) = ([0_u32; LANES], [0.0_f32; LANES]);
        let mut smallest = [f32::INFINITY; LANES];
        for block in numbers {
            for lane in 0..LANES {
                let number = block[lane];
                let is_below = number <= threshold;
                counts[lane] += u32::from(is_below);
                largest[lane] = largest[lane].max(if is_below { number } else { 0.0 });
                smallest[lane] = smallest[lane].min(if is_below { f32::INFINITY } else { number });
            }
        }
        Parted {
            count: counts.iter().sum::<u32>() as usize,
            largest: largest.into_iter().fold(0.0, f32::max),
            smallest: smallest.into_iter().fold(f32::INFINITY, f32::min),
        }
    }
}
