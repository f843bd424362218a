//! Furnaces: under radiance 1 from all sides, a medium that absorbs nothing, or glows as much as it absorbs, cannot be seen.
//!
//! All of it comes from photons here. Collisions of one photon lie together, so that k - 1, which serves independent photons,
//! reads too much by up to sigma_t r_k / k.

use std::f64::consts::PI;

use super::Extent;
use super::check::{Batch, Check, Quantity};
use super::error::ValidateError;
use super::field::{Cloud, everywhere};
use super::stage::{CUBE, ball, fog, passing_ray, scene, smoke, white_sky};
use crate::light::{Environment, Light};
use crate::math::{DVec3, Rgb, Stream};
use crate::medium::{Emissivity, Medium, blackbody_radiance};
use crate::render::{LitScene, Unobserved};
use crate::scene::Scene;

const GROUP: &str = "furnace";

/// What photons of one path may add.
const CLUSTER_BIAS: f64 = 0.005;

/// Temperature of hot media and walls \[K\].
const HEAT: f32 = 3000.0;

const RAYS: usize = 40;

pub(super) fn checks<'a>(extent: Extent) -> Vec<Check<'a>> {
    let box_of_fog: fn(f64) -> Result<Medium, ValidateError> = |a| Ok(fog(CUBE, 2.0, a, 0.3));
    let ball_of_fog: fn(f64) -> Result<Medium, ValidateError> =
        |a| Ok(fog(ball(1.0), 2.0, a, 0.85));
    let cloud: fn(f64) -> Result<Medium, ValidateError> =
        |a| Ok(smoke(Cloud::new().extinction(6.0)?, a, 0.3));
    let media = [("box, g 0.3", box_of_fog), ("ball, g 0.85", ball_of_fog), ("cloud", cloud)];
    let mut checks = vec![power_density(extent)];
    for (name, medium) in media {
        checks.push(white(extent, name, medium));
        checks.push(hot(extent, name, medium));
    }
    checks
}

/// E6: power density is 4 pi sigma_t everywhere, on faces, edges and in corners too.
fn power_density<'a>(extent: Extent) -> Check<'a> {
    let places = [
        ("inside", DVec3::new(0.2, -0.1, 0.3)),
        ("on a face", DVec3::new(1.0, -0.3, 0.2)),
        ("on an edge", DVec3::new(1.0, -1.0, 0.4)),
        ("in a corner", DVec3::new(-1.0, 1.0, -1.0)),
    ];
    let sigma_t = 1.5;
    let quantities = places.map(|(name, _)| {
        let of = Quantity::new(format!("E6: power density {name}"), 4.0 * PI * sigma_t);
        of.within(CLUSTER_BIAS)
    });
    Check::new(GROUP, quantities.to_vec(), extent.pick(5000, 20_000), move |batch| {
        let mut scene = scene(fog(CUBE, sigma_t, 1.0, 0.5), vec![white_sky()], batch)?;
        scene.render.photons_only = true;
        scene.estimate.k = 50;
        let lit = LitScene::prepare(&scene, &Unobserved)?;
        let mut reader = lit.reader();
        let signs = |n: usize| DVec3::from_array([0, 1, 2].map(|axis| mirror(n, axis)));
        let mut mean = |place: DVec3| {
            let images = (0..8).map(|n| reader.power_density(place * signs(n)).value.x);
            images.sum::<f64>() / 8.0
        };
        Ok(places.iter().map(|&(_, place)| mean(place)).collect())
    })
}

/// -1 or 1, by a bit of `n`.
fn mirror(n: usize, axis: usize) -> f64 {
    if n >> axis & 1 == 0 { 1.0 } else { -1.0 }
}

/// E7: scattered light over the share of rays that scatter.
fn white<'a>(
    extent: Extent,
    name: &str,
    medium: fn(f64) -> Result<Medium, ValidateError>,
) -> Check<'a> {
    let quantity = Quantity::new(format!("E7, {name}: white furnace"), 1.0).within(CLUSTER_BIAS);
    Check::new(GROUP, vec![quantity], extent.pick(4000, 20_000), move |batch| {
        let mut scene = scene(medium(1.0)?, vec![white_sky()], batch)?;
        scene.estimate.k = 50;
        let (scattered, unscattered) = seen(&mut scene, batch)?;
        Ok(vec![scattered / (1.0 - unscattered)])
    })
}

/// E8: as hot as its walls.
fn hot<'a>(
    extent: Extent,
    name: &str,
    medium: fn(f64) -> Result<Medium, ValidateError>,
) -> Check<'a> {
    let quantity = Quantity::new(format!("E8, {name}: as hot as its walls"), 1.0).within(0.01);
    Check::new(GROUP, vec![quantity], extent.pick(2500, 20_000), move |batch| {
        let wall = blackbody_radiance(f64::from(HEAT));
        let heat = Emissivity::new(Some(everywhere(HEAT)?), None, 1.0 / wall.x);
        let glowing = medium(0.7)?.with_emissivity(heat);
        let sky = Light::Environment(Environment::Constant(Rgb::ONE * wall / wall.x));
        let mut scene = scene(glowing, vec![sky], batch)?;
        scene.estimate.k = 50;
        let (scattered, unscattered) = seen(&mut scene, batch)?;
        Ok(vec![scattered + unscattered])
    })
}

/// Light along rays, scattered and not, all from photons.
fn seen(scene: &mut Scene, batch: Batch) -> Result<(f64, f64), ValidateError> {
    scene.render.photons_only = true;
    let lit = LitScene::prepare(scene, &Unobserved)?;
    let mut reader = lit.reader();
    let mut random = Stream::Experiment.random(batch.seed, 0);
    let (mut scattered, mut unscattered) = (0.0, 0.0);
    for step in 0..RAYS {
        let ray = passing_ray(0.6 * step as f64 / RAYS as f64, 4.0, &mut random);
        let light = reader.radiance(&ray, f64::INFINITY, &mut random);
        scattered += (light.single_scatter.x + light.multiple_scatter.x) / RAYS as f64;
        unscattered += light.emission.x / RAYS as f64;
    }
    Ok((scattered, unscattered))
}
