//! Lights: what sends light into the medium, and how strongly each place is lit.
//!
//! Area lights and environments are seen by the camera too, unless the scene hides them. No light casts a shadow: the medium is all
//! that attenuates.

mod area;
mod choice;
mod environment;
mod punctual;
mod shadows;

pub use area::{QuadLight, SphereLight};
pub use choice::LightChoice;
pub use environment::{DirectionSample, Environment, EnvironmentImage};
pub use punctual::{DirectionalLight, PointLight, SpotLight};
pub use shadows::{Shadows, transmittance_to};

use crate::math::{DVec2, DVec3, Ray, Rgb, Span};

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

/// Light that arrives at a place, before the medium on its way attenuates it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Illumination {
    /// Unit direction from the place to the light.
    pub direction: DVec3,
    /// Distance to the light \[m\], infinite for directional and environment lights.
    pub distance: f64,
    /// Power per area facing the light \[W/m^2\]; for an area light, radiance times solid angle.
    pub irradiance: Rgb,
}

impl Light {
    /// Where a point light or spot stands: its light falls with the squared distance from there, without
    /// bound.
    pub fn position(&self) -> Option<DVec3> {
        match self {
            Self::Point(light) => Some(light.position),
            Self::Spot(light) => Some(light.position),
            _ => None,
        }
    }

    /// The middle of a light that is near: about it distances along rays are sampled.
    pub fn center(&self) -> Option<DVec3> {
        match self {
            Self::Quad(light) => Some(light.corner + 0.5 * (light.edge_u + light.edge_v)),
            Self::Sphere(light) => Some(light.center),
            _ => self.position(),
        }
    }

    /// The light's color, up to a factor; `None` if it has several.
    pub fn color(&self) -> Option<Rgb> {
        match self {
            Self::Point(light) => Some(light.intensity),
            Self::Spot(light) => Some(light.intensity),
            Self::Directional(light) => Some(light.irradiance),
            Self::Environment(Environment::Constant(radiance)) => Some(*radiance),
            Self::Environment(Environment::Image(_)) => None,
            Self::Quad(light) => Some(light.radiance),
            Self::Sphere(light) => Some(light.radiance),
        }
    }

    /// The part of a ray that the light can reach; `None` if nothing is.
    pub fn lit_span(&self, ray: &Ray, span: Span) -> Option<Span> {
        match self {
            Self::Spot(light) => light.lit_span(ray, span),
            _ => Some(span),
        }
    }

    /// The light that reaches `place` from the light, or from one sampled direction towards it if it has
    /// extent (`u` in the unit square). `None` where none does; environments, whose light is sampled
    /// together with the phase function, answer `None` always.
    pub fn sample_illumination(&self, place: DVec3, u: DVec2) -> Option<Illumination> {
        match self {
            Self::Point(light) => light.illumination(place),
            Self::Spot(light) => light.illumination(place),
            Self::Directional(light) => Some(light.illumination()),
            Self::Environment(_) => None,
            Self::Quad(light) => light.sample_illumination(place, u),
            Self::Sphere(light) => light.sample_illumination(place, u),
        }
    }

    /// Whether the camera sees the light where it looks at it.
    pub fn is_visible(&self) -> bool {
        match self {
            Self::Point(_) | Self::Spot(_) | Self::Directional(_) => false,
            Self::Environment(_) => true,
            Self::Quad(light) => light.is_visible,
            Self::Sphere(light) => light.is_visible,
        }
    }

    /// Radiance seen along a ray, and the distance it comes from \[m\]: infinite for environments.
    pub fn seen_along(&self, ray: &Ray) -> Option<(f64, Rgb)> {
        match self {
            Self::Point(_) | Self::Spot(_) | Self::Directional(_) => None,
            Self::Environment(environment) => {
                Some((f64::INFINITY, environment.radiance(ray.direction)))
            }
            Self::Quad(light) => light.seen_along(ray),
            Self::Sphere(light) => light.seen_along(ray),
        }
    }
}
