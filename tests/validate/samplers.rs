//! Samplers against their densities: by Kolmogorov and Smirnov where there is a distribution function, by chi^2 over bins, and
//! by the weights of samples where they carry them.

use std::f64::consts::PI;

use photonvdb::emission::{Emitter, Guide};
use photonvdb::light::{
    DirectionalLight, Environment, EnvironmentImage, Light, PointLight, QuadLight, SphereLight,
    SpotLight,
};
use photonvdb::math::DAffine3;
use photonvdb::math::square_maps::versine;
use photonvdb::math::{
    DVec2, DVec3, Frame, Random, Ray, Rgb, Span, SphericalTriangle, Stream, uniform,
};
use photonvdb::medium::vdb::{Limits, SparseGrid};
use photonvdb::medium::{
    BoostedQuantile, Bounds, ChromaticExtinction, Emissivity, Extinction, Flame, Flight, Lobe,
    Phase, RayProfile, UniformExtinction, ValueGrid,
};

use crate::transport_support::*;

const COUNT: usize = 50_000;

fn random(case: u64) -> Random {
    Stream::Experiment.random(77, case)
}

fn point(random: &mut Random) -> DVec2 {
    DVec2::new(uniform(random), uniform(random))
}

/// Demands that quantiles are uniform in \[0, 1\]: exceeded by chance once in 100 000.
fn assert_uniform(mut quantiles: Vec<f64>, what: &str) {
    quantiles.sort_by(f64::total_cmp);
    let count = quantiles.len() as f64;
    let far = |(n, q): (usize, &f64)| {
        (q - n as f64 / count).abs().max((q - (n + 1) as f64 / count).abs())
    };
    let distance = quantiles.iter().enumerate().map(far).fold(0.0, f64::max) * count.sqrt();
    assert!(distance < 2.47, "{what}: Kolmogorov-Smirnov {distance}");
}

