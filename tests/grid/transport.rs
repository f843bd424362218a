//! Transmittance and free flights in density grids against closed forms.
//!
//! The truths `ramp_axis`, `ramp_oblique`, `tri_2voxel_axis`, `tri_8_diagonal` and
//! `vdb_2voxel_background0_offset` are integrals of polynomials; their values were computed to 17 digits with
//! arbitrary precision arithmetic.

use crate::grid_support::{Voxels, cloud};
use photonvdb::{
    math::{Ball, DAffine3, DMat3, DVec3, Ray, Rgb, Span, Stream, uniform},
    medium::{Bounds, Extinction, Flight, GridExtinction, RayProfile},
};

const RAMP_AXIS: f64 = 1.5;
const RAMP_OBLIQUE: f64 = 3.068_172_400_785_65;
const TRI_2VOXEL_AXIS: f64 = 2.0;
const TRI_8_DIAGONAL: f64 = 3.355_848_439_664_7;
const VDB_2VOXEL_BACKGROUND0_OFFSET: f64 = 0.5;

fn scaled(voxel_size: DVec3) -> DAffine3 {
    DAffine3::from_scale(voxel_size)
}

/// Depth forwards, backwards, in two parts, at the end of a profile, and by inversion: all the same.
fn depth(extinction: &GridExtinction, from: DVec3, to: DVec3) -> f64 {
    let length = (to - from).length();
    let span = Span::new(0.0, length);
    let ray = Ray::new(from, (to - from) / length);
    let forwards = extinction.optical_depth(&ray, span).x;
    let agrees = |other: f64, way: &str| {
        assert!(
            (other - forwards).abs() <= 1e-11 * (1e-300 + forwards),
            "{other} {way} for {forwards}"
        );
    };
    agrees(extinction.optical_depth(&Ray::new(to, -ray.direction), span).x, "backwards");
    let cut = 0.37 * length;
    let first = extinction.optical_depth(&ray, Span::new(0.0, cut)).x;
    let second = extinction.optical_depth(&ray, Span::new(cut, length)).x;
    agrees(first + second, "in two parts");
    let mut profile = RayProfile::default();
    extinction.profile(&ray, span, &mut profile);
    agrees(profile.optical_depth(length).x, "by profile");
    let steps = if forwards > 0.0 { 1..20 } else { 0..0 };
    for step in steps {
        let target = forwards * f64::from(step) / 20.0;
        let exact = extinction.distance_at(&ray, span, target).unwrap();
        let reached = extinction.optical_depth(&ray, Span::new(0.0, exact)).x;
        assert!((reached - target).abs() <= 1e-11 * forwards, "{reached} for {target}");
        let tabulated = profile.distance_at(target, 0);
        assert!((profile.optical_depth(tabulated).x - target).abs() <= 1e-11 * forwards);
    }
    forwards
}

fn assert_depth(
    extinction: &GridExtinction,
    from: [f64; 3],
    to: [f64; 3],
    truth: f64,
    tolerance: f64,
) {
    let found = depth(extinction, from.into(), to.into());
    assert!((found - truth).abs() <= tolerance * truth, "{found} for {truth}");
}

fn two_voxels() -> Voxels {
    let mut voxels = Voxels::default();
    voxels.set([0, 0, 0], 0.0);
    voxels.set([1, 0, 0], 4.0);
    voxels
}

fn eight_voxels() -> Voxels {
    let corners = [[[0.5, 1.5], [2.0, 0.0]], [[3.0, 0.25], [0.0, 5.0]]];
    Voxels::of_field([0; 3], [1; 3], |[x, y, z]| corners[x as usize][y as usize][z as usize])
}

#[test]
fn a_ramp_along_an_axis() {
    // Voxels of 1/8 from -2 on, so that the ray crosses bricks.
    let ramp = Voxels::of_field([-16, -3, -3], [20, 3, 3], |v| f64::from(v[0].max(0)) / 8.0);
    let extinction = ramp.extinction(scaled(DVec3::splat(0.125)), 0.75);
    assert_depth(&extinction, [0.0; 3], [2.0, 0.0, 0.0], RAMP_AXIS, 1e-14);
    for offset in [[0.0, -0.3, 0.25], [0.0, 0.125, 0.125], [0.0, 0.01, -0.02]] {
        let from = DVec3::from_array(offset);
        let found = depth(&extinction, from, from + 2.0 * DVec3::X);
        assert!((found - RAMP_AXIS).abs() < 1e-13);
    }
}

