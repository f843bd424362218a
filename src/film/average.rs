//! The mean of films, and the variance of the mean, film by film (Welford 1962).

use super::{Film, Pixel};
use crate::math::Rgb;

impl Film {
    /// Makes this, the mean of `count` films of the same size and layers, the mean of one more. Where `count` is 1 or more, the pixels'
    /// `variance` becomes that of the mean, estimated from how the films differ.
    pub fn average_in(&mut self, film: &Film, count: u32) {
        let count = f64::from(count);
        let share = 1.0 / (count + 1.0);
        for (means, depths) in self.depths.iter_mut().zip(&film.depths) {
            means.iter_mut().zip(depths).for_each(|(mean, d)| mean.move_towards(d, share));
        }
        for (means, light) in self.lights.iter_mut().zip(&film.lights) {
            let pixels = means.radiance.iter_mut().zip(&light.radiance);
            pixels.for_each(|(mean, radiance)| *mean += (*radiance - *mean) * share);
        }
        self.pixels.iter_mut().zip(&film.pixels).for_each(|(mean, pixel)| mean.add(pixel, count));
    }
}

impl Pixel {
    fn add(&mut self, pixel: &Pixel, count: f64) {
        let share = 1.0 / (count + 1.0);
        let before = self.radiance();
        let towards = |mean: &mut Rgb, value: Rgb| *mean += (value - *mean) * share;
        towards(&mut self.single_scatter, pixel.single_scatter);
        towards(&mut self.multiple_scatter, pixel.multiple_scatter);
        towards(&mut self.emission, pixel.emission);
        towards(&mut self.transmittance, pixel.transmittance);
        self.photon_count += (pixel.photon_count - self.photon_count) * share;
        self.kernel_radius += (pixel.kernel_radius - self.kernel_radius) * share;
        self.sample_count += pixel.sample_count;
        if count > 0.0 {
            let value = pixel.radiance();
            let squares = self.variance * (count * (count - 1.0))
                + (value - before) * (value - self.radiance());
            self.variance = (squares * share / count).max(Rgb::ZERO);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_variance_of_a_few_films() {
        let values = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0];
        let mut mean = Film::new(1, 1);
        for (count, value) in values.into_iter().enumerate() {
            let mut film = Film::new(1, 1);
            film.pixels[0].single_scatter = Rgb::new(value, 0.0, 2.0);
            film.pixels[0].sample_count = 4.0;
            mean.average_in(&film, count as u32);
        }
        let pixel = mean.pixels[0];
        let average = values.iter().sum::<f64>() / 6.0;
        let squares: f64 = values.iter().map(|value| (value - average).powi(2)).sum();
        assert!((pixel.single_scatter.x - average).abs() < 1e-14);
        assert!((pixel.variance.x - squares / 30.0).abs() < 1e-14);
        assert_eq!(pixel.single_scatter.z, 2.0);
        assert_eq!(pixel.variance.z, 0.0);
        assert_eq!(pixel.sample_count, 24.0);
    }
}
