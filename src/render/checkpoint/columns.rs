//! Numbers a pixel as bytes, exact to the bit: `f64`, little-endian, one layer after the other.
//!
//! A layer of N channels begins with a byte. 0: all pixels are equal, and one follows. 1: every pixel has equal channels, and the
//! first of each pixel follows. 2: all numbers follow. Grey light takes a third, and what a scene has none of nothing.

const ONE_FOR_ALL: u8 = 0;
const GREY: u8 = 1;
const FULL: u8 = 2;

/// Adds a layer, of a known number of pixels.
pub fn push_layer<const N: usize>(
    bytes: &mut Vec<u8>,
    pixels: impl Iterator<Item = [f64; N]> + Clone,
) {
    let bits = |pixel: [f64; N]| pixel.map(f64::to_bits);
    let first = pixels.clone().next().unwrap_or([0.0; N]);
    if pixels.clone().all(|pixel| bits(pixel) == bits(first)) {
        bytes.push(ONE_FOR_ALL);
        bytes.extend(first.iter().flat_map(|value| value.to_le_bytes()));
    } else if N > 1 && pixels.clone().all(|pixel| bits(pixel) == bits([pixel[0]; N])) {
        bytes.push(GREY);
        bytes.extend(pixels.flat_map(|pixel| pixel[0].to_le_bytes()));
    } else {
        bytes.push(FULL);
        bytes.extend(pixels.flatten().flat_map(f64::to_le_bytes));
    }
}

/// The most bytes that a layer takes.
pub fn layer_limit(channels: usize, pixels: usize) -> u64 {
    1 + 8 * channels as u64 * (pixels as u64).max(1)
}

/// Layers, read in their order.
pub struct Layers<'a> {
    /// What is left to read.
    pub rest: &'a [u8],
}

impl Layers<'_> {
    /// The next layer, of so many pixels; `None` where the bytes are not one.
    pub fn next<const N: usize>(&mut self, pixels: usize) -> Option<Vec<[f64; N]>> {
        let (&kind, rest) = self.rest.split_first()?;
        let numbers = match kind {
            ONE_FOR_ALL => N,
            GREY => pixels,
            FULL => pixels.checked_mul(N)?,
            _ => return None,
        };
        // Nothing is allocated for numbers that are not there.
        let (layer, rest) = rest.split_at_checked(numbers.checked_mul(8)?)?;
        self.rest = rest;
        let (numbers, _) = layer.as_chunks::<8>();
        let number = |bytes: &[u8; 8]| f64::from_le_bytes(*bytes);
        Some(match kind {
            ONE_FOR_ALL => vec![std::array::from_fn(|channel| number(&numbers[channel])); pixels],
            GREY => numbers.iter().map(|bytes| [number(bytes); N]).collect(),
            _ => numbers.as_chunks::<N>().0.iter().map(|pixel| pixel.map(|b| number(&b))).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn round_trip<const N: usize>(pixels: &[[f64; N]], expected_len: usize) {
        let mut bytes = Vec::new();
        push_layer(&mut bytes, pixels.iter().copied());
        assert_eq!(bytes.len(), expected_len);
        assert!(bytes.len() as u64 <= layer_limit(N, pixels.len()));
        let mut layers = Layers { rest: &bytes };
        let read = layers.next::<N>(pixels.len()).unwrap();
        assert!(layers.rest.is_empty());
        let bits =
            |pixels: &[[f64; N]]| pixels.concat().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&read), bits(pixels));
        // A layer that is cut off is none, however many pixels it claims.
        for len in 0..bytes.len() {
            assert!(Layers { rest: &bytes[..len] }.next::<N>(pixels.len()).is_none());
        }
        assert!(Layers { rest: &[3, 0, 0] }.next::<N>(pixels.len()).is_none());
        assert!(Layers { rest: &[FULL, 0, 0] }.next::<N>(usize::MAX).is_none());
    }

    #[test]
    fn every_bit_comes_back() {
        round_trip(&[[1.0, -0.0, f64::NAN]; 7], 1 + 24);
        round_trip(&[[-0.0; 3], [0.0; 3], [f64::INFINITY; 3]], 1 + 24);
        round_trip(&[[0.0, -0.0, 0.0], [0.0; 3]], 1 + 48);
        round_trip(&[[5e-324], [1.0 / 3.0]], 1 + 16);
        round_trip::<3>(&[], 1 + 24);
    }
}
