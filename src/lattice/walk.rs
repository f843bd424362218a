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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Random, Stream, uniform};
    use crate::medium::Bounds;

    fn place(random: &mut Random) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| uniform(random)))
    }

    /// The pieces join to the span, and each lies in its cell: also along faces and edges, through corners and with -0.
    #[test]
    fn pieces_join_and_lie_in_their_cells() {
        let bounds =
            Bounds::Box { min: DVec3::new(-1.0, 2.0, 0.0), max: DVec3::new(1.0, 3.5, 1.0) };
        let shape = LatticeShape::new(&bounds, 10).unwrap();
        let [width, height, _] = shape.counts();
        let mut random = Stream::Experiment.random(3, 1);
        for case in 0..4000 {
            let (mut a, b) = (place(&mut random), place(&mut random));
            let mut direction = b - a;
            if case % 3 == 0 {
                // On faces and corners of cells.
                a = (a * 10.0).round() * 0.1;
            }
            if case % 4 == 0 {
                direction[case % 3] = [0.0, -0.0, 1e-300][case / 4 % 3];
                direction[(case + 1) % 3] = if case % 8 == 0 { 0.0 } else { 1.0 };
            }
            let Some(direction) = direction.try_normalize() else { continue };
            let ray =
                Ray::new(DVec3::new(-1.0, 2.0, 0.0) + a * DVec3::new(2.0, 1.5, 1.0), direction);
            let Some(span) = bounds.intersect(&ray) else { continue };
            let mut end = span.start;
            walk_cells(&shape, &ray, span, |cell, enters, leaves| {
                assert_eq!(enters, end);
                assert!(leaves >= enters);
                end = leaves;
                let middle = shape.point(ray.at(0.5 * (enters + leaves)));
                let corner = [cell % width, cell / width % height, cell / width / height];
                for axis in 0..3 {
                    let within = middle[axis] - corner[axis] as f64;
                    assert!((-1e-9..=1.0 + 1e-9).contains(&within), "{ray:?} {middle} {corner:?}");
                }
            });
            assert_eq!(end, span.end, "{ray:?}");
        }
    }
}
