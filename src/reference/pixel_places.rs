//! Places within a pixel: even, and where the pixel shows a point light in the medium also about that light.
//!
//! The scattered light of a ray that passes a point light at distance D grows as 1 / D: even places would give such a
//! pixel an infinite variance. Half of its places are drawn along rays from the light's image instead, with density
//! 1 / (2 pi rho edge), rho the distance and edge that of the pixel's edge in the same direction; a place is worth one over the density of the
//! mixture.

use std::f64::consts::PI;

use crate::math::{DVec2, Random, uniform};

/// A place on the image, in pixels from its top left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WeightedPlace {
    pub(super) position: DVec2,
    /// Of mean 1.
    pub(super) weight: f64,
}

/// The pixel whose top left corner is `corner`.
#[derive(Clone, Debug)]
pub(super) struct PixelPlaces {
    corner: DVec2,
    /// Images of lights in the pixel, from its corner.
    peaks: Vec<DVec2>,
}

impl PixelPlaces {
    /// `peaks` are the images of all lights, in pixels.
    pub(super) fn new(corner: DVec2, peaks: &[DVec2]) -> Self {
        let within = |peak: &DVec2| peak.cmpge(DVec2::ZERO).all() && peak.cmplt(DVec2::ONE).all();
        let peaks = peaks.iter().map(|peak| *peak - corner).filter(within).collect();
        Self { corner, peaks }
    }

    pub(super) fn sample(&self, random: &mut Random) -> WeightedPlace {
        let ways = self.peaks.len() + 1;
        let way = ((uniform(random) * ways as f64) as usize).min(ways - 1);
        let square = DVec2::new(uniform(random), uniform(random));
        let offset = match self.peaks.get(way) {
            Some(peak) => {
                let direction = DVec2::from_angle(2.0 * PI * square.x);
                *peak + direction * (square.y * distance_to_edge(*peak, direction))
            }
            None => square,
        };
        let density = 1.0 + self.peaks.iter().map(|peak| density(*peak, offset)).sum::<f64>();
        WeightedPlace { position: self.corner + offset, weight: ways as f64 / density }
    }
}

/// Density of places about a light's image.
fn density(peak: DVec2, offset: DVec2) -> f64 {
    let rho = (offset - peak).length().max(f64::MIN_POSITIVE);
    1.0 / (2.0 * PI * rho * distance_to_edge(peak, (offset - peak) / rho))
}

/// From a place in the unit square to its edge.
fn distance_to_edge(place: DVec2, direction: DVec2) -> f64 {
    let along = |place: f64, direction: f64| match direction {
        d if d > 0.0 => (1.0 - place) / d,
        d if d < 0.0 => -place / d,
        _ => f64::INFINITY,
    };
    along(place.x, direction.x).min(along(place.y, direction.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Stream;

    #[test]
    fn weighted_places_are_even() {
        let corner = DVec2::new(4.0, 7.0);
        let peaks = [DVec2::new(4.2, 7.9), DVec2::new(1.0, 1.0), DVec2::new(4.7, 7.1)];
        let places = PixelPlaces::new(corner, &peaks);
        assert_eq!(places.peaks.len(), 2);
        let mut random = Stream::Experiment.random(2, 0);
        let count = 200_000;
        let (mut total, mut first) = (0.0, DVec2::ZERO);
        for _ in 0..count {
            let WeightedPlace { position, weight } = places.sample(&mut random);
            assert!(weight > 0.0 && weight <= 3.0);
            total += weight / f64::from(count);
            first += (position - corner) * weight / f64::from(count);
        }
        assert!((total - 1.0).abs() < 5e-3, "{total}");
        assert!((first - DVec2::splat(0.5)).abs().max_element() < 5e-3, "{first}");
        let even = PixelPlaces::new(DVec2::ZERO, &peaks).sample(&mut random);
        assert_eq!(even.weight, 1.0);
    }
}
