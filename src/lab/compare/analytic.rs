//! Scenes whose power density is known in closed form, and with it the power that any ball is expected to hold.
//!
//! All have sigma_t = 1. About a point light of 1 W in an infinite medium the density p depends on the distance alone
//! (the module `point_scene` integrates it over balls). A medium of albedo 1 with the radiance 1 all around is a white furnace: the
//! radiance is 1 within, too, p = 4 pi everywhere, and a ball holds p times what of it lies in the medium. Parallel light
//! of 1 W/m^2 along z falls on an absorbing box: p = exp(-z), and a ball inside holds
//! int_{-R}^{R} exp(-z - x) pi (R^2 - x^2) dx = 4 pi exp(-z) (R cosh R - sinh R).

use std::f64::consts::PI;
use std::sync::LazyLock;

use super::point_scene;
use super::scattering::ScatteredFluence;
use crate::light::{DirectionalLight, Environment, Light, PointLight};
use crate::math::square_maps::square_to_sphere;
use crate::math::{Ball, DVec2, DVec3, Random, Rgb, uniform};
use crate::medium::{Bounds, Medium, MediumExtinction, Phase, UniformExtinction};

/// A scene whose power density is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnalyticScene {
    /// A point light in an infinite medium, nothing scatters: p = exp(-t) / (4 pi t^2).
    PointAbsorbing,
    /// The same with an albedo of 0.9, isotropic: p is the fluence.
    PointScattering,
    /// A ball of radius 1 m as white furnace.
    UniformBall,
    /// A cube of edges of 2 m as white furnace.
    UniformBox,
    /// Parallel light on an absorbing box of 2 x 2 x 2 m, its lit face at z = 0.
    Beam,
}

/// Albedo of the infinite medium that scatters.
const ALBEDO: f64 = 0.9;

/// Queries of points and beams are at depths of 1 m, more or less by this: over several strata, so that no one lattice is
/// measured.
const SPREAD: f64 = 0.05;

/// Queries of beams are so near the axis along x and y \[m\].
const BEAM_WIDTH: f64 = 0.4;

static SCATTERED: LazyLock<ScatteredFluence> = LazyLock::new(|| ScatteredFluence::new(ALBEDO));

impl AnalyticScene {
    /// Every scene.
    pub const ALL: [Self; 5] = [
        Self::PointAbsorbing,
        Self::PointScattering,
        Self::UniformBall,
        Self::UniformBox,
        Self::Beam,
    ];

