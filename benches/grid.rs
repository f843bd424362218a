//! Costs of a density grid's lookups and walks. `cargo bench --bench grid`; divide by the counts in the names.

use divan::{Bencher, black_box};
use photonvdb::{
    math::{Ball, DAffine3, DVec3, Ray, Rgb, Span, Stream, uniform},
    medium::{Bounds, Extinction, GridExtinction, RayProfile, grid::DensityGrid, vdb::SparseGrid},
};

fn main() {
    divan::main();
}

/// Edge of the cloud in voxels.
const EDGE: i32 = 160;
/// Rays a sample.
const RAY_COUNT: usize = 200;

/// A ball of cumulus-like noise with empty space around it.
fn cloud() -> SparseGrid<f32> {
    let (mut leaves, mut masks, mut values) = (vec![], vec![], vec![]);
    for x in (0..EDGE).step_by(8) {
        for y in (0..EDGE).step_by(8) {
            for z in (0..EDGE).step_by(8) {
                let leaf: Vec<f32> = (0..512)
                    .map(|n| density([x + (n >> 6), y + (n >> 3 & 7), z + (n & 7)]))
                    .collect();
                if leaf.iter().any(|&value| value > 0.0) {
                    leaves.push([x, y, z]);
                    masks.push([u64::MAX; 8]);
                    values.extend(leaf);
                }
            }
        }
    }
    let index_to_world = DAffine3::IDENTITY;
    SparseGrid { background: 0.0, index_to_world, leaves, masks, values, tiles: vec![] }
}

fn density(voxel: [i32; 3]) -> f32 {
    let [x, y, z] = voxel.map(|c| 2.0 * c as f32 / EDGE as f32 - 1.0);
    let radius = (x * x + y * y + z * z).sqrt();
    let mut noise = 0.0;
    for (frequency, amplitude) in [(5.0, 0.5), (11.0, 0.3), (23.0, 0.2), (47.0, 0.1)] {
        let (a, b, c) = (x * frequency, y * frequency + 1.0, z * frequency + 2.0);
        noise += amplitude * ((a + 1.7 * b).sin() * (b - c).cos() + (c + 0.5 * a).sin());
    }
    (0.7 - radius + 0.4 * noise).max(0.0)
}

/// The cloud with a given mean optical depth along its rays, the rays, and their spans.
fn scene(optical_depth: f64) -> (GridExtinction, Vec<(Ray, Span)>) {
    let mut random = Stream::Experiment.random(0, 0);
    let mut point = || DVec3::new(uniform(&mut random), uniform(&mut random), uniform(&mut random));
    let edge = f64::from(EDGE);
    let rays: Vec<(Ray, Span)> = (0..RAY_COUNT)
        .map(|_| {
            // From face to face of the cube, in all directions.
            let (from, to) = (edge * point(), edge * point());
            let direction = (to - from).normalize();
            let to_face = |sign: f64| {
                let faces = (DVec3::splat(0.5 * edge) * (1.0 + sign * direction.signum()) - from)
                    / direction;
                if sign > 0.0 { faces.min_element() } else { faces.max_element() }
            };
            (Ray::new(from, direction), Span::new(to_face(-1.0), to_face(1.0)))
        })
        .collect();
    let unit = GridExtinction::new(DensityGrid::from_sparse(&cloud()), DAffine3::IDENTITY, 1.0);
    let mean = rays.iter().map(|(ray, span)| unit.optical_depth(ray, *span).x).sum::<f64>()
        / RAY_COUNT as f64;
    let grid = DensityGrid::from_sparse(&cloud());
    (GridExtinction::new(grid, DAffine3::IDENTITY, optical_depth / mean), rays)
}

#[divan::bench(sample_count = 5)]
fn build(bencher: Bencher) {
    let sparse = cloud();
    bencher.bench_local(|| DensityGrid::from_sparse(&sparse));
}

