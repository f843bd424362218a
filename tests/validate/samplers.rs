//! Samplers against their densities: by Kolmogorov and Smirnov where there is a distribution function, by chi^2 over bins, and
//! by the weights of samples where they carry them.

use std::f64::consts::PI;

use photonvdb::light::{Environment, EnvironmentImage, QuadLight, SphereLight};
use photonvdb::math::square_maps::versine;
use photonvdb::math::{
    DVec2, DVec3, Frame, Random, Ray, Rgb, Span, SphericalTriangle, Stream, uniform,
};
use photonvdb::medium::{
    BoostedQuantile, ChromaticExtinction, Extinction, Flight, Lobe, Phase, RayProfile,
    UniformExtinction,
};

use crate::transport_support::*;

pub const COUNT: usize = 50_000;

pub fn random(case: u64) -> Random {
    Stream::Experiment.random(77, case)
}

pub fn point(random: &mut Random) -> DVec2 {
    DVec2::new(uniform(random), uniform(random))
}

/// Demands that quantiles are uniform in \[0, 1\]: exceeded by chance once in 100 000.
pub fn assert_uniform(mut quantiles: Vec<f64>, what: &str) {
    quantiles.sort_by(f64::total_cmp);
    let count = quantiles.len() as f64;
    let far = |(n, q): (usize, &f64)| {
        (q - n as f64 / count).abs().max((q - (n + 1) as f64 / count).abs())
    };
    let distance = quantiles.iter().enumerate().map(far).fold(0.0, f64::max) * count.sqrt();
    assert!(distance < 2.47, "{what}: Kolmogorov-Smirnov {distance}");
}

/// Demands that counts follow probabilities: chi^2 to a normal variate by Wilson and Hilferty.
pub fn assert_counts(counts: &[f64], probabilities: &[f64], what: &str) {
    let total: f64 = counts.iter().sum();
    let mut chi = 0.0;
    for (count, probability) in counts.iter().zip(probabilities) {
        let expected = probability * total;
        if expected == 0.0 {
            assert_eq!(*count, 0.0, "{what}");
            continue;
        }
        chi += (count - expected).powi(2) / expected;
    }
    let freedom = probabilities.iter().filter(|p| **p > 0.0).count() as f64 - 1.0;
    if freedom == 0.0 {
        return;
    }
    let spread = 2.0 / (9.0 * freedom);
    let z = ((chi / freedom).cbrt() - (1.0 - spread)) / spread.sqrt();
    assert!(z < LARGEST_Z, "{what}: chi^2 {chi} for {freedom}, z {z}");
}

/// The angle of a direction about an axis, as a share of a turn.
pub fn azimuth(direction: DVec3, axis: DVec3) -> f64 {
    let frame = Frame::about(axis);
    let angle = direction.dot(frame.bitangent).atan2(direction.dot(frame.tangent));
    (angle / (2.0 * PI)).rem_euclid(1.0)
}

/// Distribution function of Henyey and Greenstein's cosine.
fn scattered_below(g: f64, cosine: f64) -> f64 {
    if g.abs() < 1e-3 {
        return 0.5 * (1.0 + cosine) - 0.75 * g * (1.0 - cosine * cosine);
    }
    let root = (1.0 + g * g - 2.0 * g * cosine).sqrt();
    (1.0 - g * g) / (2.0 * g) * (1.0 / root - 1.0 / (1.0 + g))
}

#[test]
fn phase_functions() {
    let axis = DVec3::new(0.48, -0.6, 0.64);
    for (case, g) in [-0.95, -0.3, 1e-5, 0.0, 0.29, 0.31, 0.85, 0.99].into_iter().enumerate() {
        let phase = if g == 0.0 { Phase::Isotropic } else { Phase::HenyeyGreenstein { g } };
        let mut random = random(case as u64);
        let directions: Vec<DVec3> =
            (0..COUNT).map(|_| phase.sample_direction(axis, &mut random)).collect();
        let cosines = directions.iter().map(|d| scattered_below(g, d.dot(axis)));
        assert_uniform(cosines.collect(), &format!("cosine, g {g}"));
        let turns = directions.iter().map(|d| azimuth(*d, axis));
        assert_uniform(turns.collect(), &format!("azimuth, g {g}"));
    }
}

