//! Scenes built in code, and the statistics of independent runs of them.
#![allow(dead_code)]

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use photonvdb::camera::Camera;
use photonvdb::emission::{Emission, EmissionKind};
use photonvdb::estimate::{Divisor, Kernel};
use photonvdb::light::{Environment, Light, PointLight};
use photonvdb::math::square_maps::square_to_sphere;
use photonvdb::math::{DVec2, DVec3, Frame, Random, Ray, Rgb, uniform};
use photonvdb::medium::{
    Bounds, ChromaticExtinction, Extinction, GridExtinction, Medium, MediumExtinction, Phase,
    UniformExtinction,
};
use photonvdb::render::{Gather, LitScene, Unobserved};
use photonvdb::scene::{Background, EstimateSettings, PhotonSettings, RenderSettings, Scene};
use photonvdb::trace::{MapFrame, Photon, TraceSettings, TracedPhotons, trace_photons};

/// Runs behind every z-score: independent photon maps.
pub const RUNS: u64 = 32;

/// Seven in a million tests of a true figure exceed it.
pub const LARGEST_Z: f64 = 4.5;

pub const CUBE: Bounds = Bounds::Box { min: DVec3::NEG_ONE, max: DVec3::ONE };

pub fn ball(radius: f64) -> Bounds {
    Bounds::Sphere { center: DVec3::ZERO, radius }
}

pub fn fog(bounds: Bounds, sigma_t: Rgb, albedo: Rgb, g: f64) -> Medium {
    let is_grey = sigma_t == Rgb::splat(sigma_t.x);
    let extinction = match is_grey {
        true => MediumExtinction::Uniform(UniformExtinction { sigma_t: sigma_t.x }),
        false => MediumExtinction::Chromatic(ChromaticExtinction { sigma_t }),
    };
    Medium { bounds, extinction, albedo, color: None, phase: phase(g), emissivity: None }
}

pub fn grey_fog(bounds: Bounds, sigma_t: f64, albedo: f64, g: f64) -> Medium {
    fog(bounds, Rgb::splat(sigma_t), Rgb::splat(albedo), g)
}

pub fn grid_medium(extinction: GridExtinction, albedo: Rgb, g: f64) -> Medium {
    let bounds = extinction.bounds().unwrap();
    Medium {
        bounds,
        extinction: MediumExtinction::Grid(Box::new(extinction)),
        albedo,
        color: None,
        phase: phase(g),
        emissivity: None,
    }
}

fn phase(g: f64) -> Phase {
    if g == 0.0 { Phase::Isotropic } else { Phase::HenyeyGreenstein { g } }
}

/// A point light of 1 W.
pub fn one_watt(position: DVec3) -> Light {
    Light::Point(PointLight { position, intensity: Rgb::splat(0.25 / PI) })
}

pub fn white_sky() -> Light {
    Light::Environment(Environment::Constant(Rgb::ONE))
}

/// A scene of everyday settings.
pub fn scene(medium: Medium, light: Light, photon_count: u64) -> Scene {
    let camera =
        Camera::look_at(DVec3::new(2.2, 1.8, 4.2), DVec3::ZERO, DVec3::Y, 0.66, [32, 32]).unwrap();
    Scene {
        camera,
        medium,
        lights: vec![light],
        light_names: Vec::new(),
        photons: PhotonSettings {
            count: photon_count,
            emission: EmissionKind::Stratified,
            seed: 0,
            max_order: 1000,
        },
        estimate: EstimateSettings {
            k: 100,
            divisor: Divisor::KMinus1,
            kernel: Kernel::Constant,
            max_radius: None,
        },
        render: RenderSettings {
            samples_per_pixel: 4,
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
    }
}

/// All photons of the scene, those that have not scattered yet included.
pub fn trace(scene: &Scene) -> TracedPhotons {
    match &scene.medium.extinction {
        MediumExtinction::Uniform(extinction) => trace_through(scene, extinction),
        MediumExtinction::Chromatic(extinction) => trace_through(scene, extinction),
        MediumExtinction::Grid(extinction) => trace_through(scene, &**extinction),
        MediumExtinction::Several(volumes) => trace_through(scene, &**volumes),
    }
}

fn trace_through<E: Extinction>(scene: &Scene, extinction: &E) -> TracedPhotons {
    let emission = emission(scene, extinction);
    let settings = TraceSettings {
        max_order: scene.photons.max_order,
        min_stored_order: 0,
        max_stored: usize::MAX,
    };
    let traced =
        trace_photons(&emission, &scene.medium, extinction, frame(scene), settings, |_| ());
    assert!(!traced.overflow);
    traced
}

pub fn emission<'a, E: Extinction>(scene: &'a Scene, extinction: &E) -> Emission<'a> {
    let Scene { medium, photons, lights, .. } = scene;
    let opacity = |ray: &Ray| {
        let span = medium.bounds.intersect(ray);
        span.map_or(0.0, |span| extinction.opacity(ray, span, Rgb::ONE))
    };
    let PhotonSettings { count, emission, seed, .. } = *photons;
    Emission::new(lights, medium, opacity, 1.0, emission, count, seed)
}

