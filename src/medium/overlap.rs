//! The part of a ball that lies inside a medium: its volume and its second moment, in closed form.
//!
//! A kernel that reaches over a face of the medium finds no photons there, and would read one half on a
//! face, one quarter on an edge and one eighth in a corner. Dividing by what lies inside cures that.
//!
//! For a box, inclusion and exclusion over the half spaces outside its faces leaves caps {x > a}, edges
//! {x > a, y > b} and corners {x > a, y > b, z > c} of the unit ball. By the divergence theorem with the
//! origin at the ball's centre, each has volume (S - sum a_i A_i) / 3 and second moment
//! (S - sum a_i (a_i^2 A_i + P_i)) / 5, where S is the spherical patch (its area by Gauss-Bonnet), A_i the area
//! of the planar face at distance a_i, and P_i that face's polar moment.

use std::f64::consts::PI;

use crate::math::{Ball, DVec3};

/// Integrals of a weight over the part of a ball inside a medium.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BallIntegral {
    /// Integral of the weight (for weight 1, the volume \[m^3\]).
    pub mass: f64,
    /// Integral of the weight times the squared distance from the centre over the squared radius.
    pub second_moment: f64,
}

impl BallIntegral {
    /// A whole ball of weight 1.
    #[inline]
    pub fn of_ball(radius: f64) -> Self {
        let mass = 4.0 / 3.0 * PI * radius * radius * radius;
        Self { mass, second_moment: 0.6 * mass }
    }

    /// Both integrals times `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        Self { mass: self.mass * factor, second_moment: self.second_moment * factor }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            second_moment: self.second_moment + other.second_moment,
        }
    }

    fn minus(self, other: Self) -> Self {
        self.plus(other.scaled(-1.0))
    }

    /// From the boundary terms of the divergence theorem.
    fn from_surface(patch: f64, faces: &[(f64, PlanarFace)]) -> Self {
        let (mut volume, mut moment) = (patch, patch);
        for &(distance, face) in faces {
            volume -= distance * face.area;
            moment -= distance * (distance * distance * face.area + face.polar_moment);
        }
        Self { mass: volume / 3.0, second_moment: moment / 5.0 }
    }
}

/// The part of `ball` inside an axis-aligned box.
pub fn ball_in_box(ball: Ball, min: DVec3, max: DVec3) -> BallIntegral {
    let low = (ball.center - min) / ball.radius;
    let high = (max - ball.center) / ball.radius;
    let whole = BallIntegral::of_ball(1.0);
    let volume_unit = ball.radius * ball.radius * ball.radius;
    if low.min_element() >= 1.0 && high.min_element() >= 1.0 {
        return whole.scaled(volume_unit);
    }
    let mut outside = BallIntegral::default();
    let sides = |axis: usize| [low[axis], high[axis]];
    for axis in 0..3 {
        for a in sides(axis) {
            outside = outside.plus(cap(a));
            for b in sides((axis + 1) % 3) {
                outside = outside.minus(edge(a, b));
                if axis == 0 {
                    for c in sides(2) {
                        outside = outside.plus(corner(a, b, c));
                    }
                }
            }
        }
    }
    let inside = whole.minus(outside).scaled(volume_unit);
    // Rounding may leave a trace of either sign where nothing is inside.
    BallIntegral { mass: inside.mass.max(0.0), second_moment: inside.second_moment.max(0.0) }
}

/// The part of `ball` inside another ball, by shells: the share of the sphere of radius s that is inside
/// is linear in (R^2 - d^2 - s^2) / s between the two tangent radii.
pub fn ball_in_ball(ball: Ball, other: Ball) -> BallIntegral {
    let unit = ball.radius;
    let distance = ball.center.distance(other.center) / unit;
    let radius = other.radius / unit;
    // The largest sphere about the ball's centre that is wholly inside the other ball.
    let inner = (radius - distance).clamp(0.0, 1.0);
    let first = (radius - distance).abs().min(1.0);
    let last = (radius + distance).min(1.0);
    let mut integral = BallIntegral::of_ball(inner);
    integral.second_moment = 0.8 * PI * inner.powi(5);
    if last > first && distance > 0.0 {
        let inverse = (radius * radius - distance * distance) / (2.0 * distance);
        let linear = -0.5 / distance;
        // Half of 4 pi s^n (1 + inverse / s + linear s), integrated from `first` to `last`.
        let power = |n: i32| (last.powi(n) - first.powi(n)) / f64::from(n);
        let shells =
            |n: i32| 2.0 * PI * (power(n + 1) + inverse * power(n) + linear * power(n + 2));
        integral.mass += shells(2);
        integral.second_moment += shells(4);
    }
    integral.scaled(unit * unit * unit)
}

