//! What a simple scene pays for what it does not use: tracing and gathering in homogeneous isotropic fog, by the program and by
//! loops written for that case alone. For callgrind: `scripts/instructions.sh`.
//!
//! `instructions WORK ROUNDS` does the same work some times over. Set-up is the same whatever the rounds, so that the
//! difference of two runs is that of the work.

mod clouds;

use std::hint::black_box;
use std::num::NonZeroUsize;

use clouds::Cloud;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use photonvdb::emission::{Emission, EmissionKind, EmittedPhoton};
use photonvdb::estimate::{EstimateOptions, Estimator, Kernel};
use photonvdb::light::{Light, PointLight};
use photonvdb::map::{NearestPhotons, PhotonMap};
use photonvdb::math::{DVec3, Ray, Rgb, Span, uniform};
use photonvdb::medium::{
    Bounds, Extinction, ISOTROPIC, Medium, MediumExtinction, Phase, UniformExtinction,
};
use photonvdb::trace::{MapFrame, Photon, TraceSettings, trace_photons};

const FOG: UniformExtinction = UniformExtinction { sigma_t: 1.0 };
const MAX_ORDER: u32 = 1000;
const TRACED: u64 = 20_000;
const MAPPED: u32 = 200_000;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, work, rounds] = arguments.as_slice() else {
        println!("instructions are counted by scripts/instructions.sh");
        return;
    };
    let rounds: u32 = rounds.parse().unwrap_or(1);
    // All on this thread.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    if let Err(error) = pool.build_global() {
        eprintln!("{error}");
    }
    let parts: Vec<&str> = work.split('-').collect();
    let sum = match parts[..] {
        ["trace", by] => trace(by, rounds),
        [cloud, by, k] => gather(cloud, by, k, rounds),
        _ => None,
    };
    match sum {
        Some(sum) => println!("{sum:e}"),
        None => println!("unknown work: {work}"),
    }
}

fn fog(bounds: Bounds) -> Medium {
    Medium {
        bounds,
        extinction: MediumExtinction::Uniform(FOG),
        albedo: Rgb::splat(0.9),
        color: None,
        emissivity: None,
        phase: Phase::Isotropic,
    }
}

/// Traces, and sums what was stored.
fn trace(by: &str, rounds: u32) -> Option<f64> {
    let medium = fog(Bounds::Box { min: DVec3::NEG_ONE, max: DVec3::ONE });
    let lamp = PointLight { position: DVec3::new(0.3, 0.4, 0.2), intensity: Rgb::ONE };
    let lights = [Light::Point(lamp)];
    let opacity = |ray: &Ray| {
        medium.bounds.intersect(ray).map_or(0.0, |span| FOG.opacity(ray, span, Rgb::ONE))
    };
    let frame = MapFrame::of(&medium, None);
    let kind = EmissionKind::Random;
    let settings =
        TraceSettings { max_order: MAX_ORDER, min_stored_order: 1, max_stored: usize::MAX };
    let mut emission = Emission::new(&lights, &medium, opacity, 1.0, kind, TRACED, 0);
    let mut sum = 0.0;
    for round in 0..rounds {
        emission.reseed(u64::from(round));
        let photons = match by {
            "program" => trace_photons(&emission, &medium, &FOG, frame, settings, |_| ()).photons,
            "loop" => trace_by_loop(&emission, frame, &black_box(BOX_OF_FOG)),
            _ => return None,
        };
        sum += photons.iter().map(|p| f64::from(p.power[0] + p.position[0])).sum::<f64>();
    }
    Some(sum)
}

/// What a scene file says of fog in a box.
struct BoxOfFog {
    min: DVec3,
    max: DVec3,
    sigma_t: f64,
    albedo: Rgb,
}

const BOX_OF_FOG: BoxOfFog =
    BoxOfFog { min: DVec3::NEG_ONE, max: DVec3::ONE, sigma_t: 1.0, albedo: Rgb::splat(0.9) };

