//! Media with light of their own: what is seen of it, the power it emits, and where that goes, against exact values.

use std::f64::consts::PI;

use crate::grid_support::{Voxels, cloud};
use crate::transport_support::*;
use photonvdb::emission::EmissionKind;
use photonvdb::math::{DAffine3, DVec3, Ray, Rgb, Span, Stream};
use photonvdb::medium::vdb::Limits;
use photonvdb::medium::{
    Bounds, Emissivity, Extinction, Flame, Medium, MediumExtinction, ValueGrid, blackbody_radiance,
};
use photonvdb::scene::Scene;
use photonvdb::trace::PowerBalance;

const KINDS: [EmissionKind; 3] =
    [EmissionKind::Random, EmissionKind::Stratified, EmissionKind::Sobol];

/// The same value everywhere, in voxels of 0.1 m.
fn everywhere(value: f32) -> ValueGrid {
    let mut voxels = Voxels { background: value, ..Voxels::default() };
    voxels.set([0; 3], value);
    ValueGrid::new(&voxels.sparse(), DAffine3::from_scale(DVec3::splat(0.1)), &Limits::default())
        .unwrap()
        .unwrap()
}

fn hot(kelvin: f32) -> Emissivity {
    Emissivity::new(Some(everywhere(kelvin)), None, 1.0)
}

fn burning(grid: ValueGrid, color: Rgb) -> Emissivity {
    Emissivity::new(None, Some(Flame { grid, color }), 1.0)
}

/// A medium that glows, in an empty world.
fn alone(medium: Medium, emissivity: Emissivity, photon_count: u64) -> Scene {
    let mut scene = scene(medium, white_sky(), photon_count);
    scene.medium = scene.medium.with_emissivity(emissivity);
    scene.lights.clear();
    scene
}

fn smoke(albedo: Rgb, g: f64) -> Medium {
    let place = DAffine3::from_scale(DVec3::splat(0.1));
    grid_medium(cloud(10).extinction(place, 6.0), albedo, g)
}

fn grid_of(medium: &Medium) -> &photonvdb::medium::GridExtinction {
    match &medium.extinction {
        MediumExtinction::Grid(grid) => grid,
        other => panic!("{other:?}"),
    }
}

/// Rays through the middle and beside it.
fn rays() -> Vec<Ray> {
    let towards = DVec3::new(1.0, -0.02, 0.05).normalize();
    [0.0, 0.3, 0.6].map(|y| Ray::new(DVec3::new(-3.0, y, -0.1), towards)).into()
}

const TINT: Rgb = Rgb::new(0.9, 0.5, 0.2);

/// In smoke of one temperature, however dense here and there, (1 - albedo) B (1 - T), without any noise.
#[test]
fn even_heat_is_seen_exactly() {
    let scene = alone(smoke(TINT, 0.0), hot(3000.0), 100);
    let mut random = Stream::Experiment.random(0, 0);
    for ray in rays() {
        let seen = mean_seen(&scene, &[ray], &mut random).emission;
        let span = scene.medium.bounds.intersect(&ray).unwrap();
        let opacity = Rgb::ONE - grid_of(&scene.medium).transmittance(&ray, span);
        let truth = (Rgb::ONE - TINT) * blackbody_radiance(3000.0) * opacity;
        assert!((seen / truth - Rgb::ONE).abs().max_element() < 1e-9, "{seen} for {truth}");
    }
}

/// A ball that burns and absorbs evenly: j / sigma_a (1 - exp(-sigma_a s)) along a chord s.
#[test]
fn a_burning_ball_is_seen_as_its_chords_are_long() {
    let color = Rgb::new(2.0, 1.0, 0.5);
    let mut scene = alone(grey_fog(ball(1.0), 1.5, 0.0, 0.0), burning(everywhere(3.0), color), 10);
    for impact in [0.0, 0.5, 0.9] {
        let ray = Ray::new(DVec3::new(impact, 0.0, -4.0), DVec3::Z);
        let [seen] = over_seeds(&mut scene, |scene| {
            let mut random = Stream::Experiment.random(scene.photons.seed, 0);
            [mean_seen(scene, &[ray; 20], &mut random).emission.x]
        });
        let chord = 2.0 * (1.0_f64 - impact * impact).sqrt();
        seen.assert_is(3.0 * color.x / 1.5 * (1.0 - (-1.5 * chord).exp()), "along a chord");
        assert!(seen.error < 5e-3 * seen.mean, "{seen:?}");
    }
}

