//! The region a medium fills: where rays enter and leave it, and how much of a ball lies inside.

use crate::math::{Ball, DMat3, DVec3, Ray, Span};
use crate::medium::overlap::{BallIntegral, ball_in_ball, ball_in_box};

/// The region a medium fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    /// Axis-aligned box.
    Box {
        /// Lowest corner \[m\].
        min: DVec3,
        /// Highest corner \[m\].
        max: DVec3,
    },
    /// Ball.
    Sphere {
        /// Centre \[m\].
        center: DVec3,
        /// Radius \[m\].
        radius: f64,
    },
    /// A box carried through an affine map: the bounds of a grid in world space.
    Parallelepiped(Parallelepiped),
    /// Everywhere (lab only).
    Infinite,
}

/// The part of a ray that starts with it.
const AHEAD: Span = Span { start: 0.0, end: f64::INFINITY };

/// The points `corner + a edges[0] + b edges[1] + c edges[2]` with a, b, c in \[0, 1\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallelepiped {
    corner: DVec3,
    edges: [DVec3; 3],
    /// From offsets to (a, b, c).
    inverse: DMat3,
}

impl Bounds {
    /// The part of the ray inside, from distance 0 on; `None` where the ray misses.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Span> {
        match self {
            Self::Box { min, max } => slabs(ray.origin, ray.direction, *min, *max),
            _ => self.intersect_others(ray),
        }
    }

    /// Apart, so that boxes compile as if there were no others.
    #[inline(never)]
    fn intersect_others(&self, ray: &Ray) -> Option<Span> {
        match *self {
            Self::Box { min, max } => slabs(ray.origin, ray.direction, min, max),
            Self::Sphere { center, radius } => sphere_chord(ray, center, radius)?.intersect(AHEAD),
            Self::Parallelepiped(shape) => {
                let origin = shape.inverse * (ray.origin - shape.corner);
                let direction = shape.inverse * ray.direction;
                slabs(origin, direction, DVec3::ZERO, DVec3::ONE)
            }
            Self::Infinite => Some(AHEAD),
        }
    }

    /// Whether the point is inside; faces count as inside.
    pub fn contains(&self, point: DVec3) -> bool {
        match *self {
            Self::Box { min, max } => point.cmpge(min).all() && point.cmple(max).all(),
            Self::Sphere { center, radius } => point.distance_squared(center) <= radius * radius,
            Self::Parallelepiped(shape) => {
                let local = shape.inverse * (point - shape.corner);
                local.cmpge(DVec3::ZERO).all() && local.cmple(DVec3::ONE).all()
            }
            Self::Infinite => true,
        }
    }

    /// Whether a ball is wholly inside. Parallelepipeds, which only bound a grid, do not know.
    #[inline]
    pub fn holds(&self, ball: Ball) -> bool {
        match *self {
            Self::Box { min, max } => {
                let reach = DVec3::splat(ball.radius);
                (ball.center - reach).cmpge(min).all() && (ball.center + reach).cmple(max).all()
            }
            Self::Sphere { center, radius } => ball.center.distance(center) + ball.radius <= radius,
            Self::Parallelepiped(_) => false,
            Self::Infinite => true,
        }
    }

    /// The smallest ball about the centre that holds the region; `None` if infinite.
    pub fn enclosing_ball(&self) -> Option<Ball> {
        match *self {
            Self::Box { min, max } => {
                Some(Ball { center: 0.5 * (min + max), radius: 0.5 * (max - min).length() })
            }
            Self::Sphere { center, radius } => Some(Ball { center, radius }),
            Self::Parallelepiped(shape) => {
                let [a, b, c] = shape.edges;
                let diagonals = [a + b + c, a + b - c, a - b + c, b + c - a];
                let longest = diagonals.iter().map(|d| d.length()).fold(0.0, f64::max);
                Some(Ball { center: shape.corner + 0.5 * diagonals[0], radius: 0.5 * longest })
            }
            Self::Infinite => None,
        }
    }

    /// Lowest and highest corner of the axis-aligned box about the region \[m\]; `None` if infinite.
    pub fn extent(&self) -> Option<(DVec3, DVec3)> {
        match *self {
            Self::Box { min, max } => Some((min, max)),
            Self::Sphere { center, radius } => {
                Some((center - DVec3::splat(radius), center + DVec3::splat(radius)))
            }
            Self::Parallelepiped(shape) => {
                let [low, high] = [DVec3::min, DVec3::max].map(|choose| {
                    let edges = shape.edges.iter().map(|edge| choose(*edge, DVec3::ZERO));
                    shape.corner + edges.sum::<DVec3>()
                });
                Some((low, high))
            }
            Self::Infinite => None,
        }
    }

    /// The box as a parallelepiped; `None` for round and infinite regions.
    pub fn parallelepiped(&self) -> Option<Parallelepiped> {
        match *self {
            Self::Box { min, max } => {
                let size = max - min;
                let edges = [DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z];
                Some(Parallelepiped::new(min, edges))
            }
            Self::Parallelepiped(shape) => Some(shape),
            Self::Sphere { .. } | Self::Infinite => None,
        }
    }

    /// Volume \[m^3\] and, about the ball's centre, second moment of the part of a ball inside. Exact for
    /// boxes and spheres; a parallelepiped, which only bounds a grid, counts the whole ball.
    #[inline]
    pub fn overlap(&self, ball: Ball) -> BallIntegral {
        match *self {
            Self::Box { min, max } => ball_in_box(ball, min, max),
            Self::Sphere { center, radius } => ball_in_ball(ball, Ball { center, radius }),
            Self::Parallelepiped(_) | Self::Infinite => BallIntegral::of_ball(ball.radius),
        }
    }
}