#[test]
fn a_ramp_across_all_axes() {
    let field =
        |[x, y, z]: [i32; 3]| 0.2 + 0.1 * (f64::from(x) - 0.1 * f64::from(y) + 0.05 * f64::from(z));
    let ramp = Voxels::of_field([-1; 3], [19; 3], field);
    let extinction = ramp.extinction(scaled(DVec3::splat(0.1)), 1.0);
    let end = 3.0_f64.sqrt();
    assert_depth(&extinction, [0.0; 3], [end; 3], RAMP_OBLIQUE, 1e-7);
}

#[test]
fn one_cell_along_an_axis_and_its_diagonal() {
    let two = two_voxels().extinction(DAffine3::IDENTITY, 1.0);
    assert_depth(&two, [0.0; 3], [1.0, 0.0, 0.0], TRI_2VOXEL_AXIS, 1e-15);
    let beside = VDB_2VOXEL_BACKGROUND0_OFFSET;
    assert_depth(&two, [0.0, 0.5, 0.5], [1.0, 0.5, 0.5], beside, 1e-15);
    assert_depth(&two, [0.0, -0.5, 0.5], [1.0, -0.5, 0.5], beside, 1e-15);
    let eight = eight_voxels().extinction(DAffine3::IDENTITY, 1.0);
    assert_depth(&eight, [0.0; 3], [1.0; 3], TRI_8_DIAGONAL, 1e-14);
}

#[test]
fn voxels_of_any_size_and_place() {
    let sizes = [
        DVec3::splat(1e-12),
        DVec3::splat(1e12),
        DVec3::new(1.0, 1e6, 1e-6),
        DVec3::new(1e-6, 1.0, 1e6),
    ];
    for size in sizes {
        let place = scaled(size);
        let two = two_voxels().extinction(place, 1.0 / size.x);
        let to_world = |point: [f64; 3]| place.transform_point3(point.into()).to_array();
        assert_depth(&two, [0.0; 3], to_world([1.0, 0.0, 0.0]), TRI_2VOXEL_AXIS, 1e-13);
        let diagonal = size.length() / 3.0_f64.sqrt();
        let eight = eight_voxels().extinction(place, 1.0 / diagonal);
        assert_depth(&eight, [0.0; 3], to_world([1.0; 3]), TRI_8_DIAGONAL, 1e-12);
    }
    // Far from the origin, turned, and with the grid's own coordinates far from 0.
    for shift in [1 << 20, 1 << 30, -(1 << 30)] {
        let corners = eight_voxels();
        let far = Voxels::of_field([shift; 3], [shift + 1; 3], |voxel| {
            f64::from(corners.value(voxel.map(|c| i64::from(c - shift))))
        });
        let turn = DMat3::from_rotation_y(0.4) * DMat3::from_rotation_x(1.1);
        let matrix = turn * DMat3::from_diagonal(DVec3::splat(0.5));
        let origin = DVec3::new(1e6, -2e6, 3e5);
        let place = DAffine3::from_mat3_translation(
            matrix,
            origin - matrix * DVec3::splat(f64::from(shift)),
        );
        let extinction = GridExtinction::new(far.grid(), place, 2.0);
        let end = origin + matrix * DVec3::ONE;
        assert_depth(&extinction, origin.into(), end.into(), TRI_8_DIAGONAL, 1e-6);
    }
}

#[test]
fn the_depth_of_a_cloud_is_that_of_a_fine_ruler() {
    let voxels = cloud(20);
    let grid = voxels.grid();
    let bounds = grid.render_bounds().unwrap();
    let extinction = GridExtinction::new(grid, DAffine3::IDENTITY, 0.3);
    let mut random = Stream::Experiment.random(1, 0);
    let mut point = || {
        let unit = DVec3::new(uniform(&mut random), uniform(&mut random), uniform(&mut random));
        bounds.0 + (bounds.1 - bounds.0) * unit
    };
    for _ in 0..50 {
        let (from, to) = (point(), point());
        let step_count = 40_000;
        let sum: f64 = (0..step_count)
            .map(|n| from.lerp(to, (f64::from(n) + 0.5) / f64::from(step_count)))
            .map(|at| voxels.density(bounds, at))
            .sum();
        let truth = 0.3 * sum * (to - from).length() / f64::from(step_count);
        let found = depth(&extinction, from, to);
        assert!((found - truth).abs() < 1e-6, "{found} for {truth}");
    }
}

