//! Aiming at the medium: directions from a point that meet its bounds, and places on its outline as
//! parallel light sees it. What is sampled here meets the medium always, so that no photon is wasted.

use std::f64::consts::PI;

use crate::math::square_maps::{cap_solid_angle, disc_to_cap, square_to_disc, square_to_sphere};
use crate::math::{DVec2, DVec3, Frame, SphericalTriangle};
use crate::medium::{Bounds, Face};

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct AimedDirection {
    /// Unit direction from the point into the bounds.
    pub direction: DVec3,
    /// Its density's inverse \[sr\]: what an intensity is multiplied by to give the photon's power.
    pub solid_angle: f64,
}

/// The directions from one point that meet the bounds.
#[derive(Clone, Debug)]
pub enum DirectionAim {
    /// The point is inside: all directions.
    All,
    /// A cone about `frame.axis`, towards a ball outside of which the point lies.
    Cone {
        /// Axis towards the ball.
        frame: Frame,
        /// 1 - cos of the half-angle.
        versine: f64,
    },
    /// Triangles of directions: the visible faces of a box, nearby.
    Triangles {
        /// Up to six.
        triangles: Vec<SphericalTriangle>,
        /// Sum over them \[sr\].
        solid_angle: f64,
    },
    /// Points on the visible faces of a far box, where triangles of directions lose their digits and the
    /// inverse density hardly varies.
    FarFaces {
        /// The point.
        eye: DVec3,
        /// The faces.
        faces: FaceChoice,
        /// Sum over triangles \[sr\].
        solid_angle: f64,
    },
}

/// Below this solid angle \[sr\] a box is far: its faces then differ by a per cent in distance and slant.
const FAR_SOLID_ANGLE: f64 = 1e-3;

impl DirectionAim {
    /// The directions from `eye` into `bounds`.
    pub fn new(eye: DVec3, bounds: &Bounds) -> Self {
        if bounds.contains(eye) {
            return Self::All;
        }
        if let Bounds::Sphere { center, radius } = *bounds {
            let to_center = center - eye;
            let sine_squared = (radius * radius / to_center.length_squared()).min(1.0);
            let versine = sine_squared / (1.0 + (1.0 - sine_squared).sqrt());
            return Self::Cone { frame: Frame::about(to_center.normalize()), versine };
        }
        let Some(shape) = bounds.parallelepiped() else { return Self::All };
        let visible = shape.faces().into_iter().filter(|f| f.area_normal.dot(eye - f.corner) > 0.0);
        let faces: Vec<Face> = visible.collect();
        let triangles: Vec<SphericalTriangle> = faces
            .iter()
            .flat_map(|face| {
                let [u, v] = face.edges;
                let (p, q) = (face.corner + u, face.corner + v);
                [[face.corner, p, q], [p + v, q, p]]
            })
            .filter_map(|corners| SphericalTriangle::seen_from(eye, corners))
            .collect();
        let solid_angle = triangles.iter().map(|t| t.solid_angle).sum();
        if solid_angle >= FAR_SOLID_ANGLE {
            return Self::Triangles { triangles, solid_angle };
        }
        let weight = |face: &Face| {
            let offset = face.corner + 0.5 * (face.edges[0] + face.edges[1]) - eye;
            -face.area_normal.dot(offset.normalize()) / offset.length_squared()
        };
        Self::FarFaces { eye, faces: FaceChoice::new(faces, weight), solid_angle }
    }

    /// The solid angle of all directions \[sr\].
    pub fn solid_angle(&self) -> f64 {
        match self {
            Self::All => 4.0 * PI,
            Self::Cone { versine, .. } => cap_solid_angle(*versine),
            Self::Triangles { solid_angle, .. } | Self::FarFaces { solid_angle, .. } => {
                *solid_angle
            }
        }
    }