    /// As on the command line, after `analytic:`.
    pub fn name(self) -> &'static str {
        match self {
            Self::PointAbsorbing => "point-absorbing",
            Self::PointScattering => "point-scattering",
            Self::UniformBall => "uniform-ball",
            Self::UniformBox => "uniform-box",
            Self::Beam => "beam",
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
            Self::PointAbsorbing | Self::Beam => 0.0,
            Self::PointScattering => ALBEDO,
            Self::UniformBall | Self::UniformBox => 1.0,
        };
        Medium {
            bounds: self.bounds(),
            extinction: MediumExtinction::Uniform(self.extinction()),
            albedo: Rgb::splat(albedo),
            color: None,
            phase: Phase::Isotropic,
            emissivity: None,
        }
    }

    fn bounds(self) -> Bounds {
        match self {
            Self::PointAbsorbing | Self::PointScattering => Bounds::Infinite,
            Self::UniformBall => Bounds::Sphere { center: DVec3::ZERO, radius: 1.0 },
            Self::UniformBox => Bounds::Box { min: DVec3::NEG_ONE, max: DVec3::ONE },
            Self::Beam => {
                Bounds::Box { min: DVec3::new(-1.0, -1.0, 0.0), max: DVec3::new(1.0, 1.0, 2.0) }
            }
        }
    }

    /// What lights it; points are at the origin.
    pub(super) fn light(self) -> Light {
        match self {
            Self::PointAbsorbing | Self::PointScattering => {
                let intensity = Rgb::splat(0.25 / PI);
                Light::Point(PointLight { position: DVec3::ZERO, intensity })
            }
            Self::UniformBall | Self::UniformBox => {
                Light::Environment(Environment::Constant(Rgb::ONE))
            }
            Self::Beam => {
                Light::Directional(DirectionalLight { direction: DVec3::Z, irradiance: Rgb::ONE })
            }
        }
    }

    /// The most power that a photon carries of the light that reaches the medium, one of `count` \[W\].
    pub(super) fn largest_power(self, count: u64) -> f64 {
        let all = match self {
            Self::PointAbsorbing | Self::PointScattering => 1.0,
            Self::UniformBall => PI * 4.0 * PI,
            Self::UniformBox => PI * 24.0,
            // All photons are made to collide, each with the opacity as its share.
            Self::Beam => 4.0 * (1.0 - (-2.0_f64).exp()),
        };
        all / count as f64
    }

    /// Power density at a place in the medium \[W/m^3\].
    pub fn power_density(self, place: DVec3) -> f64 {
        match self {
            Self::PointAbsorbing | Self::PointScattering => {
                self.density_about_point(place.length())
            }
            Self::UniformBall | Self::UniformBox => 4.0 * PI,
            Self::Beam => (-place.z).exp(),
        }
    }

    fn density_about_point(self, distance: f64) -> f64 {
        match self {
            Self::PointScattering => SCATTERED.at(distance),
            _ => (-distance).exp() / (4.0 * PI * distance * distance),
        }
    }

    /// Volume of what of a ball lies in the medium \[m^3\].
    pub(super) fn ball_volume(self, place: DVec3, radius: f64) -> f64 {
        self.bounds().overlap(Ball { center: place, radius }).mass
    }

    /// Power expected in a ball \[W\]: one that stays clear of the light or, of beams, of the faces.
    pub fn ball_power(self, place: DVec3, radius: f64) -> f64 {
        match self {
            Self::PointAbsorbing | Self::PointScattering => {
                let density = |distance| self.density_about_point(distance);
                point_scene::ball_power(density, place.length(), radius)
            }
            Self::UniformBall | Self::UniformBox => 4.0 * PI * self.ball_volume(place, radius),
            Self::Beam => 4.0 * PI * (-place.z).exp() * sinh_difference(radius),
        }
    }

    /// The ball mean of the power density over its value in the middle, less 1.
    pub fn smoothing(self, place: DVec3, radius: f64) -> f64 {
        match self {
            Self::UniformBall | Self::UniformBox => 0.0,
            _ => {
                let volume = self.ball_volume(place, radius);
                self.ball_power(place, radius) / (volume * self.power_density(place)) - 1.0
            }
        }
    }

    /// The radius of the ball about a place that is expected to hold `power`; `None` where it would be larger than
    /// [`Self::ball_power`] knows, or than half of the medium.
    pub fn ball_radius(self, place: DVec3, power: f64) -> Option<f64> {
        let limit = self.largest_radius(place);
        let mut radius = (0.75 / PI * power / self.power_density(place)).cbrt();
        // The ball mean hardly depends on the radius: every step gains three digits or more, and near faces one.
        for _ in 0..100 {
            if radius >= limit {
                return None;
            }
            let next = radius * (power / self.ball_power(place, radius)).cbrt();
            if (next - radius).abs() <= 1e-14 * radius {
                return Some(next);
            }
            radius = next;
        }
        Some(radius)
    }

    fn largest_radius(self, place: DVec3) -> f64 {
        match self {
            Self::PointAbsorbing | Self::PointScattering => place.length(),
            Self::UniformBall | Self::UniformBox => 1.0,
            Self::Beam => {
                let to_sides = 1.0 - place.x.abs().max(place.y.abs());
                to_sides.min(place.z).min(2.0 - place.z)
            }
        }
    }

    /// A place to ask, at random: in a shell about the light, in a slab across the beam, or anywhere in a furnace.
    pub(super) fn sample_query(self, random: &mut Random) -> DVec3 {
        let mut within = |reach: f64| reach * (2.0 * uniform(random) - 1.0);
        match self {
            Self::PointAbsorbing | Self::PointScattering => {
                let distance = 1.0 + within(SPREAD);
                distance * square_to_sphere(DVec2::new(uniform(random), uniform(random)))
            }
            Self::UniformBall => {
                let distance = uniform(random).cbrt();
                distance * square_to_sphere(DVec2::new(uniform(random), uniform(random)))
            }
            Self::UniformBox => DVec3::new(within(1.0), within(1.0), within(1.0)),
            Self::Beam => DVec3::new(within(BEAM_WIDTH), within(BEAM_WIDTH), 1.0 + within(SPREAD)),
        }
    }

    /// The middle of the places asked.
    pub(super) fn typical_query(self) -> DVec3 {
        match self {
            Self::UniformBall | Self::UniformBox => DVec3::ZERO,
            _ => DVec3::Z,
        }
    }

    /// Of the places asked, one whose balls are the largest.
    pub(super) fn hardest_query(self) -> DVec3 {
        match self {
            Self::PointAbsorbing | Self::PointScattering => (1.0 + SPREAD) * DVec3::Z,
            Self::UniformBall => DVec3::Z,
            Self::UniformBox => DVec3::ONE,
            Self::Beam => DVec3::new(BEAM_WIDTH, BEAM_WIDTH, 1.0 + SPREAD),
        }
    }

    /// The radius below which the balls of all queries must stay \[m\].
    pub(super) fn reach_limit(self) -> f64 {
        match self {
            Self::PointAbsorbing | Self::PointScattering => 1.0 - SPREAD,
            _ => self.largest_radius(self.hardest_query()),
        }
    }

    /// Whether a query that looks so far \[m\] may find a photon there.
    pub(super) fn is_within_reach(self, place: DVec3, reach: f64) -> bool {
        let depth = |depth: f64| (depth - 1.0).abs() <= SPREAD + reach;
        match self {
            Self::PointAbsorbing | Self::PointScattering => depth(place.length()),
            Self::UniformBall | Self::UniformBox => true,
            Self::Beam => depth(place.z) && place.x.abs().max(place.y.abs()) <= BEAM_WIDTH + reach,
        }
    }
}