impl Parallelepiped {
    /// The parallelepiped with one corner and the three edges that leave it \[m\], linearly independent.
    pub fn new(corner: DVec3, edges: [DVec3; 3]) -> Self {
        let inverse = DMat3::from_cols(edges[0], edges[1], edges[2]).inverse();
        Self { corner, edges, inverse }
    }

    /// One corner \[m\].
    pub fn corner(&self) -> DVec3 {
        self.corner
    }

    /// The three edges that leave that corner \[m\].
    pub fn edges(&self) -> [DVec3; 3] {
        self.edges
    }

    /// The six faces.
    pub fn faces(&self) -> [Face; 6] {
        let handedness = self.edges[0].cross(self.edges[1]).dot(self.edges[2]).signum();
        std::array::from_fn(|i| {
            let axis = i / 2;
            let (u, v) = (self.edges[(axis + 1) % 3], self.edges[(axis + 2) % 3]);
            let far = i % 2 == 1;
            let side = if far { handedness } else { -handedness };
            Face {
                corner: if far { self.corner + self.edges[axis] } else { self.corner },
                edges: [u, v],
                area_normal: u.cross(v) * side,
            }
        })
    }
}

/// One face of a [`Parallelepiped`].
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// One corner \[m\].
    pub corner: DVec3,
    /// The edges that leave it \[m\].
    pub edges: [DVec3; 2],
    /// Outward normal, as long as the face's area \[m^2\].
    pub area_normal: DVec3,
}

/// The distances at which a half line crosses an axis-aligned box.
#[inline]
fn slabs(origin: DVec3, direction: DVec3, min: DVec3, max: DVec3) -> Option<Span> {
    let inverse = direction.recip();
    if !inverse.is_finite() {
        return slabs_with_parallels(origin, direction, min, max);
    }
    // By the sign, not by size: a box turned inside out is empty.
    let ascends = direction.cmpgt(DVec3::ZERO);
    let near = (DVec3::select(ascends, min, max) - origin) * inverse;
    let far = (DVec3::select(ascends, max, min) - origin) * inverse;
    let span = Span::new(near.max_element().max(0.0), far.min_element());
    (span.end > span.start).then_some(span)
}

