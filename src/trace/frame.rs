//! The coordinates of stored photons.

use crate::math::DVec3;
use crate::medium::{Bounds, Medium, MediumExtinction};

/// Coordinates in which the medium is about one unit large and centred on 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapFrame {
    /// World position of the origin \[m\].
    pub origin: DVec3,
    /// World length of one unit \[m\].
    pub unit: f64,
}

impl MapFrame {
    /// The frame of a medium; `lit_from` stands in for the centre of an infinite one.
    pub fn of(medium: &Medium, lit_from: Option<DVec3>) -> Self {
        match (medium.bounds.enclosing_ball(), &medium.bounds) {
            (Some(ball), _) if ball.radius > 0.0 => Self { origin: ball.center, unit: ball.radius },
            (_, Bounds::Infinite) => {
                let sigma_t = match &medium.extinction {
                    MediumExtinction::Uniform(uniform) => uniform.sigma_t,
                    MediumExtinction::Chromatic(chromatic) => chromatic.sigma_t.min_element(),
                    MediumExtinction::Grid(_) | MediumExtinction::Several(_) => 1.0,
                };
                let unit = if sigma_t > 0.0 { 1.0 / sigma_t } else { 1.0 };
                Self { origin: lit_from.unwrap_or(DVec3::ZERO), unit }
            }
            _ => Self { origin: DVec3::ZERO, unit: 1.0 },
        }
    }

    /// From world space.
    #[inline]
    pub fn to_map(&self, position: DVec3) -> [f32; 3] {
        ((position - self.origin) / self.unit).as_vec3().to_array()
    }

    /// To world space.
    pub fn to_world(&self, position: [f32; 3]) -> DVec3 {
        glam::Vec3::from_array(position).as_dvec3() * self.unit + self.origin
    }
}
