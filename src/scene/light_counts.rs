//! How many lights of each kind a scene has.

use std::fmt;

use serde::Serialize;

use crate::light::Light;

/// How many lights of each kind a scene has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[allow(missing_docs)]
pub struct LightCounts {
    pub point: usize,
    pub spot: usize,
    pub directional: usize,
    pub environment: usize,
    pub quad: usize,
    pub sphere: usize,
}

impl LightCounts {
    /// Counts the lights.
    pub fn of(lights: &[Light]) -> Self {
        let mut counts = Self::default();
        for light in lights {
            *match light {
                Light::Point(_) => &mut counts.point,
                Light::Spot(_) => &mut counts.spot,
                Light::Directional(_) => &mut counts.directional,
                Light::Environment(_) => &mut counts.environment,
                Light::Quad(_) => &mut counts.quad,
                Light::Sphere(_) => &mut counts.sphere,
            } += 1;
        }
        counts
    }

    fn by_name(&self) -> [(usize, &'static str); 6] {
        [
            (self.point, "point"),
            (self.spot, "spot"),
            (self.directional, "directional"),
            (self.environment, "environment"),
            (self.quad, "quad"),
            (self.sphere, "sphere"),
        ]
    }
}

/// `1 point light, 2 sphere lights`
impl fmt::Display for LightCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let present = self.by_name().into_iter().filter(|(count, _)| *count > 0);
        let words = present.map(|(count, name)| {
            format!("{count} {name} light{}", if count == 1 { "" } else { "s" })
        });
        f.write_str(&words.collect::<Vec<_>>().join(", "))
    }
}
