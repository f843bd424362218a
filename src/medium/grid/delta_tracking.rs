//! Free flights by delta tracking with local majorants.
//!
//! In a block with majorant m, tentative collisions come at rate m and are real with probability
//! density / m; an exponential variate of mean 1 is spent along the blocks at rate m (Woodcock et al. 1965;
//! Szirmay-Kalos, Toth and Magdics, *Free Path Sampling in High Resolution Inhomogeneous Participating
//! Media*, CGF 30(1), 2011). The flight has no memory: where a majorant turns out too loose, the rest
//! of the block is sampled by exact inversion instead, which bounds the work.

use super::{
    DensityGrid,
    block_walk::{BlockWalk, LocalRay, Piece},
    brick_atlas::{BRICK_EDGE, MAJORANT_MARGIN},
    brick_index::Content,
    trilinear::blend,
};
use crate::math::{Random, Span, uniform};

/// Tentative collisions in one block after which the rest of it is inverted.
const MAX_LOOKUPS: u32 = 16;

impl DensityGrid {
    /// The distance of the next collision in a medium of sigma_t = `scale` * density; `None` if the ray leaves the
    /// span first. `scale` must be above 0.
    pub(super) fn sample_collision(
        &self,
        ray: &LocalRay,
        span: Span,
        scale: f64,
        random: &mut Random,
    ) -> Option<f64> {
        let mut flight = DeltaFlight { grid: self, ray, scale, budget: 0.0 };
        flight.budget = flight.draw_budget(random);
        BlockWalk::new(self, ray, span).find_map(|piece| flight.cross(&piece, random))
    }

    /// An upper bound of the density in a block.
    #[inline]
    pub(super) fn majorant(&self, content: &Content) -> f64 {
        match content {
            Content::Uniform(density) => *density,
            Content::Corners(corners) => {
                corners.iter().copied().fold(0.0, f64::max) * MAJORANT_MARGIN
            }
            Content::Brick(brick) => self.atlas.majorant(*brick),
        }
    }

    /// Density at a local point of the block a piece lies in.
    #[inline(always)]
    pub(super) fn block_density(&self, piece: &Piece, point: [f64; 3]) -> f64 {
        let place: [f64; 3] = std::array::from_fn(|axis| point[axis] - piece.lower[axis] as f64);
        match &piece.content {
            Content::Uniform(density) => *density,
            Content::Corners(corners) => blend(corners, place),
            Content::Brick(brick) => {
                let cell = place.map(|c| (c as i64).clamp(0, BRICK_EDGE as i64 - 1));
                let weight = std::array::from_fn(|axis| place[axis] - cell[axis] as f64);
                blend(&self.atlas.corners(*brick, cell.map(|c| c as usize)), weight)
            }
        }
    }
}

struct DeltaFlight<'a> {
    grid: &'a DensityGrid,
    ray: &'a LocalRay,
    scale: f64,
    /// What is left until the next tentative collision, in units of density times distance.
    budget: f64,
}

impl DeltaFlight<'_> {
    #[inline]
    fn draw_budget(&self, random: &mut Random) -> f64 {
        -(-uniform(random)).ln_1p() / self.scale
    }

    /// The distance of a collision in the piece, if there is one.
    #[inline]
    fn cross(&mut self, piece: &Piece, random: &mut Random) -> Option<f64> {
        let majorant = self.grid.majorant(&piece.content);
        let mut distance = piece.span.start;
        for _ in 0..MAX_LOOKUPS {
            let depth = majorant * (piece.span.end - distance);
            // Also true of empty blocks, with a budget of 0.
            if depth <= self.budget {
                self.budget -= depth;
                return None;
            }
            distance += self.budget / majorant;
            let density = self.grid.block_density(piece, self.ray.at(distance));
            if uniform(random) * majorant < density {
                return Some(distance.min(piece.span.end));
            }
            self.budget = self.draw_budget(random);
        }
        self.cross_exactly(Span::new(distance, piece.span.end), random)
    }

    /// The distance of a collision in the rest of a block, by inversion of its exact optical depth.
    #[cold]
    fn cross_exactly(&mut self, rest: Span, random: &mut Random) -> Option<f64> {
        let collision = self.grid.distance_at_depth(self.ray, rest, self.draw_budget(random));
        self.budget = self.draw_budget(random);
        collision
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{math::Stream, medium::grid::test_grids::of_field};

    /// Uniform numbers drawn between two states of a generator.
    fn draws(mut before: Random, after: &Random) -> u32 {
        (0..1000)
            .find(|_| {
                let is_same = before == *after;
                uniform(&mut before);
                is_same
            })
            .expect("the generator went further than this")
    }

    #[test]
    fn tentative_collisions_come_at_the_rate_of_the_majorant() {
        // sigma_t = 0.02 x on bricks of 8: majorants 0.16 and 0.32; the ray ends at 16.
        let grid = of_field([0; 3], [2, 0, 0], |[x, ..]| x as f32);
        let scale = 0.02;
        let origin = [0.0, 3.0, 4.0];
        let local = grid.local_origin().to_array();
        let ray = LocalRay::new(std::array::from_fn(|a| origin[a] - local[a]), [1.0, 0.0, 0.0]);
        let span = Span::new(0.0, 16.0);

        // Expected lookups: the majorant's integral, weighted by the chance of getting there.
        let step = 1e-3;
        let truth: f64 = (0..16_000)
            .map(|n| (f64::from(n) + 0.5) * step)
            .map(|x| if x < 8.0 { 0.16 } else { 0.32 } * (-0.01 * x * x).exp() * step)
            .sum();

        let means: Vec<f64> = (0..64)
            .map(|batch| {
                let mut random = Stream::Experiment.random(batch, 3);
                let lookups: u32 = (0..2000)
                    .map(|_| {
                        let before = random.clone();
                        let hit = grid.sample_collision(&ray, span, scale, &mut random);
                        // One draw before all, two a lookup, but one at a collision.
                        (draws(before, &random) - 1 + u32::from(hit.is_some())) / 2
                    })
                    .sum();
                f64::from(lookups) / 2000.0
            })
            .collect();
        let mean = means.iter().sum::<f64>() / 64.0;
        let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / 63.0;
        let z = (mean - truth) / (variance / 64.0).sqrt();
        assert!(z.abs() < 4.5, "{mean} lookups for {truth}, z = {z}");
    }
}