/// Uneven heat and flames on grids of other transforms than the density's, against quadrature.
fn uneven() -> Emissivity {
    let turned = DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7)
        * DAffine3::from_scale(DVec3::new(0.11, 0.09, 0.1));
    let kelvin = |[x, y, z]: [i32; 3]| {
        let r = f64::from(x * x + 2 * y * y + z * z).sqrt();
        2200.0 - 160.0 * r + 60.0 * f64::from(x).sin()
    };
    let heat = Voxels::of_field([-9; 3], [9; 3], |voxel| kelvin(voxel).max(0.0)).sparse();
    let flame =
        Voxels::of_field([-5; 3], [7; 3], |[x, y, _]| f64::from((x + 5) * (7 - y))).sparse();
    let flame = Flame {
        grid: ValueGrid::new(&flame, DAffine3::from_scale(DVec3::splat(0.08)), &Limits::default())
            .unwrap()
            .unwrap(),
        color: Rgb::new(3.0, 2.0, 1.0),
    };
    Emissivity::new(ValueGrid::new(&heat, turned, &Limits::default()).unwrap(), Some(flame), 0.7)
}

#[test]
fn uneven_light_is_seen_as_quadrature_says() {
    let mut scene = alone(smoke(TINT, 0.0), uneven(), 10);
    for ray in rays() {
        let grid = grid_of(&scene.medium);
        let span = scene.medium.bounds.intersect(&ray).unwrap();
        let steps = 40_000;
        let step = span.length() / f64::from(steps);
        let truth: Rgb = (0..steps)
            .map(|i| {
                let distance = span.start + step * (f64::from(i) + 0.5);
                let seen = grid.transmittance(&ray, Span::new(span.start, distance));
                seen * scene.medium.emissivity_at(ray.at(distance)) * step
            })
            .sum();
        let emission = over_seeds(&mut scene, |scene| {
            let mut random = Stream::Experiment.random(scene.photons.seed, 0);
            mean_seen(scene, &[ray; 20], &mut random).emission.to_array()
        });
        for channel in 0..3 {
            emission[channel].assert_within(truth[channel], 1e-6 * truth[channel], "emission");
            assert!(emission[channel].error < 0.01 * truth[channel], "{:?}", emission[channel]);
        }
    }
}

/// 4 pi times the sum over voxels is the power, trilinear between them or not.
#[test]
fn the_power_of_a_flame_is_that_of_its_voxels() {
    let voxels = cloud(6);
    let volume = 0.13 * 0.11 * 0.12;
    let sum: f64 = voxels.sparse().values.iter().map(|&value| f64::from(value)).sum();
    let color = Rgb::new(1.0, 0.4, 0.1);
    let exact = color * (4.0 * PI * sum * volume);
    // Within the smoke, but not on its lattice.
    let place = DAffine3::from_translation(DVec3::new(0.07, -0.03, 0.05))
        * DAffine3::from_scale(DVec3::new(0.13, 0.11, 0.12));
    for kind in KINDS {
        let flame = ValueGrid::new(&voxels.sparse(), place, &Limits::default()).unwrap().unwrap();
        let mut scene = alone(smoke(TINT, 0.0), burning(flame, color), 4000);
        scene.photons.emission = kind;
        let own = scene.medium.emissivity.as_ref().unwrap().cells().unwrap().power();
        assert!((own / exact - Rgb::ONE).abs().max_element() < 0.01, "{own} for {exact}");
        // Its middle, too: photons come from where it burns.
        let [power, moment] = over_seeds(&mut scene, |scene| {
            let emission = emission(scene, grid_of(&scene.medium));
            let (mut power, mut moment) = (0.0, 0.0);
            for photon in (0..emission.count()).filter_map(|index| emission.photon(index)) {
                power += photon.power.x;
                moment += photon.power.x * (photon.ray.origin.y + 0.03);
            }
            [power, moment]
        });
        power.assert_is(exact.x, &format!("power, {kind:?}"));
        assert!(power.error < 0.005 * exact.x, "{power:?}");
        let values = voxels.leaves.iter().flat_map(|(leaf, (_, values))| {
            let height = move |n: usize| f64::from(leaf[1] + (n >> 3 & 7) as i32) * 0.11;
            values.iter().enumerate().map(move |(n, &value)| f64::from(value) * height(n))
        });
        moment.assert_is(4.0 * PI * values.sum::<f64>() * volume, &format!("moment, {kind:?}"));
    }
}

fn balance_of(scene: &Scene) -> PowerBalance {
    let balance = trace(scene).balance;
    let PowerBalance { emitted, absorbed, escaped, truncated, resampled } = balance;
    let left = emitted - absorbed - escaped - truncated - resampled;
    assert!((left / emitted).abs().max_element() < 1e-12, "{balance:?}");
    balance
}

