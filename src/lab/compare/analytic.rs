//! Scenes whose power density is known in closed form.
//!
//! A point light of 1 W in an infinite medium of sigma_t = 1: the collisions of its photons have a density p(t) a watt
//! and cubic metre that depends on the distance t from the light alone. A ball of radius R about a place at r > R is
//! expected to hold the power
//! P = int_{r-R}^{r+R} p(t) 4 pi t^2 (R^2 - (t - r)^2) / (4 t r) dt,
//! the last factor being the share of the sphere of radius t that lies in the ball.

use std::f64::consts::PI;
use std::sync::LazyLock;

use super::scattering::ScatteredFluence;
use crate::light::{Light, PointLight};
use crate::math::{DVec3, Rgb};
use crate::medium::{Bounds, Medium, MediumExtinction, Phase, UniformExtinction};

/// A scene whose power density is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnalyticScene {
    /// Nothing scatters: p = exp(-t) / (4 pi t^2).
    PointAbsorbing,
    /// Albedo 0.9, isotropic: p is the fluence.
    PointScattering,
}

/// Albedo of the medium that scatters.
const ALBEDO: f64 = 0.9;

static SCATTERED: LazyLock<ScatteredFluence> = LazyLock::new(|| ScatteredFluence::new(ALBEDO));

/// Nodes above 0 and weights of Gauss and Legendre's rule of 12 points on \[-1, 1\].
const GAUSS_LEGENDRE: [(f64, f64); 6] = [
    (0.125_233_408_511_468_9, 0.249_147_045_813_402_8),
    (0.367_831_498_998_180_2, 0.233_492_536_538_354_8),
    (0.587_317_954_286_617_5, 0.203_167_426_723_065_9),
    (0.769_902_674_194_304_7, 0.160_078_328_543_346_2),
    (0.904_117_256_370_474_9, 0.106_939_325_995_318_4),
    (0.981_560_634_246_719_3, 0.047_175_336_386_511_8),
];

impl AnalyticScene {
    /// Every scene.
    pub const ALL: [Self; 2] = [Self::PointAbsorbing, Self::PointScattering];

    /// As on the command line, after `analytic:`.
    pub fn name(self) -> &'static str {
        match self {
            Self::PointAbsorbing => "point-absorbing",
            Self::PointScattering => "point-scattering",
        }
    }

    /// The scene of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scene| scene.name() == name)
    }

    /// sigma_t \[1/m\].
    pub(super) fn extinction(self) -> UniformExtinction {
        UniformExtinction { sigma_t: 1.0 }
    }

    /// The medium.
    pub(super) fn medium(self) -> Medium {
        let albedo = match self {
            Self::PointAbsorbing => Rgb::ZERO,
            Self::PointScattering => Rgb::splat(ALBEDO),
        };
        Medium {
            bounds: Bounds::Infinite,
            extinction: MediumExtinction::Uniform(self.extinction()),
            albedo,
            color: None,
            phase: Phase::Isotropic,
            emissivity: None,
        }
    }

    /// A light of 1 W at the origin.
    pub(super) fn light(self) -> Light {
        let intensity = Rgb::splat(0.25 / PI);
        Light::Point(PointLight { position: DVec3::ZERO, intensity })
    }

    /// Power density at `distance` from the light \[W/m^3\].
    pub fn power_density(self, distance: f64) -> f64 {
        match self {
            Self::PointAbsorbing => (-distance).exp() / (4.0 * PI * distance * distance),
            Self::PointScattering => SCATTERED.at(distance),
        }
    }

    /// Power expected in the ball of `radius` below `distance` about a place at `distance` from the light \[W\].
    pub fn ball_power(self, distance: f64, radius: f64) -> f64 {
        let slice = |x: f64| {
            let from_light = distance + radius * x;
            self.power_density(from_light) * from_light * (1.0 - x * x)
        };
        let nodes = GAUSS_LEGENDRE.iter();
        let sum: f64 = nodes.map(|&(x, weight)| weight * (slice(x) + slice(-x))).sum();
        PI * radius.powi(3) / distance * sum
    }

    /// The ball mean of the power density over its value in the middle, less 1.
    pub fn smoothing(self, distance: f64, radius: f64) -> f64 {
        self.ball_power(distance, radius) / (ball_volume(radius) * self.power_density(distance))
            - 1.0
    }

    /// The radius of the ball about a place at `distance` that is expected to hold `power`; `None` where it would reach
    /// the light.
    pub fn ball_radius(self, distance: f64, power: f64) -> Option<f64> {
        let density = self.power_density(distance);
        let mut radius = (power / (ball_volume(1.0) * density)).cbrt();
        // The ball mean hardly depends on the radius: every step gains three digits or more.
        for _ in 0..40 {
            if radius >= distance {
                return None;
            }
            let next = radius * (power / self.ball_power(distance, radius)).cbrt();
            if (next - radius).abs() <= 1e-14 * radius {
                return Some(next);
            }
            radius = next;
        }
        Some(radius)
    }
}

/// Volume of a ball.
pub(super) fn ball_volume(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// int_{r-R}^{r+R} exp(-t) (R^2 - (t-r)^2) / (4 t r) dt by the midpoint rule, and 0.5 R^2 for small balls.
    #[test]
    fn balls_hold_what_slices_add_up_to() {
        let scene = AnalyticScene::PointAbsorbing;
        for (distance, radius) in [(1.0, 0.01), (1.0, 0.3), (0.95, 0.6)] {
            let steps = 200_000;
            let width = 2.0 * radius / f64::from(steps);
            let slices = (0..steps).map(|i| {
                let t = distance - radius + (f64::from(i) + 0.5) * width;
                (-t).exp() * (radius * radius - (t - distance).powi(2)) / (4.0 * t * distance)
            });
            let sum: f64 = slices.sum::<f64>() * width;
            let power = scene.ball_power(distance, radius);
            assert!((power / sum - 1.0).abs() < 1e-8, "{distance} {radius}: {power} {sum}");
            let found = scene.ball_radius(distance, power);
            assert!(found.is_some_and(|found| (found / radius - 1.0).abs() < 1e-12));
        }
        let smoothing = scene.smoothing(1.0, 0.01);
        assert!((smoothing / 0.5e-4 - 1.0).abs() < 1e-3, "{smoothing}");
        assert_eq!(scene.ball_radius(1.0, 0.9), None);
    }
}