#[test]
fn tiles_and_their_shells_integrate_exactly() {
    let mut voxels = Voxels::default();
    voxels.tile([0, 0, 0], 128, 2.0, true);
    voxels.tile([-4096, 0, 0], 4096, 1.0, true);
    voxels.tile([128, 0, 0], 8, 3.0, true);
    let extinction = voxels.extinction(DAffine3::IDENTITY, 1e-3);
    // 0 to 1 over a cell, 1 for 4095, 1 to 2, 2 for 127, 2 to 3, 3 for 7, 3 to 0.
    let along_x = 0.5 + 4095.0 + 1.5 + 2.0 * 127.0 + 2.5 + 21.0 + 1.5;
    let truth = 1e-3 * along_x;
    assert_depth(&extinction, [-4097.0, 3.0, 5.5], [136.0, 3.0, 5.5], truth, 1e-13);
    // Half a cell below the tiles in z, where their shells hold half of them.
    assert_depth(&extinction, [-4097.0, 3.0, -0.5], [136.0, 3.0, -0.5], 0.5 * truth, 1e-13);
    // Along the upper face of the large tile.
    assert_depth(&extinction, [-1.0, 4095.75, 0.0], [-1.0, 4095.75, 4095.0], 1e-3 * 1023.75, 1e-13);
    assert_depth(&extinction, [-0.5, 200.0, 10.0], [-0.5, 4000.0, 10.0], 1e-3 * 1900.0, 1e-13);
}

#[test]
fn rays_along_axes_faces_edges_and_through_corners_are_limits_of_their_neighbours() {
    let voxels = cloud(20);
    let extinction = voxels.extinction(DAffine3::IDENTITY, 0.3);
    let starts =
        [[0.0, 0.0, 0.0], [8.0, 8.0, 8.0], [-8.0, 0.0, 4.0], [-5.0, 7.0, 0.5], [0.3, 0.7, 0.1]];
    let zeros = [0.0, -0.0];
    for start in starts.map(DVec3::from_array) {
        for sign in [1.0, -1.0] {
            for zero in zeros {
                let directions = [
                    DVec3::new(sign, zero, zero),
                    DVec3::new(zero, sign, zero),
                    DVec3::new(zero, zero, sign),
                    DVec3::new(sign, sign, zero) / 2.0_f64.sqrt(),
                    DVec3::new(zero, sign, -sign) / 2.0_f64.sqrt(),
                    DVec3::new(sign, sign, sign) / 3.0_f64.sqrt(),
                    DVec3::new(sign, -sign, sign) / 3.0_f64.sqrt(),
                ];
                for direction in directions {
                    let tilt = DVec3::new(1.3e-9, -0.7e-9, 0.9e-9);
                    let exact = depth(&extinction, start, start + 12.0 * direction);
                    let tilted = depth(&extinction, start, start + 12.0 * (direction + tilt));
                    assert!((exact - tilted).abs() < 1e-7, "{exact} {tilted} {start} {direction}");
                }
            }
        }
    }
}

#[test]
fn rays_beside_the_grid_or_without_end_meet_nothing_more() {
    let extinction = two_voxels().extinction(DAffine3::IDENTITY, 1.0);
    let forever = Span::new(0.0, f64::INFINITY);
    let through = Ray::new(DVec3::new(-50.0, 0.0, 0.0), DVec3::X);
    assert!((extinction.optical_depth(&through, forever).x - 4.0).abs() < 1e-12);
    let rays = [
        Ray::new(DVec3::new(0.0, 5.0, 0.0), DVec3::X),
        Ray::new(DVec3::new(50.0, 0.0, 0.0), DVec3::X),
        Ray::new(DVec3::new(0.0, 1.0 + 1e-12, -0.0), DVec3::new(1.0, -0.0, 0.0)),
    ];
    for ray in rays {
        assert_eq!(extinction.optical_depth(&ray, forever), Rgb::ZERO);
        let flight = extinction.invert_flight(&ray, forever, Rgb::ONE, 0.999);
        assert_eq!(flight, Flight::Escape { weight: Rgb::ONE });
        let mut random = Stream::Experiment.random(0, 0);
        assert_eq!(extinction.sample_flight(&ray, forever, Rgb::ONE, &mut random), flight);
    }
}