/// {x > a} of the unit ball.
fn cap(a: f64) -> BallIntegral {
    if a >= 1.0 {
        return BallIntegral::default();
    }
    let a = a.max(-1.0);
    let height = 1.0 - a;
    let face_squared = height * (1.0 + a);
    let polar_moment = 0.5 * PI * face_squared * face_squared;
    let face = PlanarFace { area: PI * face_squared, polar_moment };
    BallIntegral::from_surface(2.0 * PI * height, &[(a, face)])
}

/// {x > a, y > b} of the unit ball.
fn edge(a: f64, b: f64) -> BallIntegral {
    if a < 0.0 {
        return cap(b).minus(edge(-a, b));
    }
    if b < 0.0 {
        return cap(a).minus(edge(a, -b));
    }
    if a * a + b * b >= 1.0 {
        return BallIntegral::default();
    }
    let (radius_a, radius_b) = (circle_radius(a), circle_radius(b));
    let angle = PI - acos(-a * b / (radius_a * radius_b));
    let (arc_a, arc_b) = (2.0 * acos(b / radius_a), 2.0 * acos(a / radius_b));
    let patch = 2.0 * angle - a * arc_a - b * arc_b;
    let faces = [(a, PlanarFace::segment(radius_a, b)), (b, PlanarFace::segment(radius_b, a))];
    BallIntegral::from_surface(patch, &faces)
}

/// {x > a, y > b, z > c} of the unit ball.
fn corner(a: f64, b: f64, c: f64) -> BallIntegral {
    if a < 0.0 {
        return edge(b, c).minus(corner(-a, b, c));
    }
    if b < 0.0 {
        return edge(a, c).minus(corner(a, -b, c));
    }
    if c < 0.0 {
        return edge(a, b).minus(corner(a, b, -c));
    }
    if a * a + b * b + c * c >= 1.0 {
        return BallIntegral::default();
    }
    let radii = [circle_radius(a), circle_radius(b), circle_radius(c)];
    let angle = |p: f64, q: f64, i: usize, j: usize| PI - acos(-p * q / (radii[i] * radii[j]));
    let angles = angle(a, b, 0, 1) + angle(b, c, 1, 2) + angle(a, c, 0, 2);
    let arc = |radius: f64, p: f64, q: f64| acos(p / radius) - asin(q / radius);
    let arcs = a * arc(radii[0], b, c) + b * arc(radii[1], a, c) + c * arc(radii[2], a, b);
    let faces = [
        (a, PlanarFace::quadrant(radii[0], b, c)),
        (b, PlanarFace::quadrant(radii[1], a, c)),
        (c, PlanarFace::quadrant(radii[2], a, b)),
    ];
    BallIntegral::from_surface(angles - PI - arcs, &faces)
}

/// Area of a flat piece of a disc about the disc's centre, and its integral of squared distance from it.
#[derive(Clone, Copy)]
struct PlanarFace {
    area: f64,
    polar_moment: f64,
}

impl PlanarFace {
    /// {y > b} of a disc, b >= 0.
    fn segment(radius: f64, b: f64) -> Self {
        let half = chord_half(radius, b);
        let angle = 2.0 * acos(b / radius);
        Self::from_boundary(radius, angle, &[(b, -half, half)])
    }

    /// {y > b, z > c} of a disc, b, c >= 0.
    fn quadrant(radius: f64, b: f64, c: f64) -> Self {
        if b * b + c * c >= radius * radius {
            return Self { area: 0.0, polar_moment: 0.0 };
        }
        let angle = acos(b / radius) - asin(c / radius);
        let sides = [(b, c, chord_half(radius, b)), (c, b, chord_half(radius, c))];
        Self::from_boundary(radius, angle, &sides)
    }

    /// The divergence theorem in the plane; each side is (distance, from, to) along its line.
    fn from_boundary(radius: f64, angle: f64, sides: &[(f64, f64, f64)]) -> Self {
        let square = radius * radius;
        let (mut area, mut moment) = (square * angle, square * square * angle);
        for &(distance, from, to) in sides {
            let length = to - from;
            let cubes = (to * to * to - from * from * from) / 3.0;
            area -= distance * length;
            moment -= distance * (distance * distance * length + cubes);
        }
        Self { area: 0.5 * area, polar_moment: 0.25 * moment }
    }
}

