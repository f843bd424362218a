//! The region a medium fills.

use crate::math::DVec3;

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

/// The points `corner + a edges[0] + b edges[1] + c edges[2]` with a, b, c in \[0, 1\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallelepiped {
    /// One corner \[m\].
    pub corner: DVec3,
    /// The three edges that leave it \[m\].
    pub edges: [DVec3; 3],
}