/// Of what is emitted evenly in a ball of optical radius t, 3 / (8 t^3) (2 t^2 - 1 + (1 + 2 t) exp(-2 t)) escapes without a
/// collision (Case, de Hoffmann and Placzek 1953).
#[test]
fn what_escapes_a_glowing_ball_is_known() {
    for (depth, kind) in [(0.5, KINDS[0]), (2.0, KINDS[1]), (5.0, KINDS[2])] {
        let medium = grey_fog(ball(1.0), depth, 0.0, 0.0);
        let mut scene = alone(medium, hot(3000.0), 4000);
        scene.photons.emission = kind;
        let emitted = 4.0 * PI * depth * blackbody_radiance(3000.0).x * 4.0 / 3.0 * PI;
        let share = 3.0 / (8.0 * depth.powi(3))
            * (2.0 * depth * depth - 1.0 + (1.0 + 2.0 * depth) * (-2.0 * depth).exp());
        let [power, escaped] = over_seeds(&mut scene, |scene| {
            let balance = balance_of(scene);
            [balance.emitted.x / emitted, balance.escaped.x / emitted]
        });
        power.assert_is(1.0, &format!("emitted, depth {depth}"));
        escaped.assert_is(share, &format!("escaped, depth {depth}"));
        assert!(escaped.error < 0.015 * share, "{escaped:?}");
    }
}

#[test]
fn every_watt_of_a_fire_in_fog_is_accounted_for() {
    let path = tests().parent().unwrap().join("examples/scenes/fire.toml");
    let mut scene = Scene::load(&path).unwrap();
    scene.photons.count = 20_000;
    let own = scene.medium.emissivity.as_ref().unwrap().cells().unwrap().power();
    let bounds = scene.medium.bounds;
    scene.medium =
        Medium::of_volumes(vec![scene.medium, fog(bounds, Rgb::ONE, TINT, 0.2)]).unwrap();
    scene.lights.clear();
    let PowerBalance { emitted, absorbed, escaped, truncated, .. } = trace(&scene).balance;
    // Flames of 1900 K have no blue.
    let brightest = emitted.max_element();
    let lost = (emitted - absorbed - escaped - truncated).abs() / brightest;
    assert!(lost.max_element() < 1e-12, "{lost}");
    assert!((emitted - own).abs().max_element() < 0.02 * brightest, "{emitted} {own}");
}

#[test]
fn every_watt_of_light_and_heat_is_accounted_for() {
    for kind in KINDS {
        let mut scene = alone(smoke(TINT, 0.4), uneven(), 30_000);
        scene.photons.emission = kind;
        let own = balance_of(&scene).emitted;
        scene.lights.push(one_watt(DVec3::new(0.1, 0.2, 0.1)));
        let both = balance_of(&scene).emitted;
        let more = both - own;
        assert!((more - Rgb::ONE).abs().max_element() < 0.02 * own.max_element(), "{more} {own}");
        scene.photons.max_order = 1;
        assert!(balance_of(&scene).truncated.min_element() > 0.0);
    }
}

/// A flame far smaller than the fog lights it as a point light of its power does, though all that scatters of it comes
/// from photons, and single scattering of the light does not.
#[test]
fn a_small_flame_is_a_point_light() {
    let edge: f64 = 0.05;
    let mut voxels = Voxels::default();
    voxels.set([0; 3], 1.0);
    let color = Rgb::ONE / (4.0 * PI * edge.powi(3));
    let place = DAffine3::from_scale(DVec3::splat(edge));
    let fog = || fog(CUBE, Rgb::splat(1.0), TINT, 0.3);
    let flame = burning(
        ValueGrid::new(&voxels.sparse(), place, &Limits::default()).unwrap().unwrap(),
        color,
    );
    let mut burning = alone(fog(), flame, 60_000);
    let mut lit = scene(fog(), one_watt(DVec3::ZERO), 60_000);
    let scattered = |scene: &Scene| {
        let mut random = Stream::Experiment.random(scene.photons.seed, 0);
        let rays: Vec<Ray> = (0..40)
            .map(|i| passing_ray(DVec3::ZERO, 0.4 + 0.015 * f64::from(i), 3.0, &mut random))
            .collect();
        let seen = mean_seen(scene, &rays, &mut random);
        (seen.single + seen.multiple).to_array()
    };
    let (burning, lit) = (over_seeds(&mut burning, scattered), over_seeds(&mut lit, scattered));
    for channel in 0..3 {
        let ratio = burning[channel].mean / lit[channel].mean;
        println!("channel {channel}: {ratio:.4} of {:.4e}", lit[channel].mean);
        let difference = burning[channel].minus(lit[channel]);
        difference.assert_within(0.0, 0.01 * lit[channel].mean, "flame - light");
        assert!(difference.error < 0.01 * lit[channel].mean, "{difference:?}");
    }
}