fn circle_radius(a: f64) -> f64 {
    ((1.0 - a) * (1.0 + a)).max(0.0).sqrt()
}

fn chord_half(radius: f64, b: f64) -> f64 {
    ((radius - b) * (radius + b)).max(0.0).sqrt()
}

fn acos(x: f64) -> f64 {
    x.clamp(-1.0, 1.0).acos()
}

fn asin(x: f64) -> f64 {
    x.clamp(-1.0, 1.0).asin()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Midpoint quadrature over the ball's bounding cube.
    fn by_quadrature(ball: Ball, inside: impl Fn(DVec3) -> bool) -> BallIntegral {
        let side = 160;
        let cell = 2.0 / f64::from(side);
        let at = |i: i32| -1.0 + (f64::from(i) + 0.5) * cell;
        let mut integral = BallIntegral::default();
        for x in 0..side {
            for y in 0..side {
                for z in 0..side {
                    let offset = DVec3::new(at(x), at(y), at(z));
                    let square = offset.length_squared();
                    if square <= 1.0 && inside(ball.center + offset * ball.radius) {
                        integral.mass += 1.0;
                        integral.second_moment += square;
                    }
                }
            }
        }
        integral.scaled((cell * ball.radius).powi(3))
    }

    fn assert_close(exact: BallIntegral, sum: BallIntegral, ball: Ball) {
        let tolerance = 1e-2 * ball.volume();
        assert!((exact.mass - sum.mass).abs() < tolerance, "{exact:?} {sum:?}");
        assert!((exact.second_moment - sum.second_moment).abs() < tolerance, "{exact:?} {sum:?}");
    }

    #[test]
    fn face_edge_and_corner_read_a_half_a_quarter_and_an_eighth() {
        let (min, max) = (DVec3::ZERO, DVec3::ONE);
        let whole = BallIntegral::of_ball(0.3);
        for (center, share) in [
            (DVec3::new(0.5, 0.5, 0.5), 1.0),
            (DVec3::new(0.0, 0.5, 0.5), 0.5),
            (DVec3::new(0.5, 1.0, 1.0), 0.25),
            (DVec3::new(0.0, 1.0, 0.0), 0.125),
        ] {
            let part = ball_in_box(Ball { center, radius: 0.3 }, min, max);
            assert!((part.mass - share * whole.mass).abs() < 1e-15, "{center}");
            assert!((part.second_moment - share * whole.second_moment).abs() < 1e-15, "{center}");
        }
    }

    #[test]
    fn a_ball_that_holds_the_box_sees_all_of_it() {
        let ball = Ball { center: DVec3::new(0.4, 0.5, 0.7), radius: 50.0 };
        let part = ball_in_box(ball, DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
        assert!((part.mass - 6.0).abs() < 1e-8, "{part:?}");
    }

    #[test]
    fn a_flat_box_holds_nothing() {
        let ball = Ball { center: DVec3::splat(0.5), radius: 0.4 };
        let flat = ball_in_box(ball, DVec3::new(0.0, 0.0, 0.5), DVec3::new(1.0, 1.0, 0.5));
        assert!(flat.mass.abs() < 1e-15);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn box_overlap_equals_quadrature(
            center in prop::array::uniform3(-0.4f64..1.4), size in prop::array::uniform3(0.2f64..1.5),
            radius in 0.05f64..1.2,
        ) {
            let ball = Ball { center: DVec3::from_array(center), radius };
            let max = DVec3::from_array(size);
            let sum = by_quadrature(ball, |p| p.cmpge(DVec3::ZERO).all() && p.cmple(max).all());
            assert_close(ball_in_box(ball, DVec3::ZERO, max), sum, ball);
        }

        #[test]
        fn ball_overlap_equals_quadrature(
            center in prop::array::uniform3(-1.2f64..1.2), radius in 0.05f64..2.5,
        ) {
            let ball = Ball { center: DVec3::from_array(center), radius };
            let other = Ball { center: DVec3::ZERO, radius: 1.0 };
            let sum = by_quadrature(ball, |p| p.length_squared() <= 1.0);
            assert_close(ball_in_ball(ball, other), sum, ball);
        }
    }
}
