//! Lookups equal a slow trilinear lookup, voxel by voxel.

use crate::grid_support::{Voxels, cloud};
use photonvdb::{
    math::DVec3,
    medium::{grid::DensityGrid, vdb::SparseGrid},
};
use proptest::{prelude::*, test_runner::RngSeed};

fn assert_same(voxels: &Voxels, grid: &DensityGrid, point: DVec3) {
    let bounds = grid.render_bounds().unwrap();
    let (found, expected) = (grid.density(point), voxels.density(bounds, point));
    let error = (found - expected).abs();
    assert!(error <= 1e-12 * (1.0 + expected), "{found} for {expected} at {point}");
}

/// Points where bricks, regions and bounds meet, and points between.
fn assert_same_around(voxels: &Voxels, grid: &DensityGrid, center: DVec3) {
    for offset in [-1.5, -1.0, -0.75, -0.25, 0.0, 0.5, 0.875, 1.0] {
        for other in [-1.25, -0.5, 0.0, 0.25, 1.0] {
            for third in [-0.5, 0.0, 0.75] {
                assert_same(voxels, grid, center + DVec3::new(offset, other, third));
                assert_same(voxels, grid, center + DVec3::new(third, offset, other));
                assert_same(voxels, grid, center + DVec3::new(other, third, offset));
            }
        }
    }
}

#[derive(Clone, Debug)]
enum Part {
    Voxel([i32; 3], f32),
    Inactive([i32; 3], f32),
    Tile([i32; 3], u32, f32, bool),
}

fn value() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0), Just(0.5), 0.0..3.0_f32]
}

fn part(reach: i32) -> impl Strategy<Value = Part> {
    let place = move || prop::array::uniform3(-reach..reach);
    let tile = move |dim: i32| {
        let steps = (reach / dim).max(1);
        (prop::array::uniform3(-steps..steps), value(), any::<bool>()).prop_map(
            move |(origin, value, active)| {
                Part::Tile(origin.map(|c| c * dim), dim as u32, value, active)
            },
        )
    };
    prop_oneof![
        6 => (place(), value()).prop_map(|(at, value)| Part::Voxel(at, value)),
        2 => (place(), value()).prop_map(|(at, value)| Part::Inactive(at, value)),
        3 => tile(8),
        2 => tile(128),
        1 => tile(4096),
    ]
}

fn voxels(reach: i32) -> impl Strategy<Value = Voxels> {
    (prop_oneof![3 => Just(0.0), 1 => Just(0.25_f32)], prop::collection::vec(part(reach), 1..40))
        .prop_map(|(background, parts)| {
            let mut voxels = Voxels { background, ..Voxels::default() };
            for part in parts {
                match part {
                    Part::Voxel(at, value) => voxels.set(at, value),
                    Part::Inactive(at, value) => voxels.set_inactive(at, value),
                    Part::Tile(origin, dim, value, active) => {
                        // A tree holds one node a place: tiles of one size never coincide.
                        if !voxels.tiles.iter().any(|t| t.origin == origin && t.dim == dim) {
                            voxels.tile(origin, dim, value, active);
                        }
                    }
                }
            }
            voxels
        })
}

fn check(voxels: &Voxels, points: &[[f64; 3]]) -> Result<(), TestCaseError> {
    let grid = voxels.grid();
    let Some((min, max)) = grid.render_bounds() else { return Ok(()) };
    for point in points {
        let unit = DVec3::from_array(*point);
        // Beyond the bounds by a little, too.
        assert_same(voxels, &grid, min + (max - min) * (unit * 1.2 - 0.1));
        assert_same(voxels, &grid, (min + (max - min) * unit).round());
    }
    for origin in voxels.leaves.keys().take(6) {
        let origin = DVec3::from_array(origin.map(f64::from));
        for corner in [DVec3::ZERO, DVec3::splat(7.0), DVec3::new(8.0, 0.0, 7.5)] {
            assert_same_around(voxels, &grid, origin + corner);
        }
    }
    for tile in voxels.tiles.iter().take(6) {
        let origin = DVec3::from_array(tile.origin.map(f64::from));
        let edge = f64::from(tile.dim);
        for corner in [0.0, 0.5 * edge, edge - 1.0, edge] {
            assert_same_around(voxels, &grid, origin + DVec3::splat(corner));
            assert_same_around(voxels, &grid, origin + DVec3::new(corner, edge, 0.3 * edge));
            assert_same_around(voxels, &grid, origin + DVec3::new(0.0, 0.7 * edge, corner));
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 150,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(0),
        ..ProptestConfig::default()
    })]

    #[test]
    fn dense_grids_sample_as_written(
        voxels in voxels(40),
        points in prop::collection::vec(prop::array::uniform3(0.0..1.0), 200),
    ) {
        check(&voxels, &points)?;
    }

    #[test]
    fn scattered_grids_sample_as_written(
        voxels in voxels(20_000),
        points in prop::collection::vec(prop::array::uniform3(0.0..1.0), 200),
    ) {
        check(&voxels, &points)?;
    }

    #[test]
    fn grids_as_wide_as_coordinates_go_sample_as_written(
        voxels in voxels(1 << 30),
        points in prop::collection::vec(prop::array::uniform3(0.0..1.0), 50),
    ) {
        check(&voxels, &points)?;
    }
}

