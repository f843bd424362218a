//! Transmittance by ratio tracking with local majorants.
//!
//! Tentative collisions come at the rate of a block's majorant m, as in delta tracking, but none is real: each multiplies
//! the estimate by 1 - density / m, so that its mean is exp(-optical depth) (Cramer 1978; Novak, Selle and Jarosz, *Residual Ratio
//! Tracking for Estimating Attenuation in Participating Media*, SIGGRAPH Asia 2014). Uniform blocks are exact, and so
//! is the rest of a block whose majorant turns out too loose, which bounds the work. Small estimates play roulette.

use super::{
    DensityGrid,
    block_walk::{BlockWalk, LocalRay, Piece},
    brick_index::Content,
};
use crate::math::{Random, Span, uniform};

/// Tentative collisions in one block after which the rest of it is integrated.
const MAX_LOOKUPS: u32 = 16;

/// An estimate below survives with the probability of its share of this.
const ROULETTE_BELOW: f64 = 0.1;

impl DensityGrid {
    /// A random number whose mean is the transmittance of the span, where sigma_t = `scale` * density; `scale` must be above
    /// 0.
    pub(super) fn estimate_transmittance(
        &self,
        ray: &LocalRay,
        span: Span,
        scale: f64,
        random: &mut Random,
    ) -> f64 {
        let mut track = RatioTrack { grid: self, ray, scale, transmittance: 1.0 };
        for piece in BlockWalk::new(self, ray, span) {
            track.cross(&piece, random);
            if !track.survives(random) {
                return 0.0;
            }
        }
        track.transmittance
    }
}

struct RatioTrack<'a> {
    grid: &'a DensityGrid,
    ray: &'a LocalRay,
    scale: f64,
    transmittance: f64,
}

impl RatioTrack<'_> {
    /// Attenuates by one piece.
    fn cross(&mut self, piece: &Piece, random: &mut Random) {
        if let Content::Uniform(density) = piece.content {
            self.transmittance *= (-self.scale * density * piece.span.length()).exp();
            return;
        }
        let majorant = self.grid.majorant(&piece.content);
        let rate = self.scale * majorant;
        if rate <= 0.0 {
            return;
        }
        let mut distance = piece.span.start;
        for _ in 0..MAX_LOOKUPS {
            distance -= (-uniform(random)).ln_1p() / rate;
            if distance >= piece.span.end {
                return;
            }
            let density = self.grid.block_density(piece, self.ray.at(distance));
            self.transmittance *= (1.0 - density / majorant).max(0.0);
            if !self.survives(random) {
                return;
            }
        }
        let rest = Span::new(distance, piece.span.end);
        self.transmittance *= (-self.scale * self.grid.depth(self.ray, rest)).exp();
    }

    /// Plays roulette if little is left; `false`, and a transmittance of 0, if it is lost.
    fn survives(&mut self, random: &mut Random) -> bool {
        if self.transmittance >= ROULETTE_BELOW {
            return true;
        }
        let survives = uniform(random) * ROULETTE_BELOW < self.transmittance;
        self.transmittance = if survives { ROULETTE_BELOW } else { 0.0 };
        survives
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{math::Stream, medium::grid::test_grids::clumps};

    /// Thin to opaque, with bricks loose enough that their rest is integrated.
    #[test]
    fn the_mean_is_the_transmittance() {
        let grid = clumps();
        let center = -grid.local_origin();
        let origin = [center.x - 40.0, center.y + 1.3, center.z - 2.2];
        let span = Span::new(3.0, 78.0);
        for (case, direction) in [[1.0, 0.02, 0.05], [0.9, -0.2, 0.3]].into_iter().enumerate() {
            let ray = LocalRay::new(origin, direction);
            let depth = grid.depth(&ray, span);
            for (number, target) in [0.05, 0.7, 3.0].into_iter().enumerate() {
                let (scale, exact) = (target / depth, f64::exp(-target));
                let mut random = Stream::Experiment.random(case as u64, number as u64);
                let batches: Vec<f64> = (0..64)
                    .map(|_| {
                        let one = |_| grid.estimate_transmittance(&ray, span, scale, &mut random);
                        (0..1000).map(one).sum::<f64>() / 1000.0
                    })
                    .collect();
                let mean = batches.iter().sum::<f64>() / 64.0;
                let spread: f64 = batches.iter().map(|b| (b - mean).powi(2)).sum();
                let z = (mean - exact) / (spread / 63.0 / 64.0).sqrt();
                assert!(z.abs() < 4.5, "depth {target}: {mean} for {exact}, z {z}");
            }
        }
    }

    #[test]
    fn any_scale_ends() {
        let grid = clumps();
        let center = -grid.local_origin();
        let ray = LocalRay::new([center.x - 40.0, center.y, center.z], [1.0, 0.1, 0.1]);
        let mut random = Stream::Experiment.random(3, 0);
        for scale in [1e-300, 1e6, 1e300] {
            let span = Span::new(0.0, f64::INFINITY);
            let found = grid.estimate_transmittance(&ray, span, scale, &mut random);
            assert_eq!(found, if scale < 1.0 { 1.0 } else { 0.0 });
        }
    }
}