/// Tracing in a box of grey isotropic fog, and nothing else. Photons are emitted as by the program.
fn trace_by_loop(emission: &Emission, frame: MapFrame, fog: &BoxOfFog) -> Vec<Photon> {
    let mut photons = Vec::new();
    let (mut emitted, mut absorbed, mut escaped) = (Rgb::ZERO, Rgb::ZERO, Rgb::ZERO);
    for index in 0..emission.count() {
        let Some(EmittedPhoton { mut ray, mut power, first_flight, mut random, .. }) =
            emission.photon(index)
        else {
            continue;
        };
        emitted += power;
        for order in 0.. {
            let Some(span) = span_in_box(&ray, fog) else { break };
            let u = if order == 0 {
                let opacity = -(-fog.sigma_t * span.length()).exp_m1();
                let probability = (opacity * first_flight.boost).min(1.0);
                if first_flight.u >= probability {
                    break;
                }
                let share = opacity / probability;
                escaped += power * (1.0 - share);
                power *= share;
                opacity * (first_flight.u / probability)
            } else {
                uniform(&mut random)
            };
            let distance = span.start - (-u).ln_1p() / fog.sigma_t;
            if distance >= span.end {
                break;
            }
            ray.origin = ray.at(distance);
            if order >= 1 {
                photons.push(Photon {
                    position: frame.to_map(ray.origin),
                    direction: ray.direction.as_vec3().to_array(),
                    power: power.as_vec3().to_array(),
                    sigma_t: 0.0,
                    order,
                });
            }
            if order >= MAX_ORDER {
                break;
            }
            let scattered = power * fog.albedo;
            let survival = scattered.max_element() / power.max_element();
            if uniform(&mut random) >= survival {
                absorbed += power;
                power = Rgb::ZERO;
                break;
            }
            let survivor = scattered / survival;
            absorbed += power - survivor;
            power = survivor;
            let z = 2.0 * uniform(&mut random) - 1.0;
            let across = (1.0 - z * z).max(0.0).sqrt();
            let (sine, cosine) = (2.0 * std::f64::consts::PI * uniform(&mut random)).sin_cos();
            ray.direction = DVec3::new(across * cosine, across * sine, z);
        }
        escaped += power;
    }
    black_box((emitted, absorbed, escaped));
    photons
}

/// Rays parallel to faces, which hardly occur, are left to the program.
fn span_in_box(ray: &Ray, fog: &BoxOfFog) -> Option<Span> {
    let inverse = ray.direction.recip();
    if !inverse.is_finite() {
        return Bounds::Box { min: fog.min, max: fog.max }.intersect(ray);
    }
    let ascends = ray.direction.cmpgt(DVec3::ZERO);
    let near = (DVec3::select(ascends, fog.min, fog.max) - ray.origin) * inverse;
    let far = (DVec3::select(ascends, fog.max, fog.min) - ray.origin) * inverse;
    let span = Span::new(near.max_element().max(0.0), far.min_element());
    (span.end > span.start).then_some(span)
}

/// Estimates at a camera's places, and sums them.
fn gather(cloud: &str, by: &str, k: &str, rounds: u32) -> Option<f64> {
    let k: NonZeroUsize = k.parse().ok()?;
    let cloud = Cloud::ALL.into_iter().find(|each| each.name() == cloud)?;
    let map = cloud.map(MAPPED, false)?;
    let places = clouds::queries();
    let medium = fog(Bounds::Infinite);
    let options = EstimateOptions {
        k,
        constant: k.get() as f64,
        kernel: Kernel::Constant,
        max_radius: f64::INFINITY,
    };
    let mut estimator = Estimator::new(&medium, &FOG, &map, options);
    let mut finder = NearestPhotons::new(&map);
    let stored: Vec<[f32; 3]> =
        (0..map.len() as u32).map(|i| map.offset(i, [0.0; 3]).to_array()).collect();
    let tree = ImmutableKdTree::<f32, 3>::new_from_slice(&stored).ok()?;
    let mut sum = 0.0;
    for &place in (0..rounds).flat_map(|_| &places) {
        sum += match by {
            "program" => black_box(estimator.in_scattered(place, DVec3::Z, 0.5)).multiple.x,
            "loop" => black_box(gather_by_loop(&mut finder, &map, k, place)).x,
            "radius" => f64::from(finder.find(place, k, f64::INFINITY).radius),
            "kiddo" => {
                let query = place.as_vec3().to_array();
                let nearest = tree.query(&query).nearest_n::<SquaredEuclidean<f32>>(k).execute();
                nearest.last().map_or(0.0, |farthest| f64::from(farthest.distance))
            }
            _ => return None,
        };
    }
    Some(sum)
}

/// The estimate in endless isotropic fog, and nothing else.
fn gather_by_loop(
    finder: &mut NearestPhotons<'_>,
    map: &PhotonMap,
    k: NonZeroUsize,
    place: DVec3,
) -> Rgb {
    let nearest = finder.find(place, k, f64::INFINITY);
    let mut sum = Rgb::ZERO;
    for &photon in nearest.photons {
        let [r, g, b] = map.power(photon);
        sum += Rgb::new(f64::from(r), f64::from(g), f64::from(b));
    }
    let radius = f64::from(nearest.radius);
    let volume = 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius;
    sum * (ISOTROPIC / (volume * FOG.sigma_t))
}