/// Cosines of every other phase function in bins ever narrower towards both ends, against the density over each.
#[test]
fn phase_functions_of_lobes() {
    let axis = DVec3::new(0.48, -0.6, 0.64);
    let mut phases = vec![
        Phase::draine(0.0, 1.0),
        Phase::draine(1e-6, 40.0),
        Phase::draine(0.6, 1e-7),
        Phase::draine(-0.99, 1.0),
        Phase::draine(0.99, 30.0),
        Phase::draine(0.5, 1e12),
    ];
    for (g1, g2, weight) in [(0.8, -0.4, 0.9), (0.99, -0.99, 0.5), (0.5, 0.0, 1e-3)] {
        let [first, second] = [g1, g2].map(Lobe::henyey_greenstein);
        phases.push(Phase::two_lobes(first, second, weight));
    }
    phases.extend([5.0, 12.0, 20.0, 50.0].map(Phase::droplets));
    // 1 - |cos| at 40 edges: the diffraction peak of large droplets is 1e-5 wide.
    let rest = |i: f64| (1.0 - (i / 20.0).abs()).powi(4);
    let cosine = |i: f64| if i < 0.0 { rest(i) - 1.0 } else { 1.0 - rest(i) };
    for (case, phase) in phases.into_iter().enumerate() {
        let mut random = random(60 + case as u64);
        let mut counts = vec![0.0; 40];
        let mut turns = Vec::new();
        for _ in 0..4 * COUNT {
            let direction = phase.sample_direction(axis, &mut random);
            let cosine = direction.dot(axis).clamp(-1.0, 1.0);
            let from_end = (1.0 - cosine.abs()).powf(0.25);
            let bin = 20.0 + cosine.signum() * 20.0 * (1.0 - from_end);
            counts[(bin as usize).min(39)] += 1.0;
            turns.push(azimuth(direction, axis));
        }
        let share = |i: i32| {
            let steps = 400;
            let node = |j: i32| f64::from(i) + f64::from(j) / f64::from(steps);
            let piece = |j: i32| {
                let (low, high) = (cosine(node(j)), cosine(node(j + 1)));
                let middle = phase.density(0.5 * (low + high));
                let ends = phase.density(low) + phase.density(high);
                (high - low) / 6.0 * (ends + 4.0 * middle)
            };
            2.0 * PI * (0..steps).map(piece).sum::<f64>()
        };
        let probabilities: Vec<f64> = (-20..20).map(share).collect();
        let total: f64 = probabilities.iter().sum();
        assert!((total - 1.0).abs() < 1e-5, "{phase:?}: {total}");
        assert_counts(&counts, &probabilities, &format!("cosine, {phase:?}"));
        assert_uniform(turns, &format!("azimuth, {phase:?}"));
    }
}

fn distances(
    extinction: &impl Extinction,
    span: Span,
    power: Rgb,
    random: &mut Random,
) -> (Vec<f64>, usize) {
    let ray = Ray::new(DVec3::ZERO, DVec3::X);
    let flights = (0..COUNT).map(|_| extinction.sample_flight(&ray, span, power, random));
    let collisions: Vec<f64> = flights
        .filter_map(|flight| match flight {
            Flight::Collision { distance, .. } => Some(distance),
            Flight::Escape { .. } => None,
        })
        .collect();
    let escaped = COUNT - collisions.len();
    (collisions, escaped)
}

#[test]
fn free_flights() {
    let span = Span::new(0.5, 2.5);
    let power = Rgb::new(1.0, 0.3, 0.7);
    let share = power / power.element_sum();
    for (case, sigma_t) in [Rgb::splat(0.7), Rgb::new(0.2, 1.0, 4.0)].into_iter().enumerate() {
        let below = |length: f64| {
            1.0 - (0..3).map(|c| share[c] * (-sigma_t[c] * length).exp()).sum::<f64>()
        };
        let mut random = random(100 + case as u64);
        let (collisions, escaped) = match case {
            0 => distances(&UniformExtinction { sigma_t: 0.7 }, span, power, &mut random),
            _ => distances(&ChromaticExtinction { sigma_t }, span, power, &mut random),
        };
        let opacity = below(span.length());
        let quantiles = collisions.iter().map(|d| below(d - span.start) / opacity);
        assert_uniform(quantiles.collect(), &format!("flights, sigma_t {sigma_t}"));
        let counts = [escaped as f64, collisions.len() as f64];
        assert_counts(&counts, &[1.0 - opacity, opacity], "escapes");
    }
}

/// A flight made likelier: as often as promised, worth its share, and where flights end by nature.
#[test]
fn boosted_first_flights() {
    let extinction = UniformExtinction { sigma_t: 0.7 };
    let (ray, span) = (Ray::new(DVec3::ZERO, DVec3::X), Span::new(0.0, 0.5));
    let opacity = 1.0 - (-0.35_f64).exp();
    let mut profile = RayProfile::default();
    for (case, boost) in [1.0, 2.0, 10.0].into_iter().enumerate() {
        let mut random = random(110 + case as u64);
        let mut quantiles = Vec::new();
        for _ in 0..COUNT {
            let boosted = BoostedQuantile { u: uniform(&mut random), boost };
            let flown =
                extinction.boosted_flight(&ray, span, Rgb::ONE, boosted, &mut profile, false);
            if let Flight::Collision { distance, .. } = flown.flight {
                assert!((flown.share * (opacity * boost).min(1.0) - opacity).abs() < 1e-12);
                quantiles.push((1.0 - (-0.7 * distance).exp()) / opacity);
            }
        }
        let probability = (opacity * boost).min(1.0);
        let counts = [quantiles.len() as f64, (COUNT - quantiles.len()) as f64];
        assert_counts(&counts, &[probability, 1.0 - probability], "how often");
        assert_uniform(quantiles, "where");
    }
}

