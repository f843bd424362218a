//! Sixteen lanes as one AVX-512 register or two of AVX2.

use std::arch::x86_64::{__m128, __m128i, __m256, __m256i, __m512, _CMP_LE_OQ};

use pulp::bytemuck::cast;
use pulp::x86::{V3, V4};

use crate::map::lanes::{Block, LANES, Lanes, Parted};

/// Lanes of an AVX2 register.
const HALF: usize = LANES / 2;

/// By mask of eight lanes: the lanes in it, one after another.
const LANES_OF_MASK: [[u8; HALF]; 256] = {
    let mut table = [[0; HALF]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut kept) = (0, 0);
        while lane < HALF {
            if mask >> lane & 1 == 1 {
                table[mask][kept] = lane as u8;
                kept += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// The lanes' own numbers.
const NUMBERS: [u32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// The lanes of each half of a mask to be moved to the front, and how many they are in the first half.
#[inline(always)]
fn permutations(v3: V3, mask: u32) -> ([__m256i; 2], usize) {
    let halves = [permutation(v3, mask), permutation(v3, mask >> HALF)];
    (halves, (mask & 0xff).count_ones() as usize)
}

#[inline(always)]
fn permutation(v3: V3, mask: u32) -> __m256i {
    let lanes = LANES_OF_MASK[(mask & 0xff) as usize];
    v3.avx2._mm256_cvtepu8_epi32(cast([u64::from_le_bytes(lanes), 0]))
}

/// Writes eight numbers from the front and eight from the `kept`-th on.
#[inline(always)]
fn write<T: Copy>([low, high]: [[T; HALF]; 2], kept: usize, to: &mut [T; LANES]) {
    to[..HALF].copy_from_slice(&low);
    if let Some(to) = to.get_mut(kept..kept + HALF) {
        to.copy_from_slice(&high);
    }
}

impl Lanes for V3 {
    type Floats = [__m256; 2];

    #[inline(always)]
    fn call<R>(self, function: impl FnOnce() -> R) -> R {
        self.vectorize(function)
    }

    #[inline(always)]
    fn load(self, block: &Block<f32>) -> [__m256; 2] {
        cast(block.0)
    }

    #[inline(always)]
    fn splat(self, value: f32) -> [__m256; 2] {
        [self.avx._mm256_set1_ps(value); 2]
    }

    #[inline(always)]
    fn add(self, a: [__m256; 2], b: [__m256; 2]) -> [__m256; 2] {
        [self.avx._mm256_add_ps(a[0], b[0]), self.avx._mm256_add_ps(a[1], b[1])]
    }

    #[inline(always)]
    fn sub(self, a: [__m256; 2], b: [__m256; 2]) -> [__m256; 2] {
        [self.avx._mm256_sub_ps(a[0], b[0]), self.avx._mm256_sub_ps(a[1], b[1])]
    }

    #[inline(always)]
    fn mul(self, a: [__m256; 2], b: [__m256; 2]) -> [__m256; 2] {
        [self.avx._mm256_mul_ps(a[0], b[0]), self.avx._mm256_mul_ps(a[1], b[1])]
    }

    #[inline(always)]
    fn max(self, a: [__m256; 2], b: [__m256; 2]) -> [__m256; 2] {
        [self.avx._mm256_max_ps(a[0], b[0]), self.avx._mm256_max_ps(a[1], b[1])]
    }

    #[inline(always)]
    fn not_above(self, a: [__m256; 2], b: [__m256; 2]) -> u32 {
        let low = self.avx._mm256_cmp_ps::<_CMP_LE_OQ>(a[0], b[0]);
        let high = self.avx._mm256_cmp_ps::<_CMP_LE_OQ>(a[1], b[1]);
        let [low, high] = [self.avx._mm256_movemask_ps(low), self.avx._mm256_movemask_ps(high)];
        (low | high << HALF) as u32
    }

    #[inline(always)]
    fn compress(self, floats: [__m256; 2], mask: u32, to: &mut [f32; LANES]) {
        let (lanes, kept) = permutations(self, mask);
        let low = self.avx2._mm256_permutevar8x32_ps(floats[0], lanes[0]);
        let high = self.avx2._mm256_permutevar8x32_ps(floats[1], lanes[1]);
        write([cast(low), cast(high)], kept, to);
    }

    #[inline(always)]
    fn compress_numbers(self, first: u32, mask: u32, to: &mut [u32; LANES]) {
        let (lanes, kept) = permutations(self, mask);
        let second = first + HALF as u32;
        let low = self.avx2._mm256_add_epi32(lanes[0], self.avx._mm256_set1_epi32(first as i32));
        let high = self.avx2._mm256_add_epi32(lanes[1], self.avx._mm256_set1_epi32(second as i32));
        write([cast(low), cast(high)], kept, to);
    }

    #[inline(always)]
    fn compress_block(self, block: [u32; LANES], mask: u32, to: &mut [u32; LANES]) {
        let (lanes, kept) = permutations(self, mask);
        let halves: [__m256i; 2] = cast(block);
        let low = self.avx2._mm256_permutevar8x32_epi32(halves[0], lanes[0]);
        let high = self.avx2._mm256_permutevar8x32_epi32(halves[1], lanes[1]);
        write([cast(low), cast(high)], kept, to);
    }

    #[inline(always)]
    fn part(self, numbers: &[[f32; LANES]], threshold: f32) -> Parted {
        let bound = self.avx._mm256_set1_ps(threshold);
        let none = self.avx._mm256_set1_ps(f32::INFINITY);
        let mut minus_count = self.avx._mm256_setzero_si256();
        let (mut largest, mut smallest) = (self.avx._mm256_setzero_ps(), none);
        for block in numbers {
            for floats in cast::<_, [__m256; 2]>(*block) {
                let is_below = self.avx._mm256_cmp_ps::<_CMP_LE_OQ>(floats, bound);
                minus_count = self.avx2._mm256_add_epi32(minus_count, cast(is_below));
                let below = self.avx._mm256_and_ps(floats, is_below);
                largest = self.avx._mm256_max_ps(largest, below);
                let above = self.avx._mm256_blendv_ps(floats, none, is_below);
                smallest = self.avx._mm256_min_ps(smallest, above);
            }
        }
        let [a, b]: [__m128i; 2] = cast(minus_count);
        let counts = self.sse2._mm_add_epi32(a, b);
        let counts = self.sse2._mm_add_epi32(counts, self.sse2._mm_shuffle_epi32::<0b1110>(counts));
        let counts = self.sse2._mm_add_epi32(counts, self.sse2._mm_shuffle_epi32::<0b01>(counts));
        let [a, b]: [__m128; 2] = cast(largest);
        let largest = self.sse._mm_max_ps(a, b);
        let largest = self.sse._mm_max_ps(largest, self.sse._mm_movehl_ps(largest, largest));
        let largest = self.sse._mm_max_ps(largest, self.sse3._mm_movehdup_ps(largest));
        let [a, b]: [__m128; 2] = cast(smallest);
        let smallest = self.sse._mm_min_ps(a, b);
        let smallest = self.sse._mm_min_ps(smallest, self.sse._mm_movehl_ps(smallest, smallest));
        let smallest = self.sse._mm_min_ps(smallest, self.sse3._mm_movehdup_ps(smallest));
        Parted {
            count: self.sse2._mm_cvtsi128_si32(counts).unsigned_abs() as usize,
            largest: self.sse._mm_cvtss_f32(largest),
            smallest: self.sse._mm_cvtss_f32(smallest),
        }
    }
}

impl Lanes for V4 {
    type Floats = __m512;

    #[inline(always)]
    fn call<R>(self, function: impl FnOnce() -> R) -> R {
        self.vectorize(function)
    }

    #[inline(always)]
    fn load(self, block: &Block<f32>) -> __m512 {
        cast(block.0)
    }

    #[inline(always)]
    fn splat(self, value: f32) -> __m512 {
        self.avx512f._mm512_set1_ps(value)
    }

    #[inline(always)]
    fn add(self, a: __m512, b: __m512) -> __m512 {
        self.avx512f._mm512_add_ps(a, b)
    }

    #[inline(always)]
    fn sub(self, a: __m512, b: __m512) -> __m512 {
        self.avx512f._mm512_sub_ps(a, b)
    }

    #[inline(always)]
    fn mul(self, a: __m512, b: __m512) -> __m512 {
        self.avx512f._mm512_mul_ps(a, b)
    }

    #[inline(always)]
    fn max(self, a: __m512, b: __m512) -> __m512 {
        self.avx512f._mm512_max_ps(a, b)
    }

    #[inline(always)]
    fn not_above(self, a: __m512, b: __m512) -> u32 {
        u32::from(self.avx512f._mm512_cmple_ps_mask(a, b))
    }

    #[inline(always)]
    fn compress(self, floats: __m512, mask: u32, to: &mut [f32; LANES]) {
        *to = cast(self.avx512f._mm512_maskz_compress_ps(mask as u16, floats));
    }

    #[inline(always)]
    fn compress_numbers(self, first: u32, mask: u32, to: &mut [u32; LANES]) {
        let numbers = self
            .avx512f
            ._mm512_add_epi32(cast(NUMBERS), self.avx512f._mm512_set1_epi32(first as i32));
        *to = cast(self.avx512f._mm512_maskz_compress_epi32(mask as u16, numbers));
    }

    #[inline(always)]
    fn compress_block(self, block: [u32; LANES], mask: u32, to: &mut [u32; LANES]) {
        *to = cast(self.avx512f._mm512_maskz_compress_epi32(mask as u16, cast(block)));
    }

    #[inline(always)]
    fn part(self, numbers: &[[f32; LANES]], threshold: f32) -> Parted {
        let bound = self.avx512f._mm512_set1_ps(threshold);
        let mut largest = self.avx512f._mm512_setzero_ps();
        let mut smallest = self.avx512f._mm512_set1_ps(f32::INFINITY);
        let mut count = 0;
        for block in numbers {
            let floats: __m512 = cast(*block);
            let below = self.avx512f._mm512_cmple_ps_mask(floats, bound);
            count += below.count_ones() as usize;
            largest = self.avx512f._mm512_mask_max_ps(largest, below, largest, floats);
            smallest = self.avx512f._mm512_mask_min_ps(smallest, !below, smallest, floats);
        }
        Parted {
            count,
            largest: self.avx512f._mm512_reduce_max_ps(largest),
            smallest: self.avx512f._mm512_reduce_min_ps(smallest),
        }
    }
}
