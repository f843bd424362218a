//! A light on a corner of voxels, and needles of light.

use super::super::check::{Check, Quantity};
use super::super::error::ValidateError;
use super::super::field::{extinction, sparse};
use super::super::report::Row;
use super::super::stage::{CUBE, emission, fog, needle, one_watt, scene, smoke, trace};
use super::{FEW, noisy};
use crate::math::{DAffine3, DVec3, Ray, Stream};
use crate::medium::MediumExtinction;
use crate::render::{LitScene, Unobserved};
use crate::trace::PowerBalance;

const CORNER: &str = "light on a voxel corner";
const NEEDLE: &str = "needle spots";

pub(super) fn rows() -> Result<Vec<Row>, ValidateError> {
    let mut rows = on_a_corner()?;
    for angle in [1e-3, 1e-6, 1e-8] {
        rows.extend(needles(angle)?);
    }
    Ok(rows)
}

/// Whichever of eight cells owns the light, the picture is the same.
fn on_a_corner() -> Result<Vec<Row>, ValidateError> {
    let seen = |light: DVec3| {
        let grid = sparse([-8; 3], [8; 3], 0.0, |[x, y, z]| {
            1.0 + 0.1 * f64::from((x * 7 + y * 3 + z * 5) & 3)
        });
        let place = DAffine3::from_scale(DVec3::splat(0.125));
        let medium = smoke(extinction(&grid, place, 1.0)?, 0.9, 0.0);
        let scene = scene(medium, vec![one_watt(light)], FEW)?;
        let lit = LitScene::prepare(&scene, &Unobserved)?;
        let mut random = Stream::Experiment.random(0, 0);
        let eye = DVec3::new(3.0, 1.0, 2.0);
        let ray = Ray::new(eye, (DVec3::new(0.0, 0.3, 0.1) - eye).normalize());
        let radiance = lit.reader().radiance(&ray, f64::INFINITY, &mut random);
        Ok::<_, ValidateError>((radiance.single_scatter.x, trace(&scene).balance.emitted.x))
    };
    let (here, emitted) = seen(DVec3::ZERO)?;
    let mut rows = Vec::new();
    for corner in 0..8 {
        let side = |bit: i32| if corner >> bit & 1 == 0 { 1e-9 } else { -1e-9 };
        let (there, _) = seen(DVec3::new(side(0), side(1), side(2)))?;
        let name = format!("moved by 1e-9 m into cell {corner}: light over that on the corner");
        rows.push(Row::exact(CORNER, name, 1.0, there / here, 1e-6));
    }
    rows.push(Row::exact(CORNER, "power", 1.0, emitted, 0.02));
    Ok(rows)
}

/// Uniform in the solid angle: the squared sine, of at most the squared angle, is uniform, too.
fn needles(angle: f64) -> Result<Vec<Row>, ValidateError> {
    let lit = move |batch| {
        let light = needle(DVec3::new(0.0, 0.0, -3.0), DVec3::Z, angle);
        scene(fog(CUBE, 2.0, 0.8, 0.3), vec![light], batch)
    };
    let quantities = vec![
        Quantity::new(format!("{angle:e} rad: power"), 1.0),
        Quantity::new(format!("{angle:e} rad: mean squared sine over the largest"), 0.5),
    ];
    let check = Check::new(NEEDLE, quantities, 2000, move |batch| {
        let scene = lit(batch)?;
        let MediumExtinction::Uniform(extinction) = &scene.medium.extinction else {
            return Err(ValidateError::Scene);
        };
        let emission = emission(&scene, extinction);
        let (mut power, mut squares) = (0.0, 0.0);
        for photon in (0..emission.count()).filter_map(|index| emission.photon(index)) {
            let across = photon.ray.direction.truncate().length_squared() / (angle * angle);
            power += photon.power.x;
            squares += photon.power.x * across;
        }
        Ok(vec![power, squares])
    });
    let mut rows = noisy(&[check])?;
    let PowerBalance { emitted, absorbed, escaped, .. } = trace(&lit(FEW)?).balance;
    let whole = (absorbed + escaped).x / emitted.x;
    let name = format!("{angle:e} rad: absorbed + escaped over emitted");
    rows.push(Row::exact(NEEDLE, name, 1.0, whole, 1e-12));
    Ok(rows)
}
