//! Densities in 16 bits: IEEE half floats times a power of two.
//!
//! Densities are finite and not negative, so a half's sign bit is 0 and no exponent is that of infinity. Moved
//! to where a `f32` has its exponent, the bits are the value times 2^-112; one multiplication restores
//! it, subnormal halves included, together with the scale.

use half::{f16, slice::HalfFloatSliceExt};

/// Exponent that the largest density is brought to: below the 15 of the largest half, so that rounding cannot
/// make it infinite.
const MAX_EXPONENT: i32 = 14;
/// Difference between the biases of the exponents of `f32` and of halves.
const BIAS_DIFFERENCE: i32 = 127 - 15;
/// Bits of the mantissa of `f32` beyond those of halves.
const MANTISSA_DIFFERENCE: u32 = 23 - 10;

/// The power of two that densities are multiplied with before they are rounded.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfScale {
    encoding: f64,
    /// Inverse of `encoding`, times 2^112.
    decoding: f64,
}

impl HalfScale {
    /// The scale for densities up to `max`.
    pub(super) fn new(max: f32) -> Self {
        // The exponent of `f64` is exact where log2 might round up.
        let exponent = ((f64::from(max).to_bits() >> 52) as i32 & 0x7ff) - 1023;
        let shift = if max > 0.0 { MAX_EXPONENT - exponent } else { 0 };
        let power = |exponent: i32| f64::from_bits(((exponent + 1023) as u64) << 52);
        Self { encoding: power(shift), decoding: power(BIAS_DIFFERENCE - shift) }
    }

    /// The bits of densities, each rounded to the nearest.
    #[inline]
    pub(super) fn encode<const N: usize>(&self, densities: &[f32; N]) -> [u16; N] {
        let scaled = densities.map(|density| (f64::from(density) * self.encoding) as f32);
        let mut halves = [f16::ZERO; N];
        halves.convert_from_f32_slice(&scaled);
        halves.map(f16::to_bits)
    }

    /// The density of some bits.
    #[inline(always)]
    pub(super) fn decode(&self, bits: u16) -> f64 {
        f64::from(f32::from_bits(u32::from(bits) << MANTISSA_DIFFERENCE)) * self.decoding
    }

    /// The density that a density is rounded to. What would be 2^128 stays the largest `f32` below.
    pub(super) fn rounded(&self, density: f32) -> f32 {
        let [bits] = self.encode(&[density]);
        (self.decode(bits) as f32).min(f32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn densities_come_back_within_half_a_step() {
        for max in [1.0, 0.75, 1e-45, 3e-39, f32::MIN_POSITIVE, 65504.0, 7e4, 1e30, f32::MAX] {
            let scale = HalfScale::new(max);
            assert!((max * 0.999..=f32::MAX).contains(&scale.rounded(max)), "{max}");
            for n in 0..4000 {
                let density = max * 0.99_f32.powi(n);
                let error = (f64::from(scale.rounded(density)) - f64::from(density)).abs();
                let bound =
                    (2f64.powi(-11) * f64::from(density)).max(2f64.powi(-39) * f64::from(max));
                assert!(error <= bound, "{density} of {max}: {error} > {bound}");
            }
        }
        assert_eq!(HalfScale::new(0.0).rounded(0.0), 0.0);
    }

    #[test]
    fn every_half_is_decoded_exactly() {
        let scale = HalfScale::new(16384.0);
        for bits in 0..0x7c00 {
            assert_eq!(scale.decode(bits), f16::from_bits(bits).to_f64(), "{bits:#x}");
        }
        assert_eq!(HalfScale::new(2f32.powi(-40)).decode(0x7400), 2f64.powi(-40));
    }
}
