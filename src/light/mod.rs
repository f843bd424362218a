//! Lights: what sends light into the medium.
//!
//! Area lights and environments are seen by the camera too; no light casts a shadow.

mod environment;

pub use environment::{Environment, EnvironmentImage};

use crate::math::{DVec3, Rgb};

/// A light of the scene.
#[derive(Debug)]
pub enum Light {
    /// Radiates the same intensity in all directions from a point.
    Point(PointLight),
    /// A point that radiates within a cone.
    Spot(SpotLight),
    /// Parallel light from infinitely far.
    Directional(DirectionalLight),
    /// Radiance from all around.
    Environment(Environment),
    /// A one-sided parallelogram.
    Quad(QuadLight),
    /// A sphere.
    Sphere(SphereLight),
}

/// See [`Light::Point`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// \[m\]
    pub position: DVec3,
    /// \[W/sr\]
    pub intensity: Rgb,
}

/// See [`Light::Spot`]. Full intensity within `falloff_angle` of the axis, then linear in the angle down to 0
/// at `cone_angle`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLight {
    /// \[m\]
    pub position: DVec3,
    /// Unit direction of the axis.
    pub axis: DVec3,
    /// On the axis \[W/sr\].
    pub intensity: Rgb,
    /// Half-angle of the cone, in (0, pi) \[rad\].
    pub cone_angle: f64,
    /// In \[0, `cone_angle`\] \[rad\].
    pub falloff_angle: f64,
}

/// See [`Light::Directional`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// Unit direction of travel.
    pub direction: DVec3,
    /// On a plane facing the light \[W/m^2\].
    pub irradiance: Rgb,
}

/// See [`Light::Quad`]: radiates to the side that `edge_u` x `edge_v` points to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadLight {
    /// One corner \[m\].
    pub corner: DVec3,
    /// \[m\]
    pub edge_u: DVec3,
    /// \[m\]
    pub edge_v: DVec3,
    /// \[W/(m^2 sr)\]
    pub radiance: Rgb,
}

/// See [`Light::Sphere`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereLight {
    /// \[m\]
    pub center: DVec3,
    /// \[m\]
    pub radius: f64,
    /// \[W/(m^2 sr)\]
    pub radiance: Rgb,
}