/// Power of a stored photon's channel \[W\].
pub fn power(photon: &Photon, channel: usize) -> f64 {
    f64::from(photon.power[channel])
}

pub fn frame(scene: &Scene) -> MapFrame {
    MapFrame::of(&scene.medium, scene.lights.first().and_then(|light| light.position()))
}

/// What a figure comes to over the scene's seeds 0, 1, ... `RUNS`.
pub fn over_seeds<const N: usize>(
    scene: &mut Scene,
    mut figures: impl FnMut(&Scene) -> [f64; N],
) -> [Runs; N] {
    let rows: Vec<[f64; N]> = (0..RUNS)
        .map(|seed| {
            scene.photons.seed = seed;
            figures(scene)
        })
        .collect();
    std::array::from_fn(|n| Runs::of(rows.iter().map(|row| row[n])))
}

/// The mean of independent runs, with its standard error.
#[derive(Clone, Copy, Debug)]
pub struct Runs {
    pub mean: f64,
    pub error: f64,
}

impl Runs {
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let spread = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        Self { mean, error: (spread / (count - 1.0) / count).sqrt() }
    }

    pub fn minus(self, other: Self) -> Self {
        Self { mean: self.mean - other.mean, error: self.error.hypot(other.error) }
    }

    /// Demands the truth, but for the noise.
    pub fn assert_is(self, truth: f64, what: &str) {
        self.assert_within(truth, 0.0, what);
    }

    /// Demands the truth, but for the noise and for a bias of known size.
    pub fn assert_within(self, truth: f64, bias: f64, what: &str) {
        let difference = self.mean - truth;
        let z = difference / self.error;
        println!(
            "{what}: {:.6e} ± {:.1e}, truth {truth:.6e}, {:+.3} %, z {z:+.2}, bias allowed {:.3} %",
            self.mean,
            self.error,
            100.0 * difference / truth,
            100.0 * bias / truth,
        );
        // Where every run gives the same, all that is left is rounding.
        let noise = (LARGEST_Z * self.error).max(1e-12 * truth.abs());
        assert!(difference.abs() <= bias + noise, "{what}: {self:?} for {truth}, z {z}");
    }
}

/// Mean over rays of what is seen along them in the scene.
pub fn mean_seen(scene: &Scene, rays: &[Ray], random: &mut Random) -> SeenLight {
    seen_in(&LitScene::prepare(scene, &Unobserved).unwrap(), rays, random)
}

pub fn seen_in(lit: &LitScene, rays: &[Ray], random: &mut Random) -> SeenLight {
    let mut reader = lit.reader();
    let mut seen = SeenLight::default();
    for ray in rays {
        let radiance = reader.radiance(ray, f64::INFINITY, random);
        seen.single += radiance.single_scatter / rays.len() as f64;
        seen.multiple += radiance.multiple_scatter / rays.len() as f64;
        seen.emission += radiance.emission / rays.len() as f64;
    }
    seen
}

/// Light by its way through the medium.
#[derive(Clone, Copy, Debug, Default)]
pub struct SeenLight {
    pub single: Rgb,
    pub multiple: Rgb,
    pub emission: Rgb,
}

impl SeenLight {
    pub fn total(&self) -> Rgb {
        self.single + self.multiple + self.emission
    }
}

pub fn random_direction(random: &mut Random) -> DVec3 {
    square_to_sphere(DVec2::new(uniform(random), uniform(random)))
}

/// A ray from far outside, of random direction, that passes `center` at distance `impact`.
pub fn passing_ray(center: DVec3, impact: f64, far: f64, random: &mut Random) -> Ray {
    let frame = Frame::about(random_direction(random));
    let (sin, cos) = (2.0 * PI * uniform(random)).sin_cos();
    let beside = frame.tangent * (impact * cos) + frame.bitangent * (impact * sin);
    Ray::new(center + beside - frame.axis * far, frame.axis)
}

pub fn truth(file: &str) -> serde_json::Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/validate/truth").join(file);
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

pub fn number(row: &serde_json::Value, key: &str) -> f64 {
    row[key].as_f64().unwrap()
}

pub fn numbers(row: &serde_json::Value, key: &str) -> Vec<f64> {
    row[key].as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).collect()
}

pub fn tests() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests")
}
