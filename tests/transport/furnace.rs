//! Media under the same radiance from all sides, which scatter all and absorb nothing: path length, collisions and power
//! density do not depend on shape, density or phase function.

use std::f64::consts::PI;

use crate::grid_support::{Voxels, cloud};
use crate::transport_support::*;
use photonvdb::emission::EmissionKind;
use photonvdb::math::{DAffine3, DMat3, DVec3};
use photonvdb::medium::{Bounds, Medium};
use photonvdb::render::{LitScene, Unobserved};

/// Collisions per unit of emitted power.
fn mean_collisions(medium: Medium, kind: EmissionKind) -> (Runs, f64) {
    let mut scene = scene(medium, white_sky(), 4000);
    scene.photons.emission = kind;
    let [collisions, emitted] = over_seeds(&mut scene, |scene| {
        let traced = trace(scene);
        let stored: f64 = traced.photons.iter().map(|photon| power(photon, 0)).sum();
        [stored / traced.balance.emitted.x, traced.balance.emitted.x]
    });
    (collisions, emitted.mean)
}

/// E4 and E5 in shapes of one sigma_t: sigma_t 4 V / S collisions.
#[test]
fn mean_chord_of_boxes_and_balls() {
    let slab = Bounds::Box { min: DVec3::ZERO, max: DVec3::new(1.0, 2.0, 3.0) };
    for (bounds, chord, area) in [
        (CUBE, 4.0 / 3.0, 24.0),
        (slab, 12.0 / 11.0, 22.0),
        (ball(0.7), 4.0 * 0.7 / 3.0, 4.0 * PI * 0.49),
    ] {
        for (sigma_t, g, kind) in [
            (0.3, 0.0, EmissionKind::Stratified),
            (3.0, 0.85, EmissionKind::Sobol),
            (3.0, -0.5, EmissionKind::Random),
        ] {
            let (collisions, emitted) = mean_collisions(grey_fog(bounds, sigma_t, 1.0, g), kind);
            collisions
                .assert_is(chord * sigma_t, &format!("{bounds:?}, {sigma_t}, g {g}, {kind:?}"));
            assert!((emitted / (PI * area) - 1.0).abs() < 1e-12, "{emitted}");
        }
    }
}

/// The same in grids: 4 / S times the integral of sigma_t, which is the sum of the voxels times their volume.
#[test]
fn mean_chord_of_grids() {
    let turn = DMat3::from_rotation_y(0.4) * DMat3::from_rotation_x(1.1);
    let sizes = DVec3::new(0.1, 0.15, 0.05);
    let place =
        DAffine3::from_mat3_translation(turn * DMat3::from_diagonal(sizes), DVec3::splat(9.0));
    let steep =
        Voxels::of_field([-3, 0, 0], [9, 5, 7], |[x, y, z]| f64::from((x * 7 + y * 3 + z * 5) & 3));
    for (voxels, scale) in [(cloud(10), 6.0), (steep, 1.0)] {
        let sum: f64 = voxels.leaves.values().flat_map(|leaf| &leaf.1).map(|v| f64::from(*v)).sum();
        let extinction = voxels.extinction(place, scale);
        let (min, max) = extinction.grid().render_bounds().unwrap();
        let edges = (max - min) * sizes;
        let area = 2.0 * (edges.x * edges.y + edges.y * edges.z + edges.z * edges.x);
        let exact = 4.0 * scale * sum * sizes.element_product() / area;
        let medium = grid_medium(extinction, DVec3::ONE, 0.6);
        let (collisions, emitted) = mean_collisions(medium, EmissionKind::Stratified);
        collisions.assert_is(exact, "collisions in a grid");
        assert!((emitted / (PI * area) - 1.0).abs() < 1e-12, "{emitted}");
    }
}

/// The images of a place in the planes of symmetry.
fn mirrored(place: DVec3) -> [DVec3; 8] {
    let sign = |n: usize, axis: usize| if n >> axis & 1 == 0 { 1.0 } else { -1.0 };
    std::array::from_fn(|n| place * DVec3::new(sign(n, 0), sign(n, 1), sign(n, 2)))
}

/// E6: power density 4 pi sigma_t everywhere, also where the kernel reaches out of the medium.
#[test]
fn power_density_inside_and_on_the_boundary() {
    let in_box = [
        ("inside", DVec3::new(0.2, -0.1, 0.3)),
        ("near a face", DVec3::new(0.97, 0.1, 0.3)),
        ("on a face", DVec3::new(1.0, -0.3, 0.2)),
        ("on an edge", DVec3::new(1.0, -1.0, 0.4)),
        ("in a corner", DVec3::new(-1.0, 1.0, -1.0)),
    ];
    let in_ball = [
        ("inside", DVec3::new(0.2, -0.1, 0.3)),
        ("near the surface", DVec3::new(0.0, 0.97, 0.0)),
        ("on the surface", DVec3::new(0.6, 0.0, -0.8)),
        ("on the surface", DVec3::new(0.0, 1.0, 0.0)),
        ("at the centre", DVec3::ZERO),
    ];
    for (bounds, places) in [(CUBE, in_box), (ball(1.0), in_ball)] {
        for (sigma_t, g) in [(0.5, 0.0), (4.0, 0.6)] {
            let mut scene = scene(grey_fog(bounds, sigma_t, 1.0, g), white_sky(), 10_000);
            scene.photons.emission = EmissionKind::Random;
            scene.render.photons_only = true;
            scene.estimate.k = 50;
            let densities = over_seeds(&mut scene, |scene| {
                let lit = LitScene::prepare(scene, &Unobserved).unwrap();
                let mut reader = lit.reader();
                places.map(|(_, place)| {
                    let images = mirrored(place).map(|image| reader.power_density(image).value.x);
                    images.iter().sum::<f64>() / 8.0
                })
            });
            for (density, (place, _)) in densities.iter().zip(places) {
                density.assert_is(4.0 * PI * sigma_t, &format!("{bounds:?}, {sigma_t}, {place}"));
            }
        }
    }
}
