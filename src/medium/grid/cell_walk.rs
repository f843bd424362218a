//! Exact integrals along rays: one polynomial a voxel cell.
//!
//! tau = integral of the trilinear density. Bricks are walked cell by cell, the eight corners loaded once
//! a cell; uniform blocks, whatever their size, are one piece.

use std::ops::ControlFlow;

use super::{
    DensityGrid,
    block_walk::{BlockWalk, LocalRay, Piece, first_crossing},
    brick_atlas::BRICK_EDGE,
    brick_index::{Cell, Content},
    cubic::Cubic,
    trilinear::{Corners, blend, triple_coefficient},
};
use crate::math::Span;

/// A part of a ray along which the density is one polynomial.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellPiece {
    pub(super) span: Span,
    pub(super) density: Cubic,
}

impl CellPiece {
    /// Integral of the density over the piece.
    #[inline(always)]
    pub(super) fn depth(&self) -> f64 {
        self.density.integral() * self.span.length()
    }
}

impl DensityGrid {
    /// Integral of the density over a span of a ray.
    pub(super) fn depth(&self, ray: &LocalRay, span: Span) -> f64 {
        let mut depth = 0.0;
        self.for_each_cell(ray, span, |piece| {
            depth += piece.depth();
            ControlFlow::Continue(())
        });
        depth
    }

    /// The distance at which the integral of the density reaches `target`; `None` if it does not in the span.
    pub(super) fn distance_at_depth(&self, ray: &LocalRay, span: Span, target: f64) -> Option<f64> {
        let (mut depth, mut found) = (0.0, None);
        self.for_each_cell(ray, span, |piece| {
            let depth_before = depth;
            depth += piece.depth();
            if depth <= target {
                return ControlFlow::Continue(());
            }
            let length = piece.span.length();
            let u = piece.density.invert((target - depth_before) / length);
            found = Some((piece.span.start + u * length).min(piece.span.end));
            ControlFlow::Break(())
        });
        found
    }

    /// Visits the pieces of a span in order, without gaps, until the visitor breaks.
    #[inline(always)]
    pub(super) fn for_each_cell(
        &self,
        ray: &LocalRay,
        span: Span,
        mut visit: impl FnMut(CellPiece) -> ControlFlow<()>,
    ) {
        for piece in BlockWalk::new(self, ray, span) {
            let flow = match piece.content {
                Content::Uniform(density) => {
                    visit(CellPiece { span: piece.span, density: Cubic::constant(density) })
                }
                Content::Corners(corners) => {
                    let start = start_density(&corners, ray, piece.lower, piece.span.start);
                    visit(cell_piece(&corners, ray, piece.lower, piece.span, start))
                }
                Content::Brick(brick) => self.for_each_brick_cell(ray, &piece, brick, &mut visit),
            };
            if flow.is_break() {
                return;
            }
        }
    }

    #[inline(always)]
    fn for_each_brick_cell(
        &self,
        ray: &LocalRay,
        piece: &Piece,
        brick: usize,
        visit: &mut impl FnMut(CellPiece) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut cell = piece.entry;
        let mut start = piece.span.start;
        let mut density = None;
        let steps: [i64; 3] = std::array::from_fn(|axis| if ray.ascends(axis) { 1 } else { -1 });
        let far_side: [i64; 3] = std::array::from_fn(|axis| ray.ascends(axis).into());
        let exits: Cell = std::array::from_fn(|axis| {
            piece.lower[axis] + far_side[axis] * (BRICK_EDGE as i64 - 1)
        });
        let mut crossings: [f64; 3] =
            std::array::from_fn(|axis| ray.crossing(axis, cell[axis] + far_side[axis]));
        loop {
            let (axis, crossing) = first_crossing(crossings);
            let leaves = cell[axis] == exits[axis] || !(crossing < piece.span.end);
            let end = if leaves { piece.span.end } else { crossing.max(start) };
            if end > start {
                let place = cell.map(|c| c as usize % BRICK_EDGE);
                let corners = self.atlas.corners(brick, place);
                let first = density.unwrap_or_else(|| start_density(&corners, ray, cell, start));
                let part = cell_piece(&corners, ray, cell, Span::new(start, end), first);
                density = Some(part.density.values[2]);
                visit(part)?;
            }
            if leaves {
                return ControlFlow::Continue(());
            }
            start = end;
            cell[axis] += steps[axis];
            crossings[axis] = ray.crossing(axis, cell[axis] + far_side[axis]);
        }
    }
}

#[inline(always)]
fn start_density(corners: &Corners, ray: &LocalRay, cell: Cell, start: f64) -> f64 {
    blend(corners, weight(ray.at(start), cell)).max(0.0)
}

#[inline(always)]
fn cell_piece(corners: &Corners, ray: &LocalRay, cell: Cell, span: Span, start: f64) -> CellPiece {
    let middle = blend(corners, weight(ray.at(0.5 * (span.start + span.end)), cell)).max(0.0);
    let end = blend(corners, weight(ray.at(span.end), cell)).max(0.0);
    let [x, y, z] = ray.displacement(span.length());
    let third = triple_coefficient(corners) * x * y * z;
    CellPiece { span, density: Cubic { values: [start, middle, end], third } }
}

#[inline(always)]
fn weight(point: [f64; 3], cell: Cell) -> [f64; 3] {
    std::array::from_fn(|axis| point[axis] - cell[axis] as f64)
}
