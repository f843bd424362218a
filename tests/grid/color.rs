//! Media coloured place by place: one colour everywhere is an albedo, a ramp is what quadrature says, and every watt is
//! accounted for.

use crate::grid_support::{Voxels, cloud};
use crate::transport_support::*;
use photonvdb::emission::EmissionKind;
use photonvdb::light::{DirectionalLight, Light};
use photonvdb::math::{DAffine3, DVec3, Ray, Rgb, Span};
use photonvdb::medium::vdb::{Limits, SparseGrid};
use photonvdb::medium::{ColorGrid, Extinction, ISOTROPIC, Medium, MediumExtinction};
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::Scene;

/// Colours on the integer points of a box, in three grids of one topology.
fn colors(
    half_edge: i32,
    index_to_world: DAffine3,
    color: impl Fn([i32; 3]) -> [f64; 3],
) -> Option<Box<ColorGrid>> {
    let channel = |axis: usize| {
        Voxels::of_field([-half_edge; 3], [half_edge; 3], |voxel| color(voxel)[axis]).sparse()
    };
    let [red, green, blue] = [0, 1, 2].map(channel);
    let values = red.values.iter().zip(&green.values).zip(&blue.values);
    let sparse = SparseGrid {
        background: [0.0; 3],
        index_to_world,
        values: values.map(|((r, g), b)| [*r, *g, *b]).collect(),
        leaves: red.leaves,
        masks: red.masks,
        tiles: Vec::new(),
    };
    let (grid, mended) =
        ColorGrid::new(&sparse, index_to_world, &Limits::default()).unwrap().unwrap();
    assert_eq!(mended.total(), 0);
    Some(Box::new(grid))
}

fn smoke(albedo: Rgb, g: f64) -> Medium {
    let place = DAffine3::from_scale(DVec3::splat(0.1));
    grid_medium(cloud(10).extinction(place, 6.0), albedo, g)
}

fn sun() -> Light {
    let direction = DVec3::new(-0.4, -0.8, -0.45).normalize();
    Light::Directional(DirectionalLight { direction, irradiance: Rgb::splat(3.0) })
}

/// Not merely alike: no bit differs.
#[test]
fn one_color_everywhere_is_an_albedo() {
    let tint = Rgb::new(0.875, 0.5, 0.25);
    let image = |medium| {
        let mut scene = scene(medium, sun(), 20_000);
        scene.lights.push(white_sky());
        let rendering = render(&scene, &RenderOptions::passes(1), &Unobserved).unwrap();
        rendering.film.pixels
    };
    let colored = Medium {
        // A grid of its own placement, beyond the smoke on all sides.
        color: colors(8, DAffine3::from_scale(DVec3::splat(0.2)), |_| tint.to_array()),
        ..smoke(Rgb::ONE, 0.3)
    };
    assert!(image(colored) == image(smoke(tint, 0.3)));
}

/// Linear in space, so that any grid that holds it is exact, and clamped where it exceeds 1.
fn ramp(place: DVec3) -> Rgb {
    Rgb::new(0.5 + 0.4 * place.x, 0.4 - 0.3 * place.y, 0.8 + 0.5 * place.z)
}

/// The ramp on a grid that is turned and shifted against the density's.
fn ramped_smoke() -> Medium {
    let turned = DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7)
        * DAffine3::from_scale(DVec3::new(0.21, 0.19, 0.2));
    let place = DAffine3::from_translation(DVec3::new(0.03, -0.02, 0.05)) * turned;
    let at = |voxel: [i32; 3]| place.transform_point3(DVec3::from_array(voxel.map(f64::from)));
    let color = colors(12, place, |voxel| ramp(at(voxel)).max(Rgb::ZERO).to_array());
    Medium { color, ..smoke(Rgb::new(1.0, 0.9, 1.2), 0.0) }
}