#[test]
fn grids_without_extinction_are_vacuum() {
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let cases = [
        (two_voxels(), DAffine3::IDENTITY, 0.0),
        (two_voxels(), DAffine3::IDENTITY, f64::NAN),
        (two_voxels(), flat, 1.0),
        (Voxels::default(), DAffine3::IDENTITY, 1.0),
    ];
    let (ray, span) = (Ray::new(DVec3::ZERO, DVec3::X), Span::new(0.0, 1.0));
    for (voxels, place, scale) in cases {
        let extinction = voxels.extinction(place, scale);
        assert!(extinction.bounds().is_none());
        assert_eq!(extinction.max_sigma_t(), 0.0);
        assert_eq!(extinction.optical_depth(&ray, span), Rgb::ZERO);
        let mut profile = RayProfile::default();
        extinction.profile(&ray, span, &mut profile);
        assert_eq!(profile.total_transmittance(), Rgb::ONE);
    }
}

#[test]
fn a_single_dense_voxel_among_thin_ones_costs_little() {
    // The majorant is 1e30 times the density nearly everywhere: delta tracking alone would never end.
    let mut voxels = Voxels::of_field([0; 3], [15; 3], |_| 1e-2);
    voxels.set([15, 15, 15], 1e30);
    let extinction = voxels.extinction(DAffine3::IDENTITY, 1.0);
    let ray = Ray::new(DVec3::new(0.0, 3.0, 3.0), DVec3::X);
    let mut random = Stream::Experiment.random(3, 0);
    let count = 20_000;
    let escaped = (0..count)
        .filter(|_| {
            let span = Span::new(0.0, 15.0);
            let flight = extinction.sample_flight(&ray, span, Rgb::ONE, &mut random);
            matches!(flight, Flight::Escape { .. })
        })
        .count();
    let truth = (-0.15_f64).exp();
    let z = (escaped as f64 / f64::from(count) - truth)
        / (truth * (1.0 - truth) / f64::from(count)).sqrt();
    assert!(z.abs() < 4.5, "z = {z}");
}

/// Mean z-score over 64 batches of `count` values each.
fn z_of_batches(truth: f64, mut batch: impl FnMut(u64) -> f64) -> f64 {
    let means: Vec<f64> = (0..64).map(&mut batch).collect();
    let mean = means.iter().sum::<f64>() / 64.0;
    let variance = means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>() / 63.0;
    // Where nothing ever escapes, the batches have no variance.
    if (mean - truth).abs() < 1e-9 { 0.0 } else { (mean - truth) / (variance / 64.0).sqrt() }
}

fn assert_flights(extinction: &GridExtinction, ray: &Ray, span: Span) {
    let transmittance = (-extinction.optical_depth(ray, span).x).exp();
    let batch = |seed: u64, value: &mut dyn FnMut(Option<f64>) -> f64| {
        let mut random = Stream::Experiment.random(seed, 7);
        let count = 4000;
        let sum: f64 = (0..count)
            .map(|_| match extinction.sample_flight(ray, span, Rgb::ONE, &mut random) {
                Flight::Collision { distance, weight } => {
                    assert_eq!(weight, Rgb::ONE);
                    assert!(distance >= span.start && distance <= span.end);
                    value(Some(distance))
                }
                Flight::Escape { .. } => value(None),
            })
            .sum();
        sum / f64::from(count)
    };
    // Escapes, each 0 or 1: their mean is T, and T(1 - T) their variance.
    let z = z_of_batches(transmittance, |b| batch(b, &mut |d| f64::from(u8::from(d.is_none()))));
    assert!(z.abs() < 4.5, "transmittance: z = {z}");

    // Kolmogorov and Smirnov: the CDF at a collision, conditioned on there being one, is uniform.
    let mut random = Stream::Experiment.random(99, 7);
    let mut quantiles: Vec<f64> = (0..40_000)
        .filter_map(|_| match extinction.sample_flight(ray, span, Rgb::ONE, &mut random) {
            Flight::Collision { distance, .. } => {
                let depth = extinction.optical_depth(ray, Span::new(span.start, distance)).x;
                Some(-(-depth).exp_m1() / (1.0 - transmittance))
            }
            Flight::Escape { .. } => None,
        })
        .collect();
    quantiles.sort_by(f64::total_cmp);
    let count = quantiles.len() as f64;
    let distance = quantiles
        .iter()
        .enumerate()
        .map(|(n, q)| (q - n as f64 / count).abs().max((q - (n + 1) as f64 / count).abs()))
        .fold(0.0, f64::max);
    // Exceeded with probability 1e-5.
    assert!(distance * count.sqrt() < 2.47, "KS {}", distance * count.sqrt());
}

