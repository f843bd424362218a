//! Random streams: each photon, pixel or batch draws from a generator that depends on
//! (seed, purpose, index) alone, so that no result depends on the number of threads.

use rand::{Rng, SeedableRng};

/// The generator: xoshiro256++ (Blackman and Vigna, 2019), named rather than "the standard one", so
/// that a new release of `rand` does not change a render.
pub type Random = rand::rngs::Xoshiro256PlusPlus;

/// What a stream is for. Streams of different purposes never meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Stream {
    /// Emission and path of one photon.
    Photon = 1,
    /// Rays of one pixel.
    Pixel = 2,
    /// Scrambling of a low-discrepancy sequence or of strata.
    Scramble = 3,
    /// Experiments of the lab and of tests.
    Experiment = 4,
    /// Probes of where photons are worth sending.
    Guide = 5,
    /// Rays that several photons share.
    Ray = 6,
    /// Paths of the reference path tracer.
    Reference = 7,
    /// Photons drawn anew to see how their number in a ball varies.
    Calibration = 8,
    /// Camera paths that end in a lattice.
    Bounce = 9,
    /// Directions towards lights from a voxel.
    Bake = 10,
}

impl Stream {
    /// The generator of element `index` under `seed`.
    pub fn random(self, seed: u64, index: u64) -> Random {
        Random::seed_from_u64(self.hash(seed, index))
    }

    /// 64 well-mixed bits of (seed, purpose, index).
    pub fn hash(self, seed: u64, index: u64) -> u64 {
        mix(mix(mix(seed) ^ self as u64) ^ index)
    }
}

/// splitmix64's output function (Steele, Lea and Flood 2014): a bijection of 64 bits.
fn mix(value: u64) -> u64 {
    let z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A uniform number in \[0, 1) with 53 random bits: its free flights reach 36.7 mean free paths,
/// where 24 bits would stop at 16.6.
#[inline]
pub fn uniform(random: &mut impl Rng) -> f64 {
    (random.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}
