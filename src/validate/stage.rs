//! Scenes built in code, and their photons.

use std::f64::consts::PI;

use super::check::Batch;
use super::error::ValidateError;
use crate::camera::Camera;
use crate::emission::{Emission, EmissionKind};
use crate::estimate::{Divisor, Kernel};
use crate::light::{Environment, Light, PointLight, SpotLight};
use crate::math::square_maps::square_to_sphere;
use crate::math::{DVec2, DVec3, Frame, Random, Ray, Rgb, uniform};
use crate::medium::{
    Bounds, Extinction, GridExtinction, Medium, MediumExtinction, Phase, UniformExtinction,
};
use crate::render::Gather;
use crate::scene::{Background, EstimateSettings, PhotonSettings, RenderSettings, Scene};
use crate::trace::{MapFrame, Photon, TraceSettings, TracedPhotons, trace_photons};

/// The box from -1 to 1.
pub(super) const CUBE: Bounds = Bounds::Box { min: DVec3::NEG_ONE, max: DVec3::ONE };

/// A ball about the origin.
pub(super) fn ball(radius: f64) -> Bounds {
    Bounds::Sphere { center: DVec3::ZERO, radius }
}

/// Grey fog.
pub(super) fn fog(bounds: Bounds, sigma_t: f64, albedo: f64, g: f64) -> Medium {
    let extinction = MediumExtinction::Uniform(UniformExtinction { sigma_t });
    Medium {
        bounds,
        extinction,
        albedo: Rgb::splat(albedo),
        color: None,
        phase: phase(g),
        emissivity: None,
    }
}

/// A grid of grey smoke; infinite bounds if it has no extinction.
pub(super) fn smoke(extinction: GridExtinction, albedo: f64, g: f64) -> Medium {
    Medium {
        bounds: extinction.bounds().unwrap_or(Bounds::Infinite),
        extinction: MediumExtinction::Grid(Box::new(extinction)),
        albedo: Rgb::splat(albedo),
        color: None,
        phase: phase(g),
        emissivity: None,
    }
}

fn phase(g: f64) -> Phase {
    if g == 0.0 { Phase::Isotropic } else { Phase::HenyeyGreenstein { g } }
}

/// A point light of 1 W.
pub(super) fn one_watt(position: DVec3) -> Light {
    Light::Point(PointLight { position, intensity: Rgb::splat(0.25 / PI) })
}

/// A needle of light of 1 W.
pub(super) fn needle(position: DVec3, axis: DVec3, angle: f64) -> Light {
    let spot =
        SpotLight { position, axis, intensity: Rgb::ONE, cone_angle: angle, falloff_angle: angle };
    let intensity = Rgb::splat(1.0 / spot.effective_solid_angle());
    Light::Spot(SpotLight { intensity, ..spot })
}

/// Radiance 1 from all sides.
pub(super) fn white_sky() -> Light {
    Light::Environment(Environment::Constant(Rgb::ONE))
}

/// A scene of everyday settings, for the photons of a batch.
pub(super) fn scene(
    medium: Medium,
    lights: Vec<Light>,
    batch: Batch,
) -> Result<Scene, ValidateError> {
    let camera = Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, 0.66, [1, 1]);
    Ok(Scene {
        camera: camera.ok_or(ValidateError::Scene)?,
        medium,
        lights,
        light_names: Vec::new(),
        photons: PhotonSettings {
            count: batch.count,
            emission: EmissionKind::Stratified,
            seed: batch.seed,
            max_order: 1_000_000,
        },
        estimate: EstimateSettings {
            k: 12,
            divisor: Divisor::KMinus1,
            kernel: Kernel::Constant,
            max_radius: None,
        },
        render: RenderSettings {
            samples_per_pixel: 1,
            march_samples: 8,
            light_samples: 4,
            gather: Gather::Knn,
            bounces: 8,
            filter: None,
            lattice: None,
            photons_only: false,
            background: Background::Visible,
        },
        hash: 0,
        grids: Vec::new(),
        is_photon_count_given: true,
        warnings: Vec::new(),
    })
}

/// All photons of the scene, those that have not scattered yet included.
pub(super) fn trace(scene: &Scene) -> TracedPhotons {
    match &scene.medium.extinction {
        MediumExtinction::Uniform(extinction) => trace_through(scene, extinction),
        MediumExtinction::Chromatic(extinction) => trace_through(scene, extinction),
        MediumExtinction::Grid(extinction) => trace_through(scene, &**extinction),
        MediumExtinction::Several(volumes) => trace_through(scene, &**volumes),
    }
}

fn trace_through<E: Extinction>(scene: &Scene, extinction: &E) -> TracedPhotons {
    let settings = TraceSettings {
        max_order: scene.photons.max_order,
        min_stored_order: 0,
        max_stored: usize::MAX,
    };
    let emission = emission(scene, extinction);
    trace_photons(&emission, &scene.medium, extinction, frame(scene), settings, |_| ())
}

/// The scene's photons as they leave their lights.
pub(super) fn emission<'a, E: Extinction>(scene: &'a Scene, extinction: &E) -> Emission<'a> {
    let Scene { medium, photons, lights, .. } = scene;
    let opacity = |ray: &Ray| {
        let span = medium.bounds.intersect(ray);
        span.map_or(0.0, |span| extinction.opacity(ray, span, Rgb::ONE))
    };
    Emission::new(lights, medium, opacity, 1.0, photons.emission, photons.count, photons.seed)
}

/// The coordinates of its stored photons.
pub(super) fn frame(scene: &Scene) -> MapFrame {
    MapFrame::of(&scene.medium, scene.lights.first().and_then(Light::position))
}

/// Power of a stored photon \[W\].
pub(super) fn power(photon: &Photon) -> f64 {
    f64::from(photon.power[0])
}

/// Power of all of them.
pub(super) fn collided(traced: &TracedPhotons) -> f64 {
    traced.photons.iter().map(power).sum()
}

/// A direction, all alike.
pub(super) fn random_direction(random: &mut Random) -> DVec3 {
    square_to_sphere(DVec2::new(uniform(random), uniform(random)))
}

/// A ray from outside, of random direction, that passes the origin at distance `impact`.
pub(super) fn passing_ray(impact: f64, far: f64, random: &mut Random) -> Ray {
    let frame = Frame::about(random_direction(random));
    let (sin, cos) = (2.0 * PI * uniform(random)).sin_cos();
    let beside = frame.tangent * (impact * cos) + frame.bitangent * (impact * sin);
    Ray::new(beside - frame.axis * far, frame.axis)
}