#[test]
fn delta_tracking_flies_as_the_ramp_says() {
    let ramp = Voxels::of_field([-16, -3, -3], [20, 3, 3], |v| f64::from(v[0].max(0)) / 8.0);
    let extinction = ramp.extinction(scaled(DVec3::splat(0.125)), 0.75);
    assert_flights(&extinction, &Ray::new(DVec3::ZERO, DVec3::X), Span::new(0.0, 2.0));
}

#[test]
fn delta_tracking_flies_as_the_exact_depth_says() {
    let voxels = cloud(20);
    for scale in [0.02, 0.3, 6.0, 300.0] {
        let extinction = voxels.extinction(DAffine3::IDENTITY, scale);
        let direction = DVec3::new(0.8, 0.5, -0.33).normalize();
        let ray = Ray::new(DVec3::new(-15.0, -9.0, 7.0), direction);
        assert_flights(&extinction, &ray, Span::new(0.0, 30.0));
    }
    let mut tiles = Voxels { background: 0.001, ..Voxels::default() };
    tiles.tile([0; 3], 128, 0.02, true);
    tiles.tile([-8, 0, 0], 8, 0.1, true);
    tiles.set([130, 4, 4], 5.0);
    let extinction = tiles.extinction(DAffine3::IDENTITY, 1.0);
    let ray = Ray::new(DVec3::new(-8.5, 3.75, 3.75), DVec3::X);
    assert_flights(&extinction, &ray, Span::new(0.0, 139.0));
}

#[test]
fn quantiles_of_the_free_flight_invert_its_distribution() {
    let ramp = Voxels::of_field([-16, -3, -3], [64, 3, 3], |v| f64::from(v[0].max(0)) / 8.0);
    let extinction = ramp.extinction(scaled(DVec3::splat(0.125)), 0.75);
    let ray = Ray::new(DVec3::ZERO, DVec3::X);
    for step in 0..1000 {
        let u = f64::from(step) / 1000.0;
        let flight = extinction.invert_flight(&ray, Span::new(0.0, 7.5), Rgb::ONE, u);
        // 1 - exp(-0.375 s^2) = u
        let truth = (-(-u).ln_1p() / 0.375).sqrt();
        let Flight::Collision { distance, weight } = flight else { panic!("escaped at {u}") };
        assert!((distance - truth).abs() < 1e-12, "{distance} for {truth}");
        assert_eq!(weight, Rgb::ONE);
    }
    let escape = extinction.invert_flight(&ray, Span::new(0.0, 1.0), Rgb::ONE, 0.5);
    assert_eq!(escape, Flight::Escape { weight: Rgb::ONE });
}

#[test]
fn the_extinction_in_a_ball_is_its_mean_times_the_volume() {
    // sigma_t = 0.5 in half of the index space of voxels of 2, and nothing in the rest.
    let half = Voxels::of_field([-40, -40, -40], [0, 40, 40], |_| 1.0);
    let place = scaled(DVec3::splat(2.0));
    let extinction = half.extinction(place, 0.5);
    let ball = |x: f64| Ball { center: DVec3::new(x, 3.0, -5.0), radius: 10.0 };
    let mean = |ball: Ball, ceiling: f64| {
        let sum: f64 = (0..256)
            .map(|n| {
                let phase = f64::from(n) / 256.0;
                ceiling * extinction.ball_moments(&Bounds::Infinite, ball, ceiling, phase, 0.0).mass
            })
            .sum();
        sum / 256.0 / ball.volume()
    };
    assert!((mean(ball(-20.0), 1.0) - 0.5).abs() < 1e-12);
    assert!((mean(ball(-20.0), 0.2) - 0.2).abs() < 1e-12);
    assert_eq!(mean(ball(20.0), 1.0), 0.0);
    // The density falls from 1 to 0 between x = 0 and 2: half of it is beyond x = 1.
    assert!((mean(ball(1.0), 1.0) - 0.25).abs() < 0.005);
}
