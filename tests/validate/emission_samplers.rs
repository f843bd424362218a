//! Samplers of emission against their densities: of places and directions at lights, in a medium that glows, and guided.

use std::f64::consts::PI;

use photonvdb::emission::{Emitter, Guide};
use photonvdb::light::{DirectionalLight, Light, PointLight, QuadLight, SpotLight};
use photonvdb::math::DAffine3;
use photonvdb::math::square_maps::versine;
use photonvdb::math::{DVec2, DVec3, Ray, Rgb, Stream, uniform};
use photonvdb::medium::vdb::{Limits, SparseGrid};
use photonvdb::medium::{Bounds, Emissivity, Flame, ValueGrid};

use crate::samplers::{COUNT, assert_counts, assert_uniform, azimuth, point, random, solid_angle};
use crate::transport_support::*;

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
        is_visible: true,
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
