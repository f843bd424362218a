//! Photons that may be among the k nearest, and how the k nearest of them are told from the rest.
//!
//! No heap and no sorting: a threshold is moved until it parts the k least squared distances from the rest, by counting what is
//! not above it, interpolated between counts so that few are tried. Candidates stay in the order of the map; of
//! photons equally far the first ones count, so that k are found whatever ties there are.

use crate::map::lanes::{Block, LANES, Lanes};

/// Thresholds interpolated before the rest of the range is halved: no more than 32 follow.
const INTERPOLATIONS: usize = 12;

/// Photons found in a search.
#[derive(Debug, Default)]
pub(super) struct Candidates {
    /// Squared distances in map units; those beyond the count are left over.
    pub(super) squares: Vec<f32>,
    /// Indices into the map.
    pub(super) photons: Vec<u32>,
    pub(super) count: usize,
}

impl Candidates {
    /// Whether another block fits.
    #[inline(always)]
    pub(super) fn has_room(&self) -> bool {
        self.count + 2 * LANES <= self.squares.len()
    }

    /// Makes room for `count` and two blocks: the next one, and one to end with.
    pub(super) fn reserve(&mut self, count: usize) {
        let room = (count + 2 * LANES).next_multiple_of(LANES).max(self.squares.len());
        self.squares.resize(room, f32::INFINITY);
        self.photons.resize(room, 0);
    }

    /// Adds the lanes in `mask`, the first of which is photon `first`. Without room it does nothing.
    #[inline(always)]
    pub(super) fn add<L: Lanes>(&mut self, lanes: L, squares: L::Floats, mask: u32, first: u32) {
        let at = self.count;
        let to = (
            self.squares.get_mut(at..).and_then(<[f32]>::first_chunk_mut),
            self.photons.get_mut(at..).and_then(<[u32]>::first_chunk_mut),
        );
        if let (Some(squares_to), Some(photons_to)) = to {
            lanes.compress(squares, mask, squares_to);
            lanes.compress_numbers(first, mask, photons_to);
            self.count = at + mask.count_ones() as usize;
        }
    }

    /// The largest square.
    #[inline(always)]
    pub(super) fn largest<L: Lanes>(&mut self, lanes: L) -> f32 {
        lanes.part(self.blocks(), f32::MAX).largest
    }

    /// The squares, and infinity to fill the last block.
    #[inline(always)]
    fn blocks(&mut self) -> &[[f32; LANES]] {
        if let Some(after) = self.squares.get_mut(self.count..).and_then(<[f32]>::first_chunk_mut) {
            *after = [f32::INFINITY; LANES];
        }
        self.squares.as_chunks::<LANES>().0.get(..self.count.div_ceil(LANES)).unwrap_or_default()
    }

    /// The `k`-th least square, `k` from 1 up to the count; none of them is above `ceiling`.
    #[inline(always)]
    pub(super) fn kth<L: Lanes>(&mut self, lanes: L, k: usize, ceiling: f32) -> f32 {
        let count = self.count;
        let blocks = self.blocks();
        // The k-th is from `low` to `high`. Fewer than k are below `low`, and no fewer not above `high`.
        let (mut low, mut low_count) = (0.0_f32, 0);
        let (mut high, mut high_count) = (ceiling, count);
        // Of photons all about alike, counts grow as the cube of the distance: x^(2/3) about 1.
        let missing = 1.0 - (k as f32 - 0.5) / count as f32;
        let mut threshold = high * (1.0 - missing * (2.0 / 3.0 + missing * (1.0 / 9.0)));
        for round in 0.. {
            if threshold.is_nan() || threshold < low || threshold >= high {
                threshold = low;
            }
            let parted = lanes.part(blocks, threshold);
            if parted.count == k {
                return parted.largest;
            }
            if parted.count > k {
                (high, high_count) = (parted.largest, parted.count);
            } else if parted.count + 1 == k {
                return parted.smallest;
            } else {
                (low, low_count) = (parted.smallest, parted.count);
            }
            if low >= high {
                return high;
            }
            threshold = if round < INTERPOLATIONS {
                let share = (k as f32 - 0.5 - low_count as f32) / (high_count - low_count) as f32;
                low + (high - low) * share
            } else {
                f32::from_bits(low.to_bits().midpoint(high.to_bits()))
            };
        }
        high
    }

