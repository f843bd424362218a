//! Bricks of 16-bit values against bricks of 32-bit values.

use std::path::Path;

use crate::grid_support::{Voxels, cloud};
use photonvdb::{
    math::{DAffine3, DVec3, Ray, Rgb, Span, Stream, uniform},
    medium::{
        Bounds, Extinction, Flight, GridExtinction,
        grid::{BrickPrecision, DensityGrid},
        vdb::{Limits, SparseGrid, VdbFile, VolumeSource, find_density},
    },
};

/// The relative error of rounding to 11 significant bits.
const ROUNDING: f64 = 1.0 / 2048.0;

fn build(sparse: &SparseGrid<f32>, precision: BrickPrecision) -> DensityGrid {
    DensityGrid::build(sparse, precision, &Limits::default()).unwrap()
}

fn media(name: &str) -> SparseGrid<f32> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("media").join(name);
    let file = VdbFile::open(&path).unwrap();
    let index = find_density(&file, "density", false).unwrap();
    file.load_scalar(index, &Limits::default()).unwrap()
}

/// Points in the render bounds.
fn points(grid: &DensityGrid, count: usize) -> Vec<DVec3> {
    let (min, max) = grid.render_bounds().unwrap();
    let mut random = Stream::Experiment.random(7, 0);
    let mut unit = || DVec3::new(uniform(&mut random), uniform(&mut random), uniform(&mut random));
    (0..count).map(|_| min + (max - min) * unit()).collect()
}

#[test]
fn half_is_single_within_its_rounding() {
    for name in ["smoke_plume.vdb", "cloud.vdb", "fire.vdb"] {
        let sparse = media(name);
        let [single, half] = [BrickPrecision::Single, BrickPrecision::Half]
            .map(|precision| build(&sparse, precision));
        let max = f64::from(single.statistics().max_density);
        let mut worst = 0.0_f64;
        for point in points(&single, 100_000) {
            let exact = single.density(point);
            let error = (half.density(point) - exact).abs();
            // Every corner is off by its rounding at most, and so is any blend of them.
            assert!(error <= ROUNDING * exact + 2f64.powi(-39) * max, "{name}: {point}");
            worst = worst.max(error / exact.max(1e-9 * max));
        }
        println!("{name}: largest relative error of the density {worst:.2e}");
        assert!(worst > ROUNDING / 8.0, "{worst}");
        let bytes = |grid: &DensityGrid| grid.statistics().memory_bytes as f64;
        let ratio = bytes(&half) / bytes(&single);
        assert!((0.5..0.6).contains(&ratio), "{name}: {ratio}");
        assert_eq!(half.statistics().brick_count, single.statistics().brick_count);
    }
}

#[test]
fn half_changes_transmittance_by_its_rounding_of_the_depth() {
    let sparse = media("cloud.vdb");
    let place = |precision| {
        let grid = build(&sparse, precision);
        GridExtinction::new(grid, DAffine3::IDENTITY, 0.3)
    };
    let (single, half) = (place(BrickPrecision::Single), place(BrickPrecision::Half));
    let ends = points(single.grid(), 4000);
    let mut worst = 0.0_f64;
    for pair in ends.chunks_exact(2) {
        let offset = pair[1] - pair[0];
        let ray = Ray::new(pair[0], offset.normalize());
        let span = Span::new(0.0, offset.length());
        let depth = single.optical_depth(&ray, span).x;
        let error = (half.optical_depth(&ray, span).x - depth).abs();
        assert!(error <= ROUNDING * depth + 1e-9, "{depth} {error}");
        let transmittance = |grid: &GridExtinction| grid.transmittance(&ray, span).x;
        worst = worst.max((transmittance(&half) - transmittance(&single)).abs());
    }
    println!("largest difference of transmittances {worst:.2e}");
    // x exp(-x) is at most 1/e.
    assert!(worst <= ROUNDING / std::f64::consts::E, "{worst}");
}

/// Delta tracking against a majorant that is too small has a bias; it must fit the exact transmittance.
#[test]
fn free_flights_in_half_follow_the_density_in_half() {
    let sparse = cloud(12).sparse();
    let extinction =
        GridExtinction::new(build(&sparse, BrickPrecision::Half), DAffine3::IDENTITY, 0.4);
    let ray = Ray::new(DVec3::new(-20.0, 0.3, 0.7), DVec3::X);
    let span = Span::new(0.0, 40.0);
    let truth = extinction.transmittance(&ray, span).x;
    let batches: Vec<f64> = (0..64)
        .map(|batch| {
            let mut random = Stream::Experiment.random(batch, 11);
            let escapes = (0..2000).filter(|_| {
                let flight = extinction.sample_flight(&ray, span, Rgb::ONE, &mut random);
                matches!(flight, Flight::Escape { .. })
            });
            escapes.count() as f64 / 2000.0
        })
        .collect();
    let mean = batches.iter().sum::<f64>() / 64.0;
    let variance = batches.iter().map(|b| (b - mean).powi(2)).sum::<f64>() / 63.0;
    let z = (mean - truth) / (variance / 64.0).sqrt();
    assert!(z.abs() < 4.5, "{mean} for {truth}, z = {z}");
}

#[test]
fn no_density_is_too_large_or_too_small_for_half() {
    for scale in [1e-44, 1e-38, 1e-6, 1.0, 7e4, 1e30, 2.4e38] {
        let voxels =
            Voxels::of_field([0; 3], [15; 3], |[x, y, z]| scale * f64::from(1 + x * y + z) / 300.0);
        let sparse = voxels.sparse();
        let grid = build(&sparse, BrickPrecision::Half);
        let single = build(&sparse, BrickPrecision::Single);
        for n in 0..16 {
            let point = DVec3::splat(f64::from(n));
            let (found, exact) = (grid.density(point), single.density(point));
            assert!((found - exact).abs() <= ROUNDING * exact, "{found} for {exact}");
        }
        assert!(grid.statistics().max_density.is_finite());
        let extinction = GridExtinction::new(grid, DAffine3::IDENTITY, 1.0);
        assert!(matches!(extinction.bounds(), Some(Bounds::Parallelepiped(_))), "{scale}");
    }
}

#[test]
fn half_is_the_same_for_any_thread_count() {
    let sparse = media("smoke_plume.vdb");
    let sample = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let grid = pool.install(|| build(&sparse, BrickPrecision::Half));
        let points = points(&grid, 1000).into_iter();
        let densities: Vec<u64> = points.map(|point| grid.density(point).to_bits()).collect();
        (grid.statistics(), densities)
    };
    assert_eq!(sample(1), sample(5));
}