    /// The direction at `u` in the unit square; `None` only where the bounds have no extent.
    pub fn sample_direction(&self, u: DVec2) -> Option<AimedDirection> {
        match self {
            Self::All => {
                Some(AimedDirection { direction: square_to_sphere(u), solid_angle: 4.0 * PI })
            }
            Self::Cone { frame, versine } => {
                let (local, _) = disc_to_cap(square_to_disc(u), *versine);
                let solid_angle = cap_solid_angle(*versine);
                Some(AimedDirection { direction: frame.to_world(local).normalize(), solid_angle })
            }
            Self::Triangles { triangles, solid_angle } => {
                let mut position = u.x * solid_angle;
                let last = triangles.last()?;
                for triangle in triangles {
                    if position < triangle.solid_angle {
                        let within = DVec2::new(position / triangle.solid_angle, u.y);
                        let direction = triangle.direction(within);
                        return Some(AimedDirection { direction, solid_angle: *solid_angle });
                    }
                    position -= triangle.solid_angle;
                }
                let direction = last.direction(DVec2::new(1.0, u.y));
                Some(AimedDirection { direction, solid_angle: *solid_angle })
            }
            Self::FarFaces { eye, faces, .. } => {
                let place = faces.sample_place(u)?;
                let offset = place.position - *eye;
                let direction = offset.normalize();
                let projected = -place.face.area_normal.dot(direction) / place.probability;
                Some(AimedDirection { direction, solid_angle: projected / offset.length_squared() })
            }
        }
    }
}

/// A place on the bounds as parallel light sees them.
#[derive(Clone, Copy, Debug)]
pub struct AimedPlace {
    /// On the bounds' surface \[m\].
    pub position: DVec3,
    /// The projected area of the bounds \[m^2\].
    pub area: f64,
}

/// The outline of the bounds for parallel light of one direction.
#[derive(Clone, Debug)]
pub enum OutlineAim {
    /// A disc through the centre.
    Disc {
        /// Axis along the light.
        frame: Frame,
        /// \[m\]
        center: DVec3,
        /// \[m\]
        radius: f64,
    },
    /// The lit faces of a box, each by its projected area.
    Faces(FaceChoice),
}

impl OutlineAim {
    /// The outline for light that travels in `direction`; `None` for infinite bounds.
    pub fn new(direction: DVec3, bounds: &Bounds) -> Option<Self> {
        if let Bounds::Sphere { center, radius } = *bounds {
            return Some(Self::Disc { frame: Frame::about(direction), center, radius });
        }
        let shape = bounds.parallelepiped()?;
        let lit = shape.faces().into_iter().filter(|f| f.area_normal.dot(direction) < 0.0);
        Some(Self::Faces(FaceChoice::new(lit.collect(), |f| -f.area_normal.dot(direction))))
    }

    /// The projected area \[m^2\].
    pub fn area(&self) -> f64 {
        match self {
            Self::Disc { radius, .. } => PI * radius * radius,
            Self::Faces(faces) => faces.total,
        }
    }

    /// The place at `u` in the unit square, uniform over the outline.
    pub fn sample_place(&self, u: DVec2) -> Option<AimedPlace> {
        let area = self.area();
        match self {
            Self::Disc { frame, center, radius } => {
                let disc = square_to_disc(u) * *radius;
                Some(AimedPlace { position: *center + frame.to_world(disc.extend(0.0)), area })
            }
            Self::Faces(faces) => {
                faces.sample_place(u).map(|place| AimedPlace { position: place.position, area })
            }
        }
    }
}

/// Faces chosen in proportion to a weight, and uniform places on them.
#[derive(Clone, Debug)]
pub struct FaceChoice {
    faces: Vec<(Face, f64)>,
    /// Sum of the weights.
    pub total: f64,
}

/// A place on a face.
#[derive(Clone, Copy, Debug)]
pub struct FacePlace {
    /// \[m\]
    pub position: DVec3,
    /// The face it is on.
    pub face: Face,
    /// With which the face was chosen.
    pub probability: f64,
}

impl FaceChoice {
    /// Faces by weight; those of no weight are dropped.
    pub fn new(faces: Vec<Face>, weight: impl Fn(&Face) -> f64) -> Self {
        let weighted = faces.into_iter().map(|f| (f, weight(&f)));
        let faces: Vec<(Face, f64)> = weighted.filter(|(_, w)| *w > 0.0).collect();
        let total = faces.iter().map(|(_, w)| w).sum();
        Self { faces, total }
    }