#[test]
fn a_ramp_of_colors_scatters_as_quadrature_says() {
    let mut scene = scene(ramped_smoke(), sun(), 100);
    let Light::Directional(light) = &scene.lights[0] else { panic!() };
    let (towards_light, irradiance) = (-light.direction, light.irradiance);
    let MediumExtinction::Grid(extinction) = &scene.medium.extinction else { panic!() };
    let ray = Ray::new(DVec3::new(-3.0, 0.15, -0.1), DVec3::new(1.0, -0.02, 0.05).normalize());
    let span = scene.medium.bounds.intersect(&ray).unwrap();

    let steps = 20_000;
    let mut truth = Rgb::ZERO;
    for step in 0..steps {
        let distance = span.start + span.length() * (f64::from(step) + 0.5) / f64::from(steps);
        let place = ray.at(distance);
        let seen = extinction.transmittance(&ray, Span::new(span.start, distance));
        let shadow = Ray::new(place, towards_light);
        let lit = scene
            .medium
            .bounds
            .intersect(&shadow)
            .map_or(Rgb::ONE, |span| extinction.transmittance(&shadow, span));
        let albedo = (ramp(place) * Rgb::new(1.0, 0.9, 1.2)).clamp(Rgb::ZERO, Rgb::ONE);
        let scattered = albedo * extinction.sigma_t(place) * ISOTROPIC;
        truth += seen * scattered * lit * irradiance * (span.length() / f64::from(steps));
    }

    let single = over_seeds(&mut scene, |scene| {
        let mut random = photonvdb::math::Stream::Experiment.random(scene.photons.seed, 0);
        mean_seen(scene, &[ray; 500], &mut random).single.to_array()
    });
    for channel in 0..3 {
        assert!(single[channel].error < 0.01 * truth[channel], "{:?}", single[channel]);
        single[channel].assert_within(truth[channel], 1e-5, &format!("channel {channel}"));
    }
}

#[test]
fn every_watt_is_accounted_for() {
    let albedo = |place| (ramp(place) * Rgb::new(1.0, 0.9, 1.2)).clamp(Rgb::ZERO, Rgb::ONE);
    for kind in [EmissionKind::Random, EmissionKind::Stratified, EmissionKind::Sobol] {
        let mut scene = scene(ramped_smoke(), one_watt(DVec3::new(0.2, 0.1, -0.3)), 4000);
        scene.photons.emission = kind;
        let differences = over_seeds(&mut scene, |scene: &Scene| {
            let traced = trace(scene);
            let balance = traced.balance;
            let left = balance.emitted - balance.absorbed - balance.escaped - balance.truncated;
            assert!((left / balance.emitted).abs().max_element() < 1e-12, "{balance:?}");
            // What is absorbed is the share 1 - albedo, at its own place, of what collides.
            let frame = frame(scene);
            let lost: Rgb = traced
                .photons
                .iter()
                .map(|photon| {
                    let place = frame.to_world(photon.position);
                    let power = Rgb::from_array(photon.power.map(f64::from));
                    power * (Rgb::ONE - albedo(place))
                })
                .sum();
            (balance.absorbed - lost).to_array()
        });
        for difference in differences {
            difference.assert_within(0.0, 1e-6, &format!("absorbed, {kind:?}"));
        }
    }
}

#[test]
fn the_background_holds_beyond_the_voxels() {
    let sparse = SparseGrid {
        background: [0.25, f32::NAN, -1.0],
        index_to_world: DAffine3::IDENTITY,
        leaves: vec![[0; 3]],
        masks: vec![[u64::MAX; 8]],
        values: vec![[1.0, 0.5, f32::INFINITY]; 512],
        tiles: Vec::new(),
    };
    let (grid, mended) =
        ColorGrid::new(&sparse, DAffine3::IDENTITY, &Limits::default()).unwrap().unwrap();
    assert_eq!((mended.nan, mended.infinite, mended.negative), (1, 512, 1));
    assert_eq!(grid.color(DVec3::splat(3.5)), Rgb::new(1.0, 0.5, 0.0));
    assert_eq!(grid.color(DVec3::new(3.0, 3.0, 7.5)), Rgb::new(0.625, 0.25, 0.0));
    assert_eq!(grid.color(DVec3::splat(-40.0)), Rgb::new(0.25, 0.0, 0.0));
    assert_eq!(grid.max(), Rgb::new(1.0, 0.5, 0.0));
    let empty = SparseGrid { masks: vec![[0; 8]], ..sparse };
    assert!(ColorGrid::new(&empty, DAffine3::IDENTITY, &Limits::default()).unwrap().is_none());
}