/// Demands that counts follow probabilities: chi^2 to a normal variate by Wilson and Hilferty.
fn assert_counts(counts: &[f64], probabilities: &[f64], what: &str) {
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
fn azimuth(direction: DVec3, axis: DVec3) -> f64 {
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
fn solid_angle(eye: DVec3, corner: DVec3, u: DVec3, v: DVec3) -> f64 {
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

    let sphere = SphereLight { center: DVec3::new(1.0, 2.0, 0.5), radius: 0.8, radiance: Rgb::ONE };
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

const BOX: Bounds = Bounds::Box { min: DVec3::NEG_ONE, max: DVec3::new(1.0, 2.0, 0.5) };

fn rays(emitter: &Emitter, case: u64) -> Vec<(Ray, Rgb)> {
    let mut random = random(case);
    let draws = (0..COUNT).map(|_| std::array::from_fn(|_| uniform(&mut random)));
    draws.filter_map(|u| emitter.sample_ray(u)).collect()
}

/// Directions of a point light into a ball and a box are uniform in the solid angle of these.
#[test]
fn aimed_points() {
    let position = DVec3::new(4.0, 3.0, 2.0);
    let light = Light::Point(PointLight { position, intensity: Rgb::ONE });
    let inside = ball(1.3);
    let to_ball = rays(&Emitter::new(&light, &inside), 140);
    let largest = versine((1.3 / position.length()).asin());
    let axis = -position.normalize();
    let caps = to_ball.iter().map(|(ray, _)| (1.0 - ray.direction.dot(axis)) / largest);
    assert_uniform(caps.collect(), "ball, cosine");
    assert_uniform(
        to_ball.iter().map(|(ray, _)| azimuth(ray.direction, axis)).collect(),
        "ball, azimuth",
    );

    let faces = BOX.parallelepiped().unwrap().faces();
    let side = 3;
    let mut cells = Vec::new();
    for face in faces {
        for n in 0..side * side {
            let [u, v] = face.edges.map(|edge| edge / f64::from(side));
            let corner = face.corner + u * f64::from(n % side) + v * f64::from(n / side);
            let is_visible = face.area_normal.dot(position - face.corner) > 0.0;
            cells.push(if is_visible { solid_angle(position, corner, u, v) } else { 0.0 });
        }
    }
    let whole: f64 = cells.iter().sum();
    let mut counts = vec![0.0; cells.len()];
    for (ray, power) in rays(&Emitter::new(&light, &BOX), 141) {
        assert!((power.x / whole - 1.0).abs() < 1e-9, "{power} {whole}");
        let entry = ray.at(BOX.intersect(&ray).unwrap().start);
        let depth = |face: &photonvdb::medium::Face| {
            face.area_normal.normalize().dot(entry - face.corner).abs()
        };
        let number = (0..6).min_by(|&a, &b| depth(&faces[a]).total_cmp(&depth(&faces[b]))).unwrap();
        let offset = entry - faces[number].corner;
        let index = |edge: DVec3| {
            let along = offset.dot(edge) / edge.length_squared();
            ((along * f64::from(side)) as i32).clamp(0, side - 1)
        };
        let [u, v] = faces[number].edges;
        counts[number * 9 + (index(v) * side + index(u)) as usize] += 1.0;
    }
    let probabilities: Vec<f64> = cells.iter().map(|cell| cell / whole).collect();
    assert_counts(&counts, &probabilities, "faces of a box");
}

/// Power by angle from the axis follows the falloff, both where the cone is sampled and where the bounds are.
#[test]
fn spots_by_their_falloff() {
    let position = DVec3::new(0.0, 0.0, -6.0);
    for (case, bounds) in [ball(3.0), ball(1.5)].into_iter().enumerate() {
        let spot = SpotLight {
            position,
            axis: DVec3::Z,
            intensity: Rgb::ONE,
            cone_angle: if case == 0 { 0.3 } else { 1.0 },
            falloff_angle: 0.1,
        };
        let light = Light::Spot(spot);
        let emitter = Emitter::new(&light, &bounds);
        let reach = if case == 0 { 0.3 } else { (0.25_f64).asin() };
        let bins = 10;
        let edge = |n: usize| reach * n as f64 / bins as f64;
        let exact = |n: usize| {
            let steps = 2000;
            let step = (edge(n + 1) - edge(n)) / f64::from(steps);
            let angle = |i: i32| edge(n) + (f64::from(i) + 0.5) * step;
            let rings = (0..steps).map(|i| spot.falloff(angle(i)) * angle(i).sin());
            2.0 * PI * step * rings.sum::<f64>()
        };
        let batches: Vec<Vec<f64>> = (0..64)
            .map(|batch| {
                let mut random = Stream::Experiment.random(150 + case as u64, batch);
                let mut sums = vec![0.0; bins];
                let count = 2000;
                for _ in 0..count {
                    let u = std::array::from_fn(|_| uniform(&mut random));
                    let Some((ray, power)) = emitter.sample_ray(u) else { continue };
                    let bin = (spot.angle_to(ray.direction) / reach * bins as f64) as usize;
                    sums[bin.min(bins - 1)] += power.x / f64::from(count);
                }
                sums
            })
            .collect();
        for bin in 0..bins {
            let power = Runs::of(batches.iter().map(|sums| sums[bin]));
            power.assert_is(exact(bin), &format!("case {case}, ring {bin}"));
        }
    }
}

/// Parallel light is uniform over the outline, light from all sides over the surface and by cosine.
#[test]
fn outlines_and_surfaces() {
    let direction = DVec3::new(0.6, -0.48, 0.64);
    let sun = Light::Directional(DirectionalLight { direction, irradiance: Rgb::ONE });
    let bounds = ball(1.3);
    let discs = rays(&Emitter::new(&sun, &bounds), 160);
    let squares = discs.iter().map(|(ray, _)| {
        let offset = ray.origin - direction * ray.origin.dot(direction);
        offset.length_squared() / 1.69
    });
    assert_uniform(squares.collect(), "disc, squared radius");

    let sky = white_sky();
    let emitter = Emitter::new(&sky, &BOX);
    let shape = BOX.parallelepiped().unwrap();
    let faces = shape.faces();
    let area: f64 = faces.iter().map(|face| face.area_normal.length()).sum();
    let mut counts = vec![0.0; 6];
    let (mut squares, mut across) = (Vec::new(), Vec::new());
    for (ray, power) in rays(&emitter, 161) {
        assert!((power.x / (PI * area) - 1.0).abs() < 1e-12);
        let entry = ray.at(BOX.intersect(&ray).unwrap().start);
        let depth = |face: &photonvdb::medium::Face| {
            face.area_normal.normalize().dot(entry - face.corner).abs()
        };
        let number = (0..6).min_by(|&a, &b| depth(&faces[a]).total_cmp(&depth(&faces[b]))).unwrap();
        counts[number] += 1.0;
        squares.push(faces[number].area_normal.normalize().dot(ray.direction).powi(2));
        let edge = faces[number].edges[0];
        across.push((entry - faces[number].corner).dot(edge) / edge.length_squared());
    }
    let shares: Vec<f64> = faces.iter().map(|face| face.area_normal.length() / area).collect();
    assert_counts(&counts, &shares, "faces by area");
    assert_uniform(squares, "squared cosine");
    assert_uniform(across, "place across a face");
}

/// Power from area lights by the place it starts from.
#[test]
fn emission_of_quads_is_even_over_their_area() {
    let quad = QuadLight {
        corner: DVec3::new(-0.5, 0.3, -0.5),
        edge_u: DVec3::Z,
        edge_v: DVec3::X,
        radiance: Rgb::ONE,
    };
    let light = Light::Quad(quad);
    let bounds = ball(2.0);
    let samples = rays(&Emitter::new(&light, &bounds), 170);
    assert_uniform(samples.iter().map(|(ray, _)| ray.origin.x + 0.5).collect(), "place");
    assert_uniform(
        samples.iter().map(|(ray, _)| ray.direction.y.powi(2)).collect(),
        "squared cosine",
    );
}

/// Places in a medium that glows: weighted by the inverse of their density they fill space evenly, and as often as that
/// density says they lie where it glows.
#[test]
fn emissive_cells() {
    let field = |x: usize| if x < 4 { 1.0 } else { 3.0_f32 };
    let grid = SparseGrid {
        background: 0.0,
        index_to_world: DAffine3::IDENTITY,
        leaves: vec![[0; 3]],
        masks: vec![[u64::MAX; 8]],
        values: (0..512).map(|n| field(n >> 6)).collect(),
        tiles: Vec::new(),
    };
    let place = DAffine3::from_scale_rotation_translation(
        DVec3::splat(0.25),
        glam::DQuat::IDENTITY,
        DVec3::splat(-0.875),
    );
    let grid = ValueGrid::new(&grid, place, &Limits::default()).unwrap().unwrap();
    let flame = Flame { grid, color: Rgb::ONE };
    let medium =
        grey_fog(CUBE, 1.0, 0.9, 0.0).with_emissivity(Emissivity::new(None, Some(flame), 1.0));
    let cells = medium.emissivity.as_ref().unwrap().cells().unwrap();
    let octant = |p: DVec3| (0..3).map(|axis| usize::from(p[axis] > 0.0) << axis).sum::<usize>();
    let batches: Vec<([f64; 8], [f64; 8])> = (0..64)
        .map(|batch| {
            let mut random = Stream::Experiment.random(180, batch);
            let (mut volumes, mut powers) = ([0.0; 8], [0.0; 8]);
            for _ in 0..2000 {
                let sample = cells.sample_place(std::array::from_fn(|_| uniform(&mut random)));
                let power = medium.emissivity_at(sample.position).x * sample.volume;
                volumes[octant(sample.position)] += sample.volume / 2000.0;
                powers[octant(sample.position)] += power / 2000.0;
            }
            (volumes, powers)
        })
        .collect();
    // The emissivity over an octant by the midpoint rule.
    let steps = 80;
    let exact = |number: usize| {
        let at = |i: usize, axis: usize| {
            let inside = (i as f64 + 0.5) / steps as f64;
            if number >> axis & 1 == 1 { inside } else { inside - 1.0 }
        };
        let lines = (0..steps * steps * steps).map(|n| {
            let place =
                DVec3::new(at(n / steps / steps, 0), at(n / steps % steps, 1), at(n % steps, 2));
            medium.emissivity_at(place).x
        });
        lines.sum::<f64>() / (steps * steps * steps) as f64
    };
    for number in 0..8 {
        let volume = Runs::of(batches.iter().map(|batch| batch.0[number]));
        volume.assert_is(1.0, &format!("volume of octant {number}"));
        let power = Runs::of(batches.iter().map(|batch| batch.1[number]));
        let exact = exact(number);
        power.assert_within(exact, 1e-3 * exact, &format!("power of octant {number}"));
    }
    // Drawn by what they emit, places are worth nearly the same.
    let total = Runs::of(batches.iter().map(|batch| batch.1.iter().sum()));
    assert!(total.error < 0.001 * total.mean, "{total:?}");
}

/// Guided places fall where their density says.
#[test]
fn guides() {
    let opacity = |p: DVec2| (1.0 - 20.0 * (p - DVec2::new(0.3, 0.6)).length_squared()).max(0.0);
    let (guide, _) = Guide::new(&mut random(190), opacity).unwrap();
    let batches: Vec<[f64; 16]> = (0..64)
        .map(|batch| {
            let mut random = Stream::Experiment.random(191, batch);
            let mut areas = [0.0; 16];
            for _ in 0..4000 {
                let (place, density) = guide.warp(point(&mut random));
                let cell = (4.0 * place.y) as usize * 4 + (4.0 * place.x) as usize;
                areas[cell] += 1.0 / density / 4000.0;
            }
            areas
        })
        .collect();
    for cell in 0..16 {
        let area = Runs::of(batches.iter().map(|areas| areas[cell]));
        area.assert_is(1.0 / 16.0, &format!("area of cell {cell}"));
    }
}
