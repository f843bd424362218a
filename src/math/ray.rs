//! Rays, parts of rays, balls and orthonormal frames, in world space.

use glam::DVec3;

/// A half line. Distances along it are in the units of `direction`, which is unit length in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start, world space \[m\].
    pub origin: DVec3,
    /// Direction, unit length.
    pub direction: DVec3,
}

impl Ray {
    /// A ray; `direction` must already be unit length.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction }
    }

    /// The point at `distance`.
    #[inline]
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + self.direction * distance
    }
}

/// The part `start..end` of a ray, by distance \[m\]; `end` may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// First distance.
    pub start: f64,
    /// Last distance, not below `start`.
    pub end: f64,
}

impl Span {
    /// A span of a ray.
    #[inline]
    pub fn new(start: f64, end: f64) -> Self {
        Self { start, end }
    }

    /// `end - start`.
    #[inline]
    pub fn length(&self) -> f64 {
        self.end - self.start
    }

    /// The part common to both, or `None` where nothing of positive length is.
    #[inline]
    pub fn intersect(&self, other: Span) -> Option<Span> {
        let span = Span::new(self.start.max(other.start), self.end.min(other.end));
        (span.end > span.start).then_some(span)
    }
}

/// A ball in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Centre \[m\].
    pub center: DVec3,
    /// Radius \[m\].
    pub radius: f64,
}

impl Ball {
    /// 4/3 pi r^3.
    pub fn volume(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.radius * self.radius * self.radius
    }
}

/// A right-handed orthonormal frame about an axis.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// First tangent.
    pub tangent: DVec3,
    /// Second tangent.
    pub bitangent: DVec3,
    /// The axis.
    pub axis: DVec3,
}

impl Frame {
    /// The frame about a unit axis, without a branch that loses precision near the poles
    /// (Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017).
    pub fn about(axis: DVec3) -> Self {
        let sign = 1.0_f64.copysign(axis.z);
        let a = -1.0 / (sign + axis.z);
        let b = axis.x * axis.y * a;
        Self {
            tangent: DVec3::new(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
            bitangent: DVec3::new(b, sign + axis.y * axis.y * a, -axis.y),
            axis,
        }
    }

    /// From frame to world coordinates.
    pub fn to_world(&self, local: DVec3) -> DVec3 {
        self.tangent * local.x + self.bitangent * local.y + self.axis * local.z
    }

    /// The unit direction at angle `theta` (by cosine and sine) from the axis and azimuth `phi`.
    pub fn polar(&self, cos_theta: f64, sin_theta: f64, phi: f64) -> DVec3 {
        let (sin_phi, cos_phi) = phi.sin_cos();
        self.to_world(DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta))
    }
}
