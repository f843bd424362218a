//! The pixel that holds a light.
//!
//! Single scattering near the image of a point light grows as the inverse of the distance from it on the image: finite over a
//! pixel, but of infinite variance under uniform samples. Polar samples about the light's image have density
//! 1 / rho and take the peak away.

use std::f64::consts::PI;

use crate::math::{DVec2, Random, uniform};

/// A sub-pixel position with its weight: the inverse of its density over the unit pixel.
#[derive(Clone, Copy, Debug)]
pub struct WeightedPlace {
    /// In pixels from the image's top left corner.
    pub position: DVec2,
    /// Mean 1 over samples.
    pub weight: f64,
}

/// Sample `index` of `count` about `center` in the pixel whose top left corner is `corner`: the angle stratified,
/// the distance uniform up to the pixel's edge.
pub fn polar_sample(
    center: DVec2,
    corner: DVec2,
    index: usize,
    count: usize,
    random: &mut Random,
) -> WeightedPlace {
    let angle = 2.0 * PI * (index as f64 + uniform(random)) / count as f64;
    let direction = DVec2::from_angle(angle);
    let edge = distance_to_edge(center - corner, direction);
    let rho = edge * uniform(random);
    WeightedPlace { position: center + direction * rho, weight: 2.0 * PI * rho * edge }
}

/// From a point of the unit square to its edge.
fn distance_to_edge(point: DVec2, direction: DVec2) -> f64 {
    let along = |p: f64, d: f64| match d {
        d if d > 0.0 => (1.0 - p) / d,
        d if d < 0.0 => -p / d,
        _ => f64::INFINITY,
    };
    along(point.x, direction.x).min(along(point.y, direction.y)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Stream;

    /// Weights integrate 1, and 1 / rho exactly, to the sampling error.
    #[test]
    fn polar_samples_cover_the_pixel() {
        let (corner, center) = (DVec2::new(4.0, 7.0), DVec2::new(4.2, 7.9));
        let mut random = Stream::Experiment.random(2, 0);
        let count = 200_000;
        let (mut area, mut mean_x, mut peak) = (0.0, 0.0, 0.0);
        for index in 0..count {
            let sample = polar_sample(center, corner, index, count, &mut random);
            let share = sample.weight / count as f64;
            area += share;
            mean_x += share * (sample.position.x - corner.x);
            peak += share / (sample.position - center).length().max(1e-300);
        }
        assert!((area - 1.0).abs() < 5e-3, "{area}");
        assert!((mean_x - 0.5).abs() < 5e-3, "{mean_x}");
        let steps = 100_000;
        let edges = (0..steps).map(|i| {
            let direction = DVec2::from_angle(2.0 * PI * f64::from(i) / f64::from(steps));
            distance_to_edge(center - corner, direction)
        });
        let exact = 2.0 * PI * edges.sum::<f64>() / f64::from(steps);
        assert!((peak / exact - 1.0).abs() < 1e-3, "{peak} {exact}");
    }
}
