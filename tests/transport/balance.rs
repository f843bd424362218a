//! Where the power of photons goes: every watt emitted is absorbed, escapes, or is counted as cut off.

use crate::grid_support::cloud;
use crate::transport_support::*;
use photonvdb::emission::EmissionKind;
use photonvdb::math::{DAffine3, DVec3, Rgb};
use photonvdb::medium::{Bounds, Medium};
use photonvdb::scene::Scene;
use photonvdb::trace::PowerBalance;

fn smoke(albedo: Rgb, g: f64) -> Medium {
    let place = DAffine3::from_scale(DVec3::splat(0.1));
    grid_medium(cloud(10).extinction(place, 4.0), albedo, g)
}

/// emitted - absorbed - escaped - truncated - resampled, over what was emitted.
fn imbalance(balance: &PowerBalance) -> f64 {
    let PowerBalance { emitted, absorbed, escaped, truncated, resampled } = *balance;
    ((emitted - absorbed - escaped - truncated - resampled) / emitted).abs().max_element()
}

fn balance_of(scene: &Scene) -> PowerBalance {
    let balance = trace(scene).balance;
    assert!(imbalance(&balance) < 1e-12, "{balance:?}");
    balance
}

const COLORS: Rgb = Rgb::new(0.5, 1.0, 3.0);
const TINTS: Rgb = Rgb::new(1.0, 0.8, 0.2);

#[test]
fn every_watt_is_accounted_for() {
    let media = || {
        [
            grey_fog(CUBE, 2.0, 0.9, 0.0),
            grey_fog(ball(1.0), 2.0, 0.7, -0.4),
            fog(CUBE, Rgb::splat(2.0), TINTS, 0.6),
            fog(CUBE, COLORS, Rgb::splat(0.9), 0.3),
            fog(ball(1.0), COLORS, TINTS, 0.0),
            smoke(Rgb::splat(0.95), 0.3),
            smoke(TINTS, 0.0),
            Medium::of_volumes(vec![smoke(TINTS, 0.5), grey_fog(CUBE, 1.0, 0.9, 0.0)]).unwrap(),
        ]
    };
    for kind in [EmissionKind::Random, EmissionKind::Stratified, EmissionKind::Sobol] {
        for medium in media() {
            let mut scene = scene(medium, one_watt(DVec3::new(0.2, 0.1, -0.3)), 20_000);
            scene.lights.push(white_sky());
            scene.photons.emission = kind;
            let whole = balance_of(&scene);
            assert_eq!(whole.truncated, Rgb::ZERO);
            assert!(whole.escaped.min_element() > 0.0, "{whole:?}");
            scene.photons.max_order = 2;
            assert!(balance_of(&scene).truncated.max_element() > 0.0);
        }
    }
}

/// The sum of the photons' powers is the light's own, in the mean.
#[test]
fn a_point_light_inside_emits_its_power() {
    for medium in [grey_fog(CUBE, 1.0, 0.9, 0.0), smoke(TINTS, 0.0)] {
        let mut scene = scene(medium, one_watt(DVec3::new(0.3, 0.2, 0.1)), 4000);
        scene.photons.emission = EmissionKind::Random;
        let [emitted] = over_seeds(&mut scene, |scene| [balance_of(scene).emitted.x]);
        emitted.assert_is(1.0, "emitted");
        assert!(emitted.error < 0.01, "{emitted:?}");
    }
}

/// E1 and E2 at the ends of the range: albedo 0 leaves one collision a photon at most, albedo 1 absorbs nothing.
#[test]
fn albedo_zero_and_one_are_exact() {
    for black in
        [grey_fog(CUBE, 1.5, 0.0, 0.5), fog(CUBE, COLORS, Rgb::ZERO, 0.0), smoke(Rgb::ZERO, 0.0)]
    {
        let scene = scene(black, one_watt(DVec3::ZERO), 20_000);
        let traced = trace(&scene);
        assert!(traced.photons.len() <= 20_000);
        assert!(traced.photons.iter().all(|photon| photon.order == 0));
        let stored: f64 = traced.photons.iter().map(|photon| f64::from(photon.power[1])).sum();
        let absorbed = traced.balance.absorbed.y;
        assert!((stored - absorbed).abs() < 1e-6 * absorbed, "{stored} {absorbed}");
    }
    for white in
        [grey_fog(CUBE, 1.5, 1.0, 0.5), fog(CUBE, COLORS, Rgb::ONE, 0.0), smoke(Rgb::ONE, 0.0)]
    {
        let scene = scene(white, one_watt(DVec3::ZERO), 20_000);
        let balance = balance_of(&scene);
        assert_eq!(balance.absorbed, Rgb::ZERO);
        let left = balance.emitted - balance.resampled - balance.escaped;
        assert!(left.abs().max_element() < 1e-12, "{balance:?}");
    }
}

#[test]
fn grey_media_resample_nothing() {
    for medium in [fog(CUBE, Rgb::splat(2.0), TINTS, 0.5), smoke(TINTS, 0.5)] {
        let scene = scene(medium, one_watt(DVec3::ZERO), 20_000);
        assert_eq!(balance_of(&scene).resampled, Rgb::ZERO);
    }
}

/// Photons of three colours at once, against photons of one colour in the medium that this colour sees.
#[test]
fn each_channel_of_a_chromatic_medium_goes_its_own_way() {
    for bounds in [CUBE, Bounds::Sphere { center: DVec3::X, radius: 1.5 }] {
        let light = || one_watt(DVec3::new(0.3, 0.2, 0.1));
        let mut colored = scene(fog(bounds, COLORS, TINTS, 0.4), light(), 4000);
        let figures = over_seeds(&mut colored, |scene| {
            let PowerBalance { absorbed, escaped, resampled, .. } = balance_of(scene);
            [absorbed, escaped, resampled].map(|rgb| rgb.to_array()).concat().try_into().unwrap()
        });
        let figures: [Runs; 9] = figures;
        for channel in 0..3 {
            figures[6 + channel].assert_is(0.0, &format!("resampled, channel {channel}"));
            let medium = grey_fog(bounds, COLORS[channel], TINTS[channel], 0.4);
            let mut grey = scene(medium, light(), 4000);
            let [absorbed, escaped] = over_seeds(&mut grey, |scene| {
                let balance = balance_of(scene);
                [balance.absorbed.x, balance.escaped.x]
            });
            figures[channel]
                .minus(absorbed)
                .assert_is(0.0, &format!("absorbed, channel {channel}"));
            figures[3 + channel]
                .minus(escaped)
                .assert_is(0.0, &format!("escaped, channel {channel}"));
        }
    }
}

/// E3: absorbed power is sigma_a / sigma_t times the power that collided, in the mean.
#[test]
fn absorption_is_a_share_of_collisions() {
    let light = one_watt(DVec3::new(3.0, 0.5, 0.2));
    let albedo = Rgb::new(0.9, 0.8, 0.2);
    let mut scene = scene(fog(CUBE, Rgb::splat(1.5), albedo, 0.5), light, 4000);
    let differences = over_seeds(&mut scene, |scene| {
        let traced = trace(scene);
        let collided: Rgb =
            traced.photons.iter().map(|photon| Rgb::from_array(photon.power.map(f64::from))).sum();
        (traced.balance.absorbed - (Rgb::ONE - albedo) * collided).to_array()
    });
    for difference in differences {
        // Stored powers are of single precision.
        difference.assert_within(0.0, 1e-7, "absorbed - (1 - albedo) collided");
    }
}
