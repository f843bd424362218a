//! The same seed gives the same bits, whatever the number of threads.

use crate::grid_support::cloud;
use crate::transport_support::*;
use photonvdb::emission::EmissionKind;
use photonvdb::film::Film;
use photonvdb::map::{Columns, PhotonMap};
use photonvdb::math::{DAffine3, DVec3, Rgb};
use photonvdb::medium::Medium;
use photonvdb::render::{LitScene, RenderOptions, Unobserved, render};
use photonvdb::scene::Scene;
use photonvdb::trace::Photon;

const KINDS: [EmissionKind; 3] =
    [EmissionKind::Random, EmissionKind::Stratified, EmissionKind::Sobol];

fn media() -> [Medium; 3] {
    let place = DAffine3::from_scale(DVec3::splat(0.1));
    [
        grey_fog(CUBE, 1.5, 0.9, 0.4),
        fog(ball(1.0), Rgb::new(0.5, 1.0, 2.0), Rgb::splat(0.9), 0.0),
        grid_medium(cloud(10).extinction(place, 4.0), Rgb::splat(0.9), 0.3),
    ]
}

fn lit(medium: Medium, kind: EmissionKind, count: u64) -> Scene {
    let mut scene = scene(medium, one_watt(DVec3::new(0.2, 0.1, -0.3)), count);
    scene.lights.push(white_sky());
    scene.photons.emission = kind;
    scene.render.samples_per_pixel = 1;
    scene.render.march_samples = 4;
    scene
}

fn photon_bits(photon: &Photon) -> [u32; 11] {
    let floats = [photon.position, photon.direction, photon.power].concat();
    let mut bits = [0; 11];
    floats.iter().enumerate().for_each(|(n, float)| bits[n] = float.to_bits());
    [bits[9], bits[10]] = [photon.sigma_t.to_bits(), photon.order];
    bits
}

fn film_bits(film: &Film) -> Vec<u64> {
    let of_pixel = |p: &photonvdb::film::Pixel| {
        let colors = [p.single_scatter, p.multiple_scatter, p.emission, p.transmittance];
        let mut values: Vec<f64> = colors.iter().flat_map(|c| c.to_array()).collect();
        values.extend([p.photon_count, p.kernel_radius]);
        assert!(values.iter().all(|value| value.is_finite()), "{p:?}");
        values
    };
    film.pixels.iter().flat_map(of_pixel).map(f64::to_bits).collect()
}

/// Photons, balance, map and film.
fn everything(scene: &Scene) -> (Vec<[u32; 11]>, String, Vec<u64>, Vec<u64>) {
    let traced = trace(scene);
    let columns = Columns { direction: true, sigma_t: true, order: true };
    let map = PhotonMap::build(&traced.photons, frame(scene), columns).unwrap();
    let mut stored: Vec<u64> = (0..map.len() as u32)
        .flat_map(|photon| {
            let power = map.power(photon).map(f32::to_bits);
            let direction = map.direction(photon).unwrap().to_array().map(f64::to_bits);
            [u64::from(power[0]), u64::from(power[2]), direction[0], direction[2]]
        })
        .collect();
    let lit = LitScene::prepare(scene, &Unobserved).unwrap();
    let mut reader = lit.reader();
    for step in 0..50 {
        let place = DVec3::new(-0.5 + 0.02 * f64::from(step), 0.1, 0.2);
        stored.extend(reader.fluence(place).value.to_array().map(f64::to_bits));
    }
    let rendering = render(scene, &RenderOptions::passes(2), &Unobserved).unwrap();
    let photons = traced.photons.iter().map(photon_bits).collect();
    (photons, format!("{:?}", traced.balance), stored, film_bits(&rendering.film))
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for kind in KINDS {
        for medium in media() {
            let scene = lit(medium, kind, 20_000);
            let on_threads = |count| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
                pool.install(|| everything(&scene))
            };
            let alone = on_threads(1);
            assert!(alone.0.len() > 5000);
            for count in [2, 7] {
                let together = on_threads(count);
                assert!(together.0 == alone.0, "{kind:?}: photons differ on {count} threads");
                assert_eq!(together.1, alone.1, "{kind:?}: balance on {count} threads");
                assert!(together.2 == alone.2, "{kind:?}: the map differs on {count} threads");
                assert!(together.3 == alone.3, "{kind:?}: the film differs on {count} threads");
            }
        }
    }
}

#[test]
fn other_seeds_and_passes_differ() {
    for kind in KINDS {
        for medium in media() {
            let mut scene = lit(medium, kind, 5000);
            let first = everything(&scene);
            scene.photons.seed = 1;
            let second = everything(&scene);
            assert!(first.0 != second.0 && first.3 != second.3, "{kind:?}");
            let one = render(&scene, &RenderOptions::passes(1), &Unobserved).unwrap();
            assert!(
                film_bits(&one.film) != second.3,
                "{kind:?}: the second pass repeats the first"
            );
        }
    }
}

/// Photon i of random emission depends on the seed and i alone. (Strata follow from the number of photons.)
#[test]
fn more_random_photons_begin_with_the_same() {
    for medium in media() {
        let mut scene = scene(medium, white_sky(), 4096);
        scene.photons.emission = EmissionKind::Random;
        let few = trace(&scene);
        scene.photons.count = 16_384;
        let many = trace(&scene);
        for (a, b) in few.photons.iter().zip(&many.photons) {
            let quadrupled = Photon { power: b.power.map(|power| power * 4.0), ..*b };
            assert_eq!(photon_bits(a), photon_bits(&quadrupled));
        }
    }
}