    /// Leaves the `k` nearest, with `kth` the square of the last of them; of those equally far the first. Returns where that last one is.
    #[inline(always)]
    pub(super) fn keep<L: Lanes>(&mut self, lanes: L, k: usize, kth: f32) -> usize {
        let end = self.count.next_multiple_of(LANES);
        let (squares, photons) = (&mut self.squares[..end], &mut self.photons[..end]);
        let bound = lanes.splat(kth);
        let (mut kept, mut farthest) = (0, 0);
        for at in (0..end).step_by(LANES) {
            let from = (squares[at..].first_chunk(), photons[at..].first_chunk());
            let (Some(&block), Some(&numbers)) = from else { break };
            let block = lanes.load(&Block(block));
            let near = lanes.not_above(block, bound);
            let on = near & lanes.not_above(bound, block);
            if on != 0 {
                let last = u32::BITS - 1 - on.leading_zeros();
                farthest = kept + (near & ((1 << last) - 1)).count_ones() as usize;
            }
            let to = (squares[kept..].first_chunk_mut(), photons[kept..].first_chunk_mut());
            if let (Some(squares), Some(photons)) = to {
                lanes.compress(block, near, squares);
                lanes.compress_block(numbers, near, photons);
            }
            kept += near.count_ones() as usize;
        }
        self.count = kept;
        if kept > k { self.drop_ties(k, kth) } else { farthest }
    }

    /// Drops the last of those as far as the k-th until `k` are left. Returns where the last that stays is.
    #[cold]
    #[inline(never)]
    fn drop_ties(&mut self, k: usize, kth: f32) -> usize {
        let nearer = self.squares[..self.count].iter().filter(|&&square| square < kth).count();
        let mut ties_left = k - nearer;
        let (mut kept, mut farthest) = (0, 0);
        for at in 0..self.count {
            let square = self.squares[at];
            if square == kth {
                if ties_left == 0 {
                    continue;
                }
                ties_left -= 1;
                farthest = kept;
            }
            self.squares[kept] = square;
            self.photons[kept] = self.photons[at];
            kept += 1;
        }
        self.count = kept;
        farthest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::lanes::{Instructions, Task};
    use proptest::prelude::*;

    struct KeepNearest<'c>(&'c mut Candidates, usize);

    impl Task for KeepNearest<'_> {
        type Output = (f32, usize);

        #[inline(always)]
        fn run<L: Lanes>(self, lanes: L) -> (f32, usize) {
            let Self(candidates, k) = self;
            let all = &candidates.squares[..candidates.count];
            let ceiling = all.iter().fold(0.0, |largest: f32, &square| largest.max(square));
            let kth = candidates.kth(lanes, k, ceiling);
            (kth, candidates.keep(lanes, k, kth))
        }
    }

    fn squares() -> impl Strategy<Value = Vec<f32>> {
        let tied = (0_u8..6).prop_map(f32::from);
        let wide = (-120_i32..60).prop_map(|power| 2.0_f32.powi(power));
        let square = prop_oneof![0.0_f32..2.0, tied, wide, Just(0.0)];
        prop::collection::vec(square, 1..200)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]

        #[test]
        fn the_nearest_are_those_of_a_stable_sort(squares in squares(), pick in 0.0_f64..1.0) {
            let k = 1 + (pick * squares.len() as f64) as usize % squares.len();
            let mut sorted: Vec<(f32, u32)> = squares.iter().copied().zip(0..).collect();
            sorted.sort_by(|a, b| a.partial_cmp(b).unwrap());
            let (kth, farthest) = sorted[k - 1];
            let mut exact = sorted[..k].to_vec();
            exact.sort_by_key(|&(_, photon)| photon);
            for instructions in Instructions::all() {
                let mut candidates = Candidates::default();
                candidates.reserve(squares.len());
                candidates.squares[..squares.len()].copy_from_slice(&squares);
                candidates.photons.iter_mut().zip(0..).for_each(|(photon, i)| *photon = i);
                candidates.count = squares.len();
                let (found, at) = instructions.run(KeepNearest(&mut candidates, k));
                prop_assert_eq!(found, kth);
                prop_assert_eq!(candidates.count, k);
                prop_assert_eq!(candidates.photons[at], farthest);
                let kept = candidates.squares.iter().zip(&candidates.photons).take(k);
                let kept: Vec<(f32, u32)> = kept.map(|(&square, &photon)| (square, photon)).collect();
                prop_assert_eq!(&kept, &exact);
            }
        }
    }
}