#[test]
fn a_smooth_cloud_samples_as_written() {
    let voxels = cloud(20);
    let grid = voxels.grid();
    for step in 0..5000 {
        let turn = |factor: f64| 2.0 * (f64::from(step) * factor).fract() - 1.0;
        assert_same(&voxels, &grid, 22.0 * DVec3::new(turn(0.618), turn(0.7549), turn(0.5698)));
    }
}

#[test]
fn a_single_voxel_reaches_one_cell_around() {
    let mut voxels = Voxels::default();
    voxels.set([0, 0, 0], 2.0);
    let grid = voxels.grid();
    assert_eq!(grid.render_bounds(), Some((DVec3::splat(-1.0), DVec3::ONE)));
    assert_eq!(grid.density(DVec3::ZERO), 2.0);
    assert_eq!(grid.density(DVec3::splat(-0.5)), 0.25, "the cells below are in empty bricks");
    assert_eq!(grid.density(DVec3::new(-0.75, 0.5, 0.0)), 0.25);
    assert_eq!(grid.density(DVec3::splat(1.01)), 0.0);
    assert_eq!(grid.density(DVec3::splat(f64::NAN)), 0.0);
    assert_eq!(grid.density(DVec3::splat(f64::INFINITY)), 0.0);
}

#[test]
fn values_that_cannot_bound_a_flight_count_as_none() {
    let mut voxels = Voxels::default();
    for (x, value) in
        [f32::NAN, f32::INFINITY, -1.0, f32::NEG_INFINITY, -0.0, 1.5].iter().enumerate()
    {
        voxels.set([x as i32, 0, 0], *value);
    }
    let grid = voxels.grid();
    assert_eq!(grid.statistics().max_density, 1.5);
    for x in 0..5 {
        assert_eq!(grid.density(DVec3::new(f64::from(x), 0.0, 0.0)), 0.0);
    }
    assert_eq!(grid.density(DVec3::new(5.0, 0.0, 0.0)), 1.5);
}

#[test]
fn a_root_tile_costs_one_entry() {
    let mut voxels = Voxels::default();
    voxels.tile([-4096, 0, 4096], 4096, 3.0, true);
    voxels.tile([1 << 30, -(1 << 30), 0], 4096, 1.0, true);
    voxels.tile([0, 0, 1 << 30], 128, 2.0, true);
    voxels.set([-(1 << 30), 5, 6], 7.0);
    let grid = voxels.grid();
    let statistics = grid.statistics();
    assert!(statistics.memory_bytes < 300_000, "{statistics:?}");
    assert_eq!(statistics.active_voxel_count, 2 * (1 << 36) + (1 << 21) + 1);
    for origin in [[-4096, 0, 4096], [1 << 30, -(1 << 30), 0], [0, 0, 1 << 30], [-(1 << 30), 5, 6]]
    {
        let origin = DVec3::from_array(origin.map(f64::from));
        assert_same_around(&voxels, &grid, origin);
        assert_same_around(&voxels, &grid, origin + DVec3::new(4096.0, 128.0, 4095.0));
    }
}

#[test]
fn grids_without_active_voxels_are_empty() {
    let mut voxels = Voxels { background: 1.0, ..Voxels::default() };
    voxels.set_inactive([0, 0, 0], 3.0);
    voxels.tile([128, 0, 0], 128, 3.0, false);
    let grid = voxels.grid();
    assert_eq!(grid.render_bounds(), None);
    assert_eq!(grid.density(DVec3::ZERO), 0.0);
    assert_eq!(grid.statistics().active_voxel_count, 0);
}

#[test]
fn malformed_grids_do_not_panic() {
    let mut sparse: SparseGrid<f32> = cloud(4).sparse();
    sparse.values.truncate(700);
    sparse.masks.truncate(3);
    sparse.leaves[0] = [i32::MIN, i32::MAX, 3];
    let mut voxels = Voxels::default();
    voxels.tile([i32::MIN, i32::MAX, i32::MAX - 7], 8, 1.0, true);
    voxels.tile([3, i32::MAX, 0], 4096, 1.0, true);
    for grid in [DensityGrid::from_sparse(&sparse), voxels.grid()] {
        let (min, max) = grid.render_bounds().unwrap();
        for step in 0..=64 {
            assert!(grid.density(min + (max - min) * (f64::from(step) / 64.0)).is_finite());
        }
    }
}

#[test]
fn the_same_voxels_make_the_same_grid_for_any_thread_count() {
    let voxels = cloud(30);
    let sample = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let grid = pool.install(|| voxels.grid());
        let densities: Vec<u64> = (0..999)
            .map(|n| grid.density(DVec3::splat(f64::from(n) * 0.06 - 30.0)).to_bits())
            .collect();
        (grid.statistics(), densities)
    };
    assert_eq!(sample(1), sample(2));
    assert_eq!(sample(1), sample(7));
}