/// The same where the line may be parallel to faces. A component of the direction that is 0 (or -0) is decided by
/// comparison: 0 times infinity must not arise.
#[cold]
fn slabs_with_parallels(origin: DVec3, direction: DVec3, min: DVec3, max: DVec3) -> Option<Span> {
    let mut span = AHEAD;
    for axis in 0..3 {
        let inverse = 1.0 / direction[axis];
        if !inverse.is_finite() {
            if origin[axis] < min[axis] || origin[axis] > max[axis] {
                return None;
            }
            continue;
        }
        let inverse = 1.0 / direction[axis];
        // By the sign, not by size: a box turned inside out is empty.
        let (near, far) = if inverse > 0.0 { (min, max) } else { (max, min) };
        let enter = (near[axis] - origin[axis]) * inverse;
        span = span.intersect(Span::new(enter, (far[axis] - origin[axis]) * inverse))?;
    }
    Some(span)
}

/// The chord of a line through a sphere, from the point of the line nearest to the centre: no
/// cancellation for a far origin.
fn sphere_chord(ray: &Ray, center: DVec3, radius: f64) -> Option<Span> {
    let to_center = center - ray.origin;
    let nearest = to_center.dot(ray.direction);
    let offset = to_center - ray.direction * nearest;
    let half_squared = radius * radius - offset.length_squared();
    if half_squared <= 0.0 {
        return None;
    }
    let half = half_squared.sqrt();
    Some(Span::new(nearest - half, nearest + half))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_parallel_and_negative_zero_directions() {
        let unit = Bounds::Box { min: DVec3::ZERO, max: DVec3::ONE };
        for zero in [0.0, -0.0] {
            let ray = |origin| Ray::new(origin, DVec3::new(1.0, zero, zero));
            let inside = unit.intersect(&ray(DVec3::new(-1.0, 0.5, 0.5)));
            assert_eq!(inside, Some(Span::new(1.0, 2.0)));
            assert_eq!(unit.intersect(&ray(DVec3::new(-1.0, 1.0, 0.0))), inside, "along an edge");
            assert_eq!(unit.intersect(&ray(DVec3::new(-1.0, 1.1, 0.5))), None);
            assert_eq!(unit.intersect(&ray(DVec3::new(2.0, 0.5, 0.5))), None, "behind");
        }
    }

    #[test]
    fn camera_inside_starts_at_zero() {
        let sphere = Bounds::Sphere { center: DVec3::ZERO, radius: 2.0 };
        let span = sphere.intersect(&Ray::new(DVec3::X, DVec3::X));
        assert_eq!(span, Some(Span::new(0.0, 1.0)));
    }

    #[test]
    fn a_sheared_box_agrees_with_its_faces() {
        let edges =
            [DVec3::new(2.0, 0.1, 0.0), DVec3::new(0.5, -1.0, 0.2), DVec3::new(0.0, 0.3, 1.5)];
        let shape = Parallelepiped::new(DVec3::new(1.0, 2.0, 3.0), edges);
        let bounds = Bounds::Parallelepiped(shape);
        let faces = shape.faces();
        let closed: DVec3 = faces.iter().map(|f| f.area_normal).sum();
        assert!(closed.length() < 1e-12, "a closed surface has no net area: {closed}");
        let center = bounds.enclosing_ball().map(|b| b.center).unwrap();
        for face in faces {
            let middle = face.corner + 0.5 * (face.edges[0] + face.edges[1]);
            assert!(face.area_normal.dot(middle - center) > 0.0, "normals point outward");
            let direction = (middle - center).normalize();
            let span = bounds.intersect(&Ray::new(center, direction)).unwrap();
            assert!((span.end - (middle - center).length()).abs() < 1e-12);
            assert!(bounds.contains(center + direction * (span.end * 0.999)));
            assert!(!bounds.contains(center + direction * (span.end * 1.001)));
        }
    }
}
