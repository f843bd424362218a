//! Means over a pixel's samples, and the variance of the mean, sample by sample (Welford 1962).

use crate::film::Pixel;
use crate::math::Rgb;

use super::path::PathLight;

/// Adds one sample, worth `weight`. All layers are means; `variance` is that of the mean of the radiance, 0 for a single sample.
pub(super) fn add_sample(pixel: &mut Pixel, seen: &PathLight, weight: f64) {
    let before = pixel.radiance();
    let count = pixel.sample_count + 1.0;
    let towards = |mean: &mut Rgb, value: Rgb| *mean += (value * weight - *mean) / count;
    towards(&mut pixel.single_scatter, seen.single_scatter);
    towards(&mut pixel.multiple_scatter, seen.multiple_scatter);
    towards(&mut pixel.emission, seen.emission);
    towards(&mut pixel.transmittance, seen.transmittance);
    if count > 1.0 {
        let value = seen.radiance() * weight;
        let squares = pixel.variance * ((count - 1.0) * (count - 2.0))
            + (value - before) * (value - pixel.radiance());
        pixel.variance = (squares / (count * (count - 1.0))).max(Rgb::ZERO);
    }
    pixel.sample_count = count;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_variance_of_a_few_samples() {
        let mut pixel = Pixel::default();
        let values = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0];
        for value in values {
            let seen = PathLight {
                single_scatter: Rgb::new(value, 0.0, 2.0),
                emission: Rgb::ONE,
                ..PathLight::default()
            };
            add_sample(&mut pixel, &seen, 0.5);
        }
        let mean = values.iter().sum::<f64>() / 12.0;
        let squares: f64 = values.iter().map(|value| (0.5 * value - mean).powi(2)).sum();
        assert!((pixel.single_scatter.x - mean).abs() < 1e-14);
        assert!((pixel.variance.x - squares / 30.0).abs() < 1e-14);
        assert_eq!(pixel.radiance().z, 1.5);
        assert_eq!(pixel.variance.y, 0.0);
        assert_eq!(pixel.sample_count, 6.0);
    }
}
