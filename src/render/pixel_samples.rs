//! Where in a pixel rays go, and where along them they look: one sequence for all passes.
//!
//! Sample n of a pixel is the shift of the pixel, random, plus n times the additive constants of the R3 sequence (Roberts, *The
//! Unreasonable Effectiveness of Quasirandom Sequences*, 2018), modulo 1: any number of samples covers the pixel, and the
//! depth, evenly. The shift makes each sample uniform, so that the mean is exact.

use crate::math::{DVec2, Random, uniform};

/// 1 / x, 1 / x^2 and 1 / x^3 with x^4 = x + 1.
const STEPS: [f64; 3] = [0.819_172_513_396_164_5, 0.671_043_606_703_789_3, 0.549_700_477_901_970_3];

/// The samples of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct PixelSamples {
    shift: [f64; 3],
}

/// One sample.
#[derive(Clone, Copy, Debug)]
pub struct PixelSample {
    /// From the pixel's corner \[pixels\].
    pub offset: DVec2,
    /// Where in each of a ray's strata to look, in \[0, 1).
    pub phase: f64,
}

impl PixelSamples {
    /// The samples of a pixel.
    pub fn new(random: &mut Random) -> Self {
        Self { shift: std::array::from_fn(|_| uniform(random)) }
    }

    /// Sample `index`.
    pub fn sample(&self, index: u64) -> PixelSample {
        let [x, y, phase] =
            std::array::from_fn(|axis| (self.shift[axis] + index as f64 * STEPS[axis]).fract());
        PixelSample { offset: DVec2::new(x, y), phase }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Stream;

    /// Any 1024 samples in a row fill each of 16 intervals of each dimension, and of a square's 16 cells, near evenly.
    #[test]
    fn samples_are_even_in_every_dimension_and_pair() {
        let samples = PixelSamples::new(&mut Stream::Pixel.random(1, 2));
        for first in [0, 1000, 1 << 30] {
            let places: Vec<[f64; 3]> = (first..first + 1024)
                .map(|index| samples.sample(index))
                .map(|sample| [sample.offset.x, sample.offset.y, sample.phase])
                .collect();
            for axis in 0..3 {
                let other = (axis + 1) % 3;
                let (mut line, mut square) = ([0; 16], [0; 16]);
                for place in &places {
                    assert!(place.iter().all(|x| (0.0..1.0).contains(x)));
                    line[(place[axis] * 16.0) as usize] += 1;
                    square[(place[axis] * 4.0) as usize * 4 + (place[other] * 4.0) as usize] += 1;
                }
                assert!(line.iter().all(|&count| (56..=72).contains(&count)), "{line:?}");
                assert!(square.iter().all(|&count| (54..=72).contains(&count)), "{square:?}");
            }
        }
    }
}
