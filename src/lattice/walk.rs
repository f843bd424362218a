//! The cells that a piece of a ray crosses.

use crate::lattice::LatticeShape;
use crate::math::{DVec3, Ray, Span};

/// Calls `visit` with each cell (its index, x fastest) that `span` of a ray crosses, and the distances at which it enters
/// and leaves \[m\]. Amanatides and Woo, *A Fast Voxel Traversal Algorithm for Ray Tracing*, Eurographics 1987.
#[inline]
pub fn walk_cells(
    shape: &LatticeShape,
    ray: &Ray,
    span: Span,
    mut visit: impl FnMut(usize, f64, f64),
) {
    let counts = shape.counts();
    let strides = [1, counts[0] as isize, (counts[0] * counts[1]) as isize];
    let origin: DVec3 = shape.point(ray.origin);
    let direction = shape.displacement(ray.direction);
    let start = origin + direction * span.start;
    let (mut next, mut step, mut advance) = ([f64::INFINITY; 3], [0.0; 3], [0isize; 3]);
    // Cells left to cross along each axis before the lattice ends: rounding must not leave it.
    let mut left = [0usize; 3];
    let mut index = 0isize;
    for axis in 0..3 {
        let cell = (start[axis] as isize).clamp(0, counts[axis] as isize - 1);
        index += cell * strides[axis];
        let inverse = 1.0 / direction[axis];
        if !inverse.is_finite() {
            continue;
        }
        let ascends = direction[axis] > 0.0;
        let face = (cell + isize::from(ascends)) as f64;
        next[axis] = (face - origin[axis]) * inverse;
        step[axis] = inverse.abs();
        advance[axis] = if ascends { strides[axis] } else { -strides[axis] };
        left[axis] = if ascends { counts[axis] - 1 - cell as usize } else { cell as usize };
    }
    let mut entered = span.start;
    loop {
        let axis = if next[0] < next[1] {
            if next[0] < next[2] { 0 } else { 2 }
        } else if next[1] < next[2] {
            1
        } else {
            2
        };
        let leaves = next[axis];
        if leaves >= span.end || left[axis] == 0 {
            visit(index as usize, entered, span.end);
            return;
        }
        if leaves > entered {
            visit(index as usize, entered, leaves);
            entered = leaves;
        }
        index += advance[axis];
        next[axis] += step[axis];
        left[axis] -= 1;
    }
}
