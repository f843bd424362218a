//! Places within a pixel: even, and where the pixel shows a point light in the medium also about that light.
//!
//! The scattered light of a ray that passes a point light at distance D grows as 1 / D: even places would give such a
//! pixel an infinite variance. Half of its places are drawn along rays from the light's image instead, with density
//! 1 / (2 pi rho edge), rho the distance and edge that of the pixel's edge in the same direction; a place is worth one over the density of the
//! mixture. Of a light just beyond the pixel's edge the nearest point of the pixel takes the place: every other is nearer to it than
//! to the light.

use std::f64::consts::PI;

use crate::math::{DVec2, Random, uniform};

/// A place on the image, in pixels from its top left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WeightedPlace {
    pub(super) position: DVec2,
    /// Of mean 1.
    pub(super) weight: f64,
}

/// How far beyond its edge a pixel heeds lights \[pixels\].
const REACH: f64 = 0.5;

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
        let near = |peak: &DVec2| {
            let offset = *peak - corner;
            let nearest = offset.clamp(DVec2::ZERO, DVec2::ONE);
            (offset.distance(nearest) < REACH).then_some(nearest)
        };
        Self { corner, peaks: peaks.iter().filter_map(near).collect() }
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

/// Density of places about a light's image: infinite on it, where all directions out of the pixel lead.
fn density(peak: DVec2, offset: DVec2) -> f64 {
    let rho = (offset - peak).length();
    if rho == 0.0 {
        return f64::INFINITY;
    }
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
        for (peaks, near_count) in [
            (vec![DVec2::new(4.2, 7.9), DVec2::new(1.0, 1.0), DVec2::new(4.7, 7.1)], 2),
            // On an edge, but for rounding; on a corner; beyond.
            (vec![DVec2::new(4.0 + 1e-15, 7.3)], 1),
            (vec![DVec2::new(4.0 - 1e-15, 7.3)], 1),
            (vec![DVec2::new(5.0, 8.0)], 1),
            (vec![DVec2::new(3.8, 7.3), DVec2::new(3.4, 7.3)], 1),
        ] {
            let places = PixelPlaces::new(corner, &peaks);
            assert_eq!(places.peaks.len(), near_count);
            let mut random = Stream::Experiment.random(2, 0);
            let count = 200_000;
            let (mut total, mut first, mut largest) = (0.0, DVec2::ZERO, 0.0_f64);
            for _ in 0..count {
                let WeightedPlace { position, weight } = places.sample(&mut random);
                assert!((0.0..=3.0).contains(&weight));
                total += weight / f64::from(count);
                first += (position - corner) * weight / f64::from(count);
                // No ray passes a light nearer than rounding.
                let distance = position.distance(peaks[0]).max(1e-12);
                largest = largest.max(weight / distance);
            }
            assert!((total - 1.0).abs() < 5e-3, "{total} {peaks:?}");
            assert!((first - DVec2::splat(0.5)).abs().max_element() < 5e-3, "{first} {peaks:?}");
            assert!(largest < 25.0, "what grows as the inverse distance stays bounded: {largest}");
        }
        let even = PixelPlaces::new(DVec2::ZERO, &[DVec2::new(4.2, 7.9)]);
        assert_eq!(even.sample(&mut Stream::Experiment.random(2, 0)).weight, 1.0);
    }
}