    /// The place at `u`: its first coordinate chooses the face and is used again within it.
    pub fn sample_place(&self, u: DVec2) -> Option<FacePlace> {
        let mut position = u.x * self.total;
        let last = self.faces.len().checked_sub(1)?;
        for (index, (face, weight)) in self.faces.iter().enumerate() {
            if position < *weight || index == last {
                let along = (position / weight).min(1.0);
                let place = face.corner + face.edges[0] * along + face.edges[1] * u.y;
                let probability = weight / self.total;
                return Some(FacePlace { position: place, face: *face, probability });
            }
            position -= weight;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Ray;

    const BOX: Bounds = Bounds::Box { min: DVec3::NEG_ONE, max: DVec3::new(1.0, 2.0, 0.5) };
    const BALL: Bounds = Bounds::Sphere { center: DVec3::new(0.2, 0.1, 0.0), radius: 0.7 };

    fn grid(side: usize) -> impl Iterator<Item = DVec2> {
        let at = move |i: usize| (i as f64 + 0.5) / side as f64;
        (0..side * side).map(move |i| DVec2::new(at(i / side), at(i % side)))
    }

    /// The solid angle of the bounds by uniform directions, and no aimed direction that misses.
    #[test]
    fn aimed_directions_all_hit_and_cover_the_solid_angle() {
        for bounds in [BOX, BALL] {
            for eye in
                [DVec3::new(3.0, 0.4, 0.1), DVec3::new(-4.0, 5.0, 6.0), DVec3::new(0.0, 0.0, 9.0)]
            {
                let aim = DirectionAim::new(eye, &bounds);
                let hits = grid(1000)
                    .filter(|&u| bounds.intersect(&Ray::new(eye, square_to_sphere(u))).is_some());
                let by_counting = hits.count() as f64 / 1e6 * 4.0 * PI;
                let ratio = aim.solid_angle() / by_counting;
                assert!((ratio - 1.0).abs() < 1e-2, "{bounds:?} from {eye}: {ratio}");
                for u in grid(40) {
                    let sample = aim.sample_direction(u).unwrap();
                    assert!(bounds.intersect(&Ray::new(eye, sample.direction)).is_some());
                }
            }
        }
    }

    #[test]
    fn far_faces_give_the_same_solid_angle_and_hit() {
        for scale in [1e2, 1e6, 1e12] {
            let eye = DVec3::new(0.3, -0.5, 0.8) * scale;
            let aim = DirectionAim::new(eye, &BOX);
            assert!(matches!(aim, DirectionAim::FarFaces { .. }));
            let samples: Vec<AimedDirection> =
                grid(64).filter_map(|u| aim.sample_direction(u)).collect();
            let mean = samples.iter().map(|s| s.solid_angle).sum::<f64>() / samples.len() as f64;
            let direction = -eye.normalize();
            let outline = OutlineAim::new(direction, &BOX).unwrap().area();
            let ratio = mean * eye.length_squared() / outline;
            assert!((ratio - 1.0).abs() < 1e-2 + 3.0 / scale, "{scale}: {ratio}");
            let hits = samples
                .iter()
                .filter(|s| scale > 1e8 || BOX.intersect(&Ray::new(eye, s.direction)).is_some());
            assert_eq!(hits.count(), samples.len());
        }
    }

    #[test]
    fn outlines_have_the_projected_area() {
        let direction = DVec3::new(0.6, -0.48, 0.64);
        let sides = DVec3::new(2.0, 3.0, 1.5);
        let exact = 0.6 * sides.y * sides.z + 0.48 * sides.x * sides.z + 0.64 * sides.x * sides.y;
        let area = OutlineAim::new(direction, &BOX).unwrap().area();
        assert!((area - exact).abs() < 1e-12);
        assert!((OutlineAim::new(direction, &BALL).unwrap().area() - PI * 0.49).abs() < 1e-12);
    }
}
