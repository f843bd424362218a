//! The blocks a ray crosses, in order: a 3-D digital differential analyser over boxes of any size.
//!
//! The state is the integer cell the ray is in. Leaving a block moves that cell across the face the ray
//! leaves by, and never back, so the walk ends whatever rounding does; the distance of a face is computed
//! from its integer coordinate each time, so errors do not add up. Amanatides and Woo, *A Fast Voxel
//! Traversal Algorithm for Ray Tracing*, Eurographics 1987, is the case of unit blocks.

use super::{
    DensityGrid,
    brick_index::{Block, Cell, Content},
};
use crate::math::Span;

/// A ray in local coordinates. Distances keep their world units: the direction is not of unit length.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalRay {
    origin: [f64; 3],
    direction: [f64; 3],
    /// 1 / direction; 0 along axes the ray does not move on.
    inverse: [f64; 3],
    /// Distance added to every crossing on an axis: infinite where the ray does not move on it.
    never: [f64; 3],
}

impl LocalRay {
    pub(super) fn new(origin: [f64; 3], direction: [f64; 3]) -> Self {
        let moves = direction.map(|d| (1.0 / d).is_finite());
        let pick =
            |axis: usize, then: f64, otherwise: f64| if moves[axis] { then } else { otherwise };
        Self {
            origin,
            direction,
            inverse: std::array::from_fn(|axis| pick(axis, 1.0 / direction[axis], 0.0)),
            never: std::array::from_fn(|axis| pick(axis, 0.0, f64::INFINITY)),
        }
    }

    /// The point at a distance.
    #[inline(always)]
    pub(super) fn at(&self, distance: f64) -> [f64; 3] {
        std::array::from_fn(|axis| self.origin[axis] + distance * self.direction[axis])
    }

    /// The displacement over a length.
    #[inline(always)]
    pub(super) fn displacement(&self, length: f64) -> [f64; 3] {
        self.direction.map(|d| d * length)
    }

    /// Distances between neighbouring integer planes of each axis.
    #[inline(always)]
    pub(super) fn plane_distances(&self) -> [f64; 3] {
        std::array::from_fn(|axis| self.inverse[axis].abs() + self.never[axis])
    }

    /// Whether the coordinate on an axis grows along the ray.
    #[inline(always)]
    pub(super) fn ascends(&self, axis: usize) -> bool {
        self.inverse[axis] > 0.0
    }

    /// Distance at which the ray crosses the plane of this coordinate; infinite if it does not move there.
    #[inline(always)]
    pub(super) fn crossing(&self, axis: usize, plane: f64) -> f64 {
        (plane - self.origin[axis]) * self.inverse[axis] + self.never[axis]
    }

    /// The part of the span in the box of cells `first` to `last`.
    fn clip(&self, span: Span, first: Cell, last: Cell) -> Option<Span> {
        let mut inside = span;
        for axis in 0..3 {
            let (lower, upper) = (first[axis], last[axis] + 1);
            if self.inverse[axis] == 0.0 {
                let within = lower as f64..=upper as f64;
                if !within.contains(&self.origin[axis]) {
                    return None;
                }
                continue;
            }
            let (near, far) = if self.ascends(axis) { (lower, upper) } else { (upper, lower) };
            inside.start = inside.start.max(self.crossing(axis, near as f64));
            inside.end = inside.end.min(self.crossing(axis, far as f64));
        }
        (inside.start < inside.end).then_some(inside)
    }
}

/// A part of a ray and the block it lies in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) span: Span,
    /// The cell the ray enters the block in.
    pub(super) entry: Cell,
    /// Lowest cell of the block.
    pub(super) lower: Cell,
    pub(super) content: Content,
}

/// Iterates over the [`Piece`]s of a span, which join without gaps and make up the whole span.
pub(super) struct BlockWalk<'a> {
    grid: &'a DensityGrid,
    ray: &'a LocalRay,
    /// What is left of the span, and the part of it that is in the grid's bounds.
    rest: Span,
    inside: Option<Span>,
    cell: Cell,
}

impl<'a> BlockWalk<'a> {
    pub(super) fn new(grid: &'a DensityGrid, ray: &'a LocalRay, span: Span) -> Self {
        let inside = match grid.is_empty() {
            true => None,
            false => ray.clip(span, grid.first, grid.last),
        };
        let cell = grid.cell_at(ray.at(inside.map_or(0.0, |inside| inside.start)));
        // Empty space of infinite length would make its optical depth 0 times infinity.
        let rest = Span::new(span.start, span.end.min(f64::MAX));
        Self { grid, ray, rest, inside, cell }
    }

    /// The part up to `end`, outside the grid.
    fn outside(&mut self, end: f64) -> Piece {
        let span = Span::new(self.rest.start, end);
        self.rest.start = end;
        Piece { span, entry: self.cell, lower: self.cell, content: Content::Uniform(0.0) }
    }