/// Solid angle of a parallelogram.
pub fn solid_angle(eye: DVec3, corner: DVec3, u: DVec3, v: DVec3) -> f64 {
    let (p, q) = (corner + u, corner + v);
    let halves = [[corner, p, q], [p + v, q, p]];
    halves.iter().filter_map(|t| SphericalTriangle::seen_from(eye, *t)).map(|t| t.solid_angle).sum()
}

/// Directions towards area lights are uniform in the solid angle that they fill.
#[test]
fn illumination_by_area_lights() {
    let quad = QuadLight {
        corner: DVec3::new(-0.5, 0.7, 0.4),
        edge_u: DVec3::new(0.0, 0.2, -0.8),
        edge_v: DVec3::new(0.9, 0.1, 0.0),
        radiance: Rgb::ONE,
        is_visible: true,
    };
    let place = DVec3::new(0.1, -0.3, 0.1);
    let side = 6;
    let (u, v) = (quad.edge_u / f64::from(side), quad.edge_v / f64::from(side));
    let cell = |i: i32, j: i32| quad.corner + u * f64::from(i) + v * f64::from(j);
    let cells = (0..side * side).map(|n| solid_angle(place, cell(n % side, n / side), u, v));
    let cells: Vec<f64> = cells.collect();
    let whole: f64 = cells.iter().sum();
    let mut counts = vec![0.0; cells.len()];
    let mut random = random(120);
    for _ in 0..COUNT {
        let sample = quad.sample_illumination(place, point(&mut random)).unwrap();
        assert!((sample.irradiance.x / whole - 1.0).abs() < 1e-9);
        let offset = place + sample.direction * sample.distance - quad.corner;
        // Coordinates along the edges, by the reciprocal basis.
        let normal = quad.area_normal();
        let along = offset.cross(quad.edge_v).dot(normal) / normal.length_squared();
        let up = quad.edge_u.cross(offset).dot(normal) / normal.length_squared();
        let index = |x: f64| ((x * f64::from(side)) as i32).clamp(0, side - 1);
        counts[(index(up) * side + index(along)) as usize] += 1.0;
    }
    let probabilities: Vec<f64> = cells.iter().map(|cell| cell / whole).collect();
    assert_counts(&counts, &probabilities, "quad");

    let sphere = SphereLight {
        center: DVec3::new(1.0, 2.0, 0.5),
        radius: 0.8,
        radiance: Rgb::ONE,
        is_visible: true,
    };
    let axis = (sphere.center - place).normalize();
    let sine = sphere.radius / (sphere.center - place).length();
    let largest = versine(sine.asin());
    let samples: Vec<DVec3> = (0..COUNT)
        .map(|_| sphere.sample_illumination(place, point(&mut random)).unwrap().direction)
        .collect();
    let caps = samples.iter().map(|d| (1.0 - d.dot(axis)) / largest);
    assert_uniform(caps.collect(), "sphere, cosine");
    assert_uniform(samples.iter().map(|d| azimuth(*d, axis)).collect(), "sphere, azimuth");
}

fn painted() -> Vec<[f32; 3]> {
    (0..32)
        .map(|i| [((i * 7) % 5) as f32, (i % 3) as f32, if i == 13 { 40.0 } else { 0.5 }])
        .collect()
}

#[test]
fn environment_images() {
    let (width, height) = (8, 4);
    let pixels = painted();
    let environment =
        Environment::Image(Box::new(EnvironmentImage::new(width, height, pixels.clone(), 0.0)));
    let edge = |row: usize| (PI * row as f64 / height as f64).cos();
    let weight = |i: usize| {
        let mean: f32 = pixels[i].iter().sum();
        f64::from(mean) * (edge(i / width) - edge(i / width + 1))
    };
    let total: f64 = (0..32).map(weight).sum();
    let probabilities: Vec<f64> = (0..32).map(|i| weight(i) / total).collect();
    let mut counts = vec![0.0; 32];
    let mut heights = Vec::new();
    let mut random = random(130);
    for _ in 0..COUNT {
        let sample = environment.sample_direction(point(&mut random));
        let turn = sample.direction.x.atan2(-sample.direction.z) / (2.0 * PI) + 0.5;
        let column = ((turn * width as f64) as usize).min(width - 1);
        let row = ((sample.direction.y.acos() / PI * height as f64) as usize).min(height - 1);
        counts[row * width + column] += 1.0;
        let pdf = environment.pdf_direction(sample.direction);
        assert!((sample.pdf / pdf - 1.0).abs() < 1e-9);
        // Within a pixel the height is uniform.
        if row == 1 {
            heights.push((edge(1) - sample.direction.y) / (edge(1) - edge(2)));
        }
    }
    assert_counts(&counts, &probabilities, "pixels");
    assert_uniform(heights, "height within a row");
}
