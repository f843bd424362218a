//! Sixteen numbers at a time, with the vector instructions that the processor turns out to have.
//!
//! One binary runs anywhere: the search for photons is written once for [`Lanes`] and compiled for AVX-512, for AVX2 and for
//! what the target always has; which one runs is chosen where a search begins ([`Instructions`]). All of them
//! multiply and add separately and in the same order, so that the photons found are the same bit by bit.

mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

pub(super) use portable::Portable;

/// Numbers of a block.
pub(super) const LANES: usize = 16;

/// A number in each lane, aligned as vectors are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Block<T>(pub(super) [T; LANES]);

/// What the numbers of a block say about a threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Parted {
    /// Numbers not above it.
    pub(super) count: usize,
    /// The largest of them, or 0.
    pub(super) largest: f32,
    /// The smallest of the others, or infinity.
    pub(super) smallest: f32,
}

/// Vector instructions. Masks have a bit for each lane, the first lane's lowest.
pub(super) trait Lanes: Copy {
    /// An `f32` in each lane.
    type Floats: Copy;

    /// Calls what the compiler is not to inline, with these instructions.
    fn call<R>(self, function: impl FnOnce() -> R) -> R;

    fn load(self, block: &Block<f32>) -> Self::Floats;

    fn splat(self, value: f32) -> Self::Floats;

    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;

    fn sub(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;

    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;

    fn max(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;

    /// Where a <= b.
    fn not_above(self, a: Self::Floats, b: Self::Floats) -> u32;

    /// Writes the floats of the lanes in `mask` one after another; what comes after them in `to` is overwritten.
    fn compress(self, floats: Self::Floats, mask: u32, to: &mut [f32; LANES]);

    /// Writes `first` plus the number of each lane in `mask`, likewise.
    fn compress_numbers(self, first: u32, mask: u32, to: &mut [u32; LANES]);

    /// Likewise of a block of whole numbers.
    fn compress_block(self, block: [u32; LANES], mask: u32, to: &mut [u32; LANES]);

    /// Parts numbers from 0 up to infinity by a threshold.
    fn part(self, numbers: &[[f32; LANES]], threshold: f32) -> Parted;
}

/// The best instructions that the processor has.
#[derive(Clone, Copy, Debug)]
pub(super) enum Instructions {
    #[cfg(target_arch = "x86_64")]
    Avx512(pulp::x86::V4),
    #[cfg(target_arch = "x86_64")]
    Avx2(pulp::x86::V3),
    Portable,
}

/// What is done with [`Lanes`].
pub(super) trait Task {
    type Output;

    /// Does it. To be inlined always, as all that it calls, but by [`Lanes::call`]: what is not would be compiled without them.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

impl Instructions {
    /// Asks the processor.
    #[cfg(target_arch = "x86_64")]
    pub(super) fn detect() -> Self {
        let avx2 = || pulp::x86::V3::try_new().map_or(Self::Portable, Self::Avx2);
        pulp::x86::V4::try_new().map_or_else(avx2, Self::Avx512)
    }

    /// What every processor of this kind has.
    #[cfg(not(target_arch = "x86_64"))]
    pub(super) fn detect() -> Self {
        Self::Portable
    }

    /// Does a task.
    #[inline]
    pub(super) fn run<T: Task>(self, task: T) -> T::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(v4) => v4.call(
                #[inline(always)]
                || task.run(v4),
            ),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(v3) => v3.call(
                #[inline(always)]
                || task.run(v3),
            ),
            Self::Portable => task.run(Portable),
        }
    }

    /// All that this processor can run.
    #[cfg(test)]
    pub(super) fn all() -> Vec<Self> {
        let mut all = vec![Self::Portable];
        #[cfg(target_arch = "x86_64")]
        {
            all.extend(pulp::x86::V3::try_new().map(Self::Avx2));
            all.extend(pulp::x86::V4::try_new().map(Self::Avx512));
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// All that [`Lanes`] can do, as bits.
    struct Everything {
        a: [f32; LANES],
        b: [f32; LANES],
        mask: u32,
    }

    #[derive(Debug, PartialEq)]
    struct Outcome {
        floats: Vec<[u32; LANES]>,
        mask: u32,
        compressed: [Vec<u32>; 3],
        parted: Parted,
    }

    impl Task for Everything {
        type Output = Outcome;

        #[inline(always)]
        fn run<L: Lanes>(self, lanes: L) -> Outcome {
            let (a, b) = (lanes.load(&Block(self.a)), lanes.load(&Block(self.b)));
            let bits = |floats: L::Floats| {
                let mut all = [0.0; LANES];
                lanes.compress(floats, 0xffff, &mut all);
                all.map(f32::to_bits)
            };
            let kept = self.mask.count_ones() as usize;
            let mut floats = [0.0; LANES];
            lanes.compress(a, self.mask, &mut floats);
            let (mut numbers, mut block) = ([0; LANES], [0; LANES]);
            lanes.compress_numbers(70_000, self.mask, &mut numbers);
            lanes.compress_block(self.b.map(f32::to_bits), self.mask, &mut block);
            let squares = [self.a.map(|x| x * x), self.b.map(|x| x * x)];
            Outcome {
                floats: vec![
                    bits(a),
                    bits(lanes.splat(self.b[3])),
                    bits(lanes.add(a, b)),
                    bits(lanes.sub(a, b)),
                    bits(lanes.mul(a, b)),
                    bits(lanes.max(a, b)),
                ],
                mask: lanes.not_above(a, b),
                compressed: [
                    floats[..kept].iter().map(|x| x.to_bits()).collect(),
                    numbers[..kept].to_vec(),
                    block[..kept].to_vec(),
                ],
                parted: lanes.part(&squares, squares[0][5]),
            }
        }
    }

    fn number() -> impl Strategy<Value = f32> {
        prop_oneof![
            -2.0_f32..2.0,
            (-3_i8..3).prop_map(f32::from),
            -1e30_f32..1e30,
            Just(f32::INFINITY),
        ]
    }

    proptest! {
        /// Every processor's instructions do what plain loops do, bit by bit.
        #[test]
        fn all_instructions_agree(
            a in prop::array::uniform16(number()), b in prop::array::uniform16(number()), mask in 0_u32..0x1_0000,
        ) {
            let by = |instructions: Instructions| instructions.run(Everything { a, b, mask });
            let plain = by(Instructions::Portable);
            let kept: Vec<usize> = (0..LANES).filter(|lane| mask >> lane & 1 == 1).collect();
            let numbers: Vec<u32> = kept.iter().map(|&lane| 70_000 + lane as u32).collect();
            prop_assert_eq!(&plain.compressed[1], &numbers);
            let threshold = a[5] * a[5];
            let below = a.iter().chain(&b).filter(|&&x| x * x <= threshold).count();
            prop_assert_eq!(plain.parted.count, below);
            for instructions in Instructions::all() {
                let made = by(instructions);
                // inf - inf and 0 * inf: any NaN will do.
                let is_nan = |bits: &u32| f32::from_bits(*bits).is_nan();
                for (x, y) in plain.floats.as_flattened().iter().zip(made.floats.as_flattened()) {
                    prop_assert!(x == y || is_nan(x) && is_nan(y), "{:?}", instructions);
                }
                prop_assert_eq!(made.mask, plain.mask);
                prop_assert_eq!(&made.compressed, &plain.compressed);
                prop_assert_eq!(made.parted, plain.parted);
            }
        }
    }
}