/// Equal photons are what the map wants: those of a real fire differ, since heat glows unevenly within a voxel, but little.
#[test]
fn photons_of_a_fire_are_nearly_equal() {
    let path = tests().parent().unwrap().join("examples/scenes/fire.toml");
    let mut scene = Scene::load(&path).unwrap();
    scene.lights.clear();
    scene.photons.count = 100_000;
    let emission = emission(&scene, grid_of(&scene.medium));
    let power = |index| emission.photon(index).map_or(0.0, |photon| photon.power.x);
    let mut powers: Vec<f64> = (0..emission.count()).map(power).collect();
    powers.sort_by(f64::total_cmp);
    let mean = powers.iter().sum::<f64>() / powers.len() as f64;
    let squares = powers.iter().map(|power| power * power).sum::<f64>() / powers.len() as f64;
    let [median, high, largest] = [50_000, 99_000, 99_999].map(|rank| powers[rank] / mean);
    println!("median {median:.3}, 99 % below {high:.2}, largest {largest:.2} of the mean");
    println!("{:.3} of the photons would do if equal", mean * mean / squares);
    assert!(mean * mean / squares > 0.75 && largest < 40.0);
}

#[test]
fn photons_do_not_depend_on_the_threads() {
    let photons = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| trace(&alone(smoke(TINT, 0.4), uneven(), 30_000)).photons)
    };
    assert!(photons(1) == photons(3));
}

/// In equilibrium with walls of its own temperature a medium cannot be seen, whatever it scatters: every ray has the
/// radiance of a blackbody.
#[test]
fn a_medium_as_hot_as_its_walls_is_invisible() {
    let wall = blackbody_radiance(3000.0);
    let media: [(&str, Medium); 3] = [
        ("fog", fog(CUBE, Rgb::splat(2.0), TINT, 0.0)),
        ("ball", fog(ball(1.0), Rgb::splat(2.0), TINT, 0.5)),
        ("smoke", smoke(TINT, 0.3)),
    ];
    for (name, medium) in media {
        for photons_only in [false, true] {
            let medium = Medium { emissivity: None, color: None, ..clone_of(&medium) };
            let mut scene = alone(medium, hot(3000.0), 10_000);
            let sky = photonvdb::light::Environment::Constant(wall);
            scene.lights.push(photonvdb::light::Light::Environment(sky));
            scene.render.photons_only = photons_only;
            scene.estimate.k = 50;
            let seen = over_seeds(&mut scene, |scene| {
                let mut random = Stream::Experiment.random(scene.photons.seed, 0);
                let rays: Vec<Ray> = (0..60)
                    .map(|i| passing_ray(DVec3::ZERO, 0.01 * f64::from(i), 3.0, &mut random))
                    .collect();
                (mean_seen(scene, &rays, &mut random).total() / wall).to_array()
            });
            for (channel, seen) in seen.iter().enumerate() {
                let what = format!("{name}, photons only {photons_only}, channel {channel}");
                seen.assert_within(1.0, 0.01, &what);
                assert!(seen.error < 0.01, "{seen:?}");
            }
        }
    }
}

fn clone_of(medium: &Medium) -> Medium {
    let extinction = match &medium.extinction {
        MediumExtinction::Uniform(uniform) => MediumExtinction::Uniform(*uniform),
        MediumExtinction::Chromatic(chromatic) => MediumExtinction::Chromatic(*chromatic),
        MediumExtinction::Grid(_) | MediumExtinction::Several(_) => {
            return smoke(medium.albedo, 0.3);
        }
    };
    let (bounds, albedo, phase) = (medium.bounds, medium.albedo, medium.phase);
    Medium { bounds, extinction, albedo, color: None, phase, emissivity: None }
}

#[test]
fn cold_media_emit_nothing() {
    let scene = alone(smoke(TINT, 0.0), hot(290.0), 100);
    assert!(scene.medium.emissivity.as_ref().unwrap().cells().is_none());
    assert_eq!(trace(&scene).emitted_count, 0);
    let white = alone(smoke(Rgb::ONE, 0.0), hot(3000.0), 100);
    assert!(white.medium.emissivity.as_ref().unwrap().cells().is_none());
    let infinite = grey_fog(Bounds::Infinite, 1.0, 0.5, 0.0).with_emissivity(hot(3000.0));
    assert!(infinite.emissivity.is_none());
}

/// Flames need no density: through a transparent medium all of them is seen.
#[test]
fn flames_burn_in_transparent_media() {
    let medium = grey_fog(CUBE, 0.0, 0.5, 0.0);
    let scene = alone(medium, burning(everywhere(2.0), Rgb::ONE), 1000);
    let mut random = Stream::Experiment.random(0, 0);
    let seen = mean_seen(&scene, &[Ray::new(DVec3::Z * 4.0, DVec3::NEG_Z)], &mut random);
    assert!((seen.emission - Rgb::splat(4.0)).abs().max_element() < 1e-12, "{seen:?}");
    let balance = balance_of(&scene);
    assert_eq!(balance.escaped, balance.emitted);
}
