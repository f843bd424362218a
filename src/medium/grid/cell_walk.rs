//! Exact integrals along rays: one polynomial a voxel cell.
//!
//! tau = integral of the trilinear density. Bricks are walked cell by cell, the eight corners loaded once
//! a cell; uniform blocks, whatever their size, are one piece.

use std::ops::ControlFlow;

use super::{
    DensityGrid,
    block_walk::{BlockWalk, LocalRay, Piece},
    brick_atlas::{BRICK_EDGE, Brick, HalfValues, half_corners, single_corners},
    brick_index::{Cell, Content},
    cubic::Cubic,
    half_scale::HalfScale,
    trilinear::{Corners, along},
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
                    let lower = piece.lower.map(|c| c as f64);
                    let middle = ray.at(0.5 * (piece.span.start + piece.span.end));
                    visit(cell_piece(&corners, ray, piece.span, weight(middle, lower)))
                }
                Content::Brick(brick) => match self.atlas.brick(brick) {
                    Brick::Single(values) => {
                        let corners = |place| single_corners(values, place);
                        for_each_brick_cell(ray, &piece, corners, &mut visit)
                    }
                    Brick::Half(values, scale) => {
                        for_each_half_cell(ray, &piece, values, scale, &mut visit)
                    }
                },
            };
            if flow.is_break() {
                return;
            }
        }
    }
}

/// [`for_each_brick_cell`] of halves. Apart, so that walks through single bricks compile as if there were no others.
#[inline(never)]
fn for_each_half_cell(
    ray: &LocalRay,
    piece: &Piece,
    values: &HalfValues,
    scale: &HalfScale,
    visit: &mut impl FnMut(CellPiece) -> ControlFlow<()>,
) -> ControlFlow<()> {
    for_each_brick_cell(ray, piece, |place| half_corners(values, place, scale), visit)
}

/// Visits the cells of a brick along a piece of a ray; `corners` are those of the cell at a place in the brick.
#[inline(always)]
fn for_each_brick_cell(
    ray: &LocalRay,
    piece: &Piece,
    corners: impl Fn([usize; 3]) -> Corners,
    visit: &mut impl FnMut(CellPiece) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let mut buffer = [0.0; MAX_CROSSINGS];
    let ends = cell_ends(ray, piece, &mut buffer);
    let mut start = piece.span.start;
    for &end in ends {
        // Where rounding makes an empty piece of a corner there is nothing to integrate.
        if end <= start {
            continue;
        }
        let (place, weight) = place_in_brick(ray, piece.lower, 0.5 * (start + end));
        visit(cell_piece(&corners(place), ray, Span::new(start, end), weight))?;
        start = end;
    }
    ControlFlow::Continue(())
}

/// A line crosses at most 7 planes between the cells of a brick on each axis, and then leaves it.
const MAX_CROSSINGS: usize = 3 * (BRICK_EDGE - 1) + 1;

/// Where a ray leaves the cells of a brick it crosses, in order. Finding all distances before any density keeps
/// the mispredicted branches of the former from delaying the loads of the latter; adding up distances between
/// planes is off by a few roundings, which moves the joints between polynomials that agree there.
#[inline(always)]
fn cell_ends<'a>(ray: &LocalRay, piece: &Piece, ends: &'a mut [f64; MAX_CROSSINGS]) -> &'a [f64] {
    let Span { start, end } = piece.span;
    let [mut x, mut y, mut z]: [f64; 3] = std::array::from_fn(|axis| {
        ray.crossing(axis, (piece.entry[axis] + i64::from(ray.ascends(axis))) as f64)
    });
    let [step_x, step_y, step_z] = ray.plane_distances();
    // What is nearer to the end than this is the face the ray leaves the brick by.
    let last = end - 1e-9 * (end - start);
    let mut count = 0;
    while count < MAX_CROSSINGS - 1 {
        let first = if x < y { x } else { y };
        let first = if z < first { z } else { first };
        if first >= last {
            break;
        }
        ends[count] = if first > start { first } else { start };
        count += 1;
        x += if x <= first { step_x } else { 0.0 };
        y += if y <= first { step_y } else { 0.0 };
        z += if z <= first { step_z } else { 0.0 };
    }
    ends[count] = end;
    &ends[..=count]
}

/// The cell of a brick that holds a distance which is not on a face, and the place in the cell.
#[inline(always)]
fn place_in_brick(ray: &LocalRay, lower: Cell, distance: f64) -> ([usize; 3], [f64; 3]) {
    /// Adding it rounds to an integer, which is then in the low bits.
    const ROUNDER: f64 = (1_u64 << 52) as f64;
    const LAST: f64 = (BRICK_EDGE - 1) as f64;
    let point = weight(ray.at(distance), lower.map(|c| c as f64));
    let rounded = point.map(|place| {
        let place = if place > 0.5 { place - 0.5 } else { 0.0 };
        (if place < LAST { place } else { LAST }) + ROUNDER
    });
    let cell = rounded.map(|c| c - ROUNDER);
    (rounded.map(|c| c.to_bits() as usize % BRICK_EDGE), weight(point, cell))
}

#[inline(always)]
fn cell_piece(corners: &Corners, ray: &LocalRay, span: Span, middle: [f64; 3]) -> CellPiece {
    let half = ray.displacement(0.5 * span.length());
    CellPiece { span, density: along(corners, middle, half) }
}

#[inline(always)]
fn weight(point: [f64; 3], cell: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| point[axis] - cell[axis])
}