    /// The part in the block around the current cell; moves on to the next block's cell.
    #[inline]
    fn cross_block(&mut self, inside: Span) -> Piece {
        let block = self.grid.index.block_at(self.cell);
        let faces: [i64; 3] = std::array::from_fn(|axis| {
            if self.ray.ascends(axis) { block.upper[axis] } else { block.lower[axis] }
        });
        let (axis, crossing) =
            first_crossing(std::array::from_fn(|axis| self.ray.crossing(axis, faces[axis] as f64)));
        let entry = self.cell;
        let mut end = crossing.max(self.rest.start);
        let continues = end < inside.end && self.enter_next(&block, axis, end);
        if !continues {
            end = inside.end;
            self.inside = None;
        }
        let span = Span::new(self.rest.start, end);
        self.rest.start = end;
        Piece { span, entry, lower: block.lower, content: block.content }
    }

    /// Moves to the cell beyond the block's face on `axis`; `false` if that is out of bounds.
    #[inline]
    fn enter_next(&mut self, block: &Block, axis: usize, distance: f64) -> bool {
        let point = self.ray.at(distance);
        for (other, coordinate) in point.into_iter().enumerate() {
            // Rounding may put the point outside the block, or behind where the ray has been.
            let (low, high) = if self.ray.ascends(other) {
                (self.cell[other], block.upper[other] - 1)
            } else {
                (block.lower[other], self.cell[other])
            };
            self.cell[other] = (coordinate as i64).clamp(low, high);
        }
        if self.ray.ascends(axis) {
            self.cell[axis] = block.upper[axis];
            self.cell[axis] <= self.grid.last[axis]
        } else {
            self.cell[axis] = block.lower[axis] - 1;
            self.cell[axis] >= self.grid.first[axis]
        }
    }
}

impl Iterator for BlockWalk<'_> {
    type Item = Piece;

    #[inline]
    fn next(&mut self) -> Option<Piece> {
        match self.inside {
            Some(inside) if self.rest.start < inside.start => Some(self.outside(inside.start)),
            Some(inside) => Some(self.cross_block(inside)),
            None => (self.rest.start < self.rest.end).then(|| self.outside(self.rest.end)),
        }
    }
}

/// The axis of the least of three distances, and that distance.
#[inline(always)]
fn first_crossing(crossings: [f64; 3]) -> (usize, f64) {
    let [x, y, z] = crossings;
    // Written to compile without branches, which would be mispredicted.
    let (axis, least) = if y < x { (1, y) } else { (0, x) };
    if z < least { (2, z) } else { (axis, least) }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::{
        math::{Stream, uniform},
        medium::grid::test_grids::clumps,
    };

    /// Directions with every pattern of 0, -0, tiny and equal components.
    fn directions() -> Vec<[f64; 3]> {
        let parts = [0.0, -0.0, 1.0, -1.0, 1e-9, -1e-17, 1e-310, 0.3, -0.7];
        let mut directions = vec![];
        for x in parts {
            for y in parts {
                for z in parts {
                    if x * x + y * y + z * z > 1e-4 {
                        directions.push([x, y, z]);
                    }
                }
            }
        }
        directions
    }

    #[test]
    fn pieces_join_to_the_span_and_bound_what_they_cross() {
        let grid = clumps();
        let mut random = Stream::Experiment.random(5, 0);
        let center = -grid.local_origin();
        for direction in directions() {
            for snap in [1.0, 4.0, 1024.0] {
                // On corners and edges of bricks and cells, and between.
                let origin = std::array::from_fn(|axis| {
                    let offset = 60.0 * uniform(&mut random) - 30.0;
                    center[axis] + (offset * snap / 8.0).round() * 8.0 / snap
                });
                let ray = LocalRay::new(origin, direction);
                let span = Span::new(-70.0, 70.0);
                let (mut end, mut sum, mut piece_count) = (span.start, 0.0, 0);
                for piece in BlockWalk::new(&grid, &ray, span) {
                    assert_eq!(piece.span.start, end, "{origin:?} {direction:?}");
                    assert!(piece.span.end >= end);
                    end = piece.span.end;
                    sum += piece.span.length();
                    piece_count += 1;
                    let inner = piece.span.start + uniform(&mut random) * piece.span.length();
                    let density = grid.local_density(ray.at(inner));
                    assert!(density <= grid.majorant(&piece.content) + 1e-9);
                }
                assert_eq!(end, span.end);
                assert!((sum - span.length()).abs() < 1e-12 * span.length());
                assert!(piece_count <= 100, "{piece_count} {origin:?} {direction:?}");

                let (mut end, mut sum, mut cell_count) = (span.start, 0.0, 0);
                grid.for_each_cell(&ray, span, |piece| {
                    assert_eq!(piece.span.start, end);
                    end = piece.span.end;
                    sum += piece.span.length();
                    cell_count += 1;
                    for (u, value) in [0.0, 0.5, 1.0].into_iter().zip(piece.density.values()) {
                        let at = ray.at(piece.span.start + u * piece.span.length());
                        let density = grid.local_density(at);
                        assert!((density - value).abs() < 1e-9, "{origin:?} {direction:?} {u}");
                    }
                    ControlFlow::Continue(())
                });
                assert_eq!(end, span.end);
                assert!((sum - span.length()).abs() < 1e-12 * span.length());
                assert!(cell_count <= 250, "{cell_count} {origin:?} {direction:?}");
            }
        }
    }
}