/// Lookups half a voxel apart along the rays.
#[divan::bench]
fn lookup_10000_coherent(bencher: Bencher) {
    let (extinction, rays) = scene(1.0);
    let points: Vec<DVec3> = rays
        .iter()
        .flat_map(|(ray, span)| (0..50).map(|n| ray.at(span.start + 0.5 * f64::from(n) + 20.0)))
        .collect();
    bencher.bench_local(|| points.iter().map(|&p| extinction.sigma_t(p).x).sum::<f64>());
}

/// Lookups anywhere in the cloud.
#[divan::bench]
fn lookup_10000_scattered(bencher: Bencher) {
    let (extinction, _) = scene(1.0);
    let mut random = Stream::Experiment.random(1, 0);
    let mut point = || DVec3::new(uniform(&mut random), uniform(&mut random), uniform(&mut random));
    let points: Vec<DVec3> = (0..10_000).map(|_| (0.2 + 0.6 * point()) * f64::from(EDGE)).collect();
    bencher.bench_local(|| points.iter().map(|&p| extinction.sigma_t(p).x).sum::<f64>());
}

/// Exact optical depth of 200 rays.
#[divan::bench]
fn optical_depth_200(bencher: Bencher) {
    let (extinction, rays) = scene(1.0);
    bencher.bench_local(|| {
        rays.iter().map(|(ray, span)| extinction.optical_depth(ray, *span).x).sum::<f64>()
    });
}

/// Free flights by delta tracking, 200 rays through the whole cloud.
#[divan::bench(args = [0.05, 0.5, 5.0, 50.0])]
fn sample_flight_200(bencher: Bencher, optical_depth: f64) {
    let (extinction, rays) = scene(optical_depth);
    let mut random = Stream::Experiment.random(2, 0);
    bencher.bench_local(|| {
        for (ray, span) in &rays {
            black_box(extinction.sample_flight(ray, *span, Rgb::ONE, &mut random));
        }
    });
}

/// Free flights by exact inversion.
#[divan::bench(args = [0.5, 5.0, 50.0])]
fn invert_flight_200(bencher: Bencher, optical_depth: f64) {
    let (extinction, rays) = scene(optical_depth);
    let mut random = Stream::Experiment.random(2, 0);
    bencher.bench_local(|| {
        for (ray, span) in &rays {
            black_box(extinction.invert_flight(ray, *span, Rgb::ONE, uniform(&mut random)));
        }
    });
}

/// Filling the profiles of 200 rays.
#[divan::bench]
fn profile_200(bencher: Bencher) {
    let (extinction, rays) = scene(1.0);
    let mut profile = RayProfile::default();
    bencher.bench_local(|| {
        for (ray, span) in &rays {
            extinction.profile(ray, *span, &mut profile);
            black_box(&profile);
        }
    });
}

/// 10,000 inversions of one profile.
#[divan::bench]
fn profile_distance_at_10000(bencher: Bencher) {
    let (extinction, rays) = scene(1.0);
    let mut profile = RayProfile::default();
    extinction.profile(&rays[0].0, rays[0].1, &mut profile);
    let total = extinction.optical_depth(&rays[0].0, rays[0].1).x;
    bencher.bench_local(|| {
        (0..10_000).map(|n| profile.distance_at(total * f64::from(n) / 1e4, 0)).sum::<f64>()
    });
}

/// 10,000 transmittances of one profile.
#[divan::bench]
fn profile_transmittance_10000(bencher: Bencher) {
    let (extinction, rays) = scene(1.0);
    let mut profile = RayProfile::default();
    let (ray, span) = &rays[0];
    extinction.profile(ray, *span, &mut profile);
    bencher.bench_local(|| {
        (0..10_000)
            .map(|n| profile.transmittance(span.start + span.length() * f64::from(n) / 1e4).x)
            .sum::<f64>()
    });
}

/// 200 balls of three voxels' radius.
#[divan::bench]
fn ball_extinction_200(bencher: Bencher) {
    let (extinction, rays) = scene(1.0);
    bencher.bench_local(|| {
        rays.iter()
            .map(|(ray, span)| {
                let ball = Ball { center: ray.at(0.5 * (span.start + span.end)), radius: 3.0 };
                extinction.ball_moments(&Bounds::Infinite, ball, 1e30, 0.3, 0.0).mass
            })
            .sum::<f64>()
    });
}