/// R cosh R - sinh R = sum over j of 2j R^(2j+1) / (2j+1)!, which does not cancel.
fn sinh_difference(radius: f64) -> f64 {
    let square = radius * radius;
    let (mut sum, mut power_over_factorial) = (0.0, radius);
    for j in 1..20 {
        let twice = 2.0 * f64::from(j);
        power_over_factorial *= square / (twice * (twice + 1.0));
        sum += twice * power_over_factorial;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Stream;

    #[test]
    fn radii_invert_powers_up_to_faces_and_lights() {
        let mut random = Stream::Experiment.random(1, 0);
        for scene in AnalyticScene::ALL {
            for _ in 0..50 {
                let place = scene.sample_query(&mut random);
                let radius = 0.5 * uniform(&mut random);
                let power = scene.ball_power(place, radius);
                let found = scene.ball_radius(place, power).expect("a radius");
                assert!((found / radius - 1.0).abs() < 1e-10, "{scene:?} {place} {radius} {found}");
            }
            let everything = 1e3;
            assert_eq!(scene.ball_radius(scene.typical_query(), everything), None);
        }
    }

    /// Small balls are smoothed by 0.1 R^2 times the Laplacian of p over p: 5 about the point, 1 in the beam.
    #[test]
    fn smoothing_is_that_of_the_second_derivative() {
        for (scene, curvature) in [
            (AnalyticScene::PointAbsorbing, 5.0),
            (AnalyticScene::Beam, 1.0),
            (AnalyticScene::UniformBox, 0.0),
        ] {
            let smoothing = scene.smoothing(DVec3::Z, 0.01);
            let expected = 0.1 * curvature * 1e-4;
            assert!((smoothing - expected).abs() <= 1e-3 * expected, "{scene:?}: {smoothing}");
        }
    }

    /// Against the midpoint rule, and in a corner, where an eighth of the ball is inside.
    #[test]
    fn beams_and_furnaces_fill_balls() {
        let steps = 100_000;
        let radius: f64 = 0.5;
        let width = 2.0 * radius / f64::from(steps);
        let slices = (0..steps).map(|i| {
            let x = -radius + (f64::from(i) + 0.5) * width;
            (-1.2 - x).exp() * PI * (radius * radius - x * x) * width
        });
        let power = AnalyticScene::Beam.ball_power(DVec3::new(0.1, 0.2, 1.2), radius);
        assert!((power / slices.sum::<f64>() - 1.0).abs() < 1e-8);
        let corner = AnalyticScene::UniformBox.ball_power(DVec3::new(1.0, -1.0, 1.0), radius);
        assert!((corner / (4.0 * PI * PI / 6.0 * radius.powi(3)) - 1.0).abs() < 1e-12);
    }
}
