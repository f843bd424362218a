//! Directions of a spot by its intensity: equal powers where its light falls off, too.

use crate::emission::aim::AimedDirection;
use crate::light::SpotLight;
use crate::math::square_maps::{
    cap_solid_angle, disc_to_cap, square_to_disc, versine, versine_angle,
};
use crate::math::{DVec2, Frame};

const RINGS: usize = 256;

/// A piecewise constant density over rings of equal solid angle, close to the spot's intensity. A photon's
/// power is its intensity over this density: nearly the same for all, and exact in the mean.
#[derive(Debug)]
pub struct ConeTable {
    /// 1 - cos of the cone's half-angle.
    versine: f64,
    /// Probability of the rings up to and including each.
    cumulative: Vec<f64>,
}

impl ConeTable {
    /// Tabulates a spot's falloff.
    pub fn new(spot: &SpotLight) -> Self {
        let versine = versine(spot.cone_angle);
        let at = |ring: f64| {
            let down = versine * ring / RINGS as f64;
            spot.falloff(versine_angle(down))
        };
        // The intensity falls outward: its value at a ring's inner edge is never 0.
        let weights = (0..RINGS).map(|ring| 0.5 * (at(ring as f64) + at(ring as f64 + 1.0)));
        let total: f64 = weights.clone().sum();
        let mut sum = 0.0;
        let cumulative = weights
            .map(|weight| {
                sum += weight / total;
                sum
            })
            .collect();
        Self { versine, cumulative }
    }

    /// The direction at `u`; its solid angle includes the falloff there.
    pub fn sample_direction(&self, spot: &SpotLight, frame: &Frame, u: DVec2) -> AimedDirection {
        // On the disc the squared radius is uniform: it is bent to the table, the angle kept.
        let disc = square_to_disc(u);
        let quantile = disc.length_squared();
        let ring = self.cumulative.partition_point(|&sum| sum <= quantile).min(RINGS - 1);
        let below = if ring == 0 { 0.0 } else { self.cumulative[ring - 1] };
        let probability = self.cumulative[ring] - below;
        let within = ((quantile - below) / probability).clamp(0.0, 1.0);
        let bent = (ring as f64 + within) / RINGS as f64;
        let scale = if quantile > 0.0 { (bent / quantile).sqrt() } else { 0.0 };
        let (local, down) = disc_to_cap(disc * scale, self.versine);
        let falloff = spot.falloff(versine_angle(down));
        let density = probability * RINGS as f64 / cap_solid_angle(self.versine);
        AimedDirection {
            direction: frame.to_world(local).normalize(),
            solid_angle: falloff / density,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{DVec3, Rgb};

    #[test]
    fn powers_are_nearly_equal_and_sum_to_the_spots() {
        for (cone_angle, falloff_angle) in [(0.3, 0.2), (2.5, 0.0), (1e-6, 1e-6), (0.1, 0.1)] {
            let spot = SpotLight {
                position: DVec3::ZERO,
                axis: DVec3::Y,
                intensity: Rgb::ONE,
                cone_angle,
                falloff_angle,
            };
            let (table, frame) = (ConeTable::new(&spot), Frame::about(spot.axis));
            let side = 300;
            let (mut sum, mut squares) = (0.0, 0.0);
            for i in 0..side * side {
                let u = DVec2::new((i / side) as f64 + 0.5, (i % side) as f64 + 0.5);
                let sample = table.sample_direction(&spot, &frame, u / side as f64);
                assert!(spot.angle_to(sample.direction) <= cone_angle * (1.0 + 1e-9));
                sum += sample.solid_angle;
                squares += sample.solid_angle * sample.solid_angle;
            }
            let mean = sum / (side * side) as f64;
            let spread = (squares / (side * side) as f64 / (mean * mean) - 1.0).max(0.0).sqrt();
            let ratio = mean / spot.effective_solid_angle();
            assert!((ratio - 1.0).abs() < 1e-3, "{cone_angle} {falloff_angle}: {ratio}");
            assert!(spread < 0.05, "{cone_angle} {falloff_angle}: {spread}");
        }
    }
}
