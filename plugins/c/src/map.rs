//! Photon maps, and the light read from them.

use std::num::NonZeroUsize;
use std::sync::Arc;

use photonvdb::estimate::Divisor;
use photonvdb::math::{DVec3, Ray, Stream};
use photonvdb::medium::Bounds;
use photonvdb::render::{LightReader, NotCalibrated, OwnedLitScene, RenderError, Unobserved};
use rayon::prelude::*;

use crate::borrow::{borrow, items, room};
use crate::scene::pvdb_scene;
use crate::{Failure, guarded, pvdb_status};

/// Points or rays that one task reads.
const SHARE: usize = 256;

/// A scene with its photon map. It does not change, and may be read from any number of threads at once.
#[allow(non_camel_case_types)]
#[derive(Debug)]
pub struct pvdb_map {
    lit: OwnedLitScene,
}

/// What the k nearest photons count as.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum pvdb_divisor {
    /// k.
    K = 0,
    /// k - 1.
    KMinusOne = 1,
    /// k - 1/2.
    KMinusHalf = 2,
    /// What was measured when the map was built: only if the scene says `divisor = "calibrated"`.
    Calibrated = 3,
}

/// Emits and traces the scene's photons and builds their map into `*map`, which is null if that fails. To be freed by `pvdb_map_free`;
/// the scene may be freed before.
///
/// # Safety
/// `scene` is null or a living scene; `map` is null or points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pvdb_map_build(
    scene: *const pvdb_scene,
    map: *mut *mut pvdb_map,
) -> pvdb_status {
    guarded(|| {
        if map.is_null() {
            return Err(Failure::null("map"));
        }
        // SAFETY: not null; the rest is the caller's.
        unsafe { map.write(std::ptr::null_mut()) };
        // SAFETY: the caller's.
        let scene = Arc::clone(&unsafe { borrow(scene, "scene") }?.scene);
        if matches!(scene.medium.bounds, Bounds::Infinite) {
            return Err(Failure::render(RenderError::InfiniteMedium));
        }
        let lit = OwnedLitScene::prepare(scene, &Unobserved).map_err(Failure::render)?;
        // SAFETY: as above.
        unsafe { map.write(Box::into_raw(Box::new(pvdb_map { lit }))) };
        Ok(())
    })
}

/// Frees a map. Null is ignored.
///
/// # Safety
/// `map` is null or was given by `pvdb_map_build` and not freed since.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pvdb_map_free(map: *mut pvdb_map) {
    if !map.is_null() {
        guarded(|| {
            // SAFETY: `Box::into_raw` made it; the rest is the caller's.
            drop(unsafe { Box::from_raw(map) });
            Ok(())
        });
    }
}

/// Photons stored in a map; 0 of null.
///
/// # Safety
/// `map` is null or a living map.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pvdb_map_photon_count(map: *const pvdb_map) -> u64 {
    let mut count = 0;
    guarded(|| {
        // SAFETY: the caller's.
        count = unsafe { borrow(map, "map") }?.lit.map().len() as u64;
        Ok(())
    });
    count
}

/// Fluence [W/m^2] at `count` points (x y z [m] each) into `rgb` (R G B each), from the photons of the map: scattered light, and direct light
/// too where the scene says `photons_only`. k and divisor are the scene's.
///
/// # Safety
/// `map` is null or a living map; `points` points to 3 * count doubles and `rgb` to 3 * count floats that nobody else uses
/// meanwhile, or they are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pvdb_map_fluence(
    map: *const pvdb_map,
    points: *const f64,
    count: usize,
    rgb: *mut f32,
) -> pvdb_status {
    guarded(|| {
        // SAFETY: the caller's.
        let (map, points, rgb) = unsafe { asked(map, points, count, rgb) }?;
        read(
            points,
            rgb,
            || map.lit.reader(),
            |reader, place| reader.fluence(place).value.as_vec3().to_array(),
        );
        Ok(())
    })
}

/// Power density [W/m^3] at `count` points (x y z [m] each) into `rgb` (R G B each), from the `k` nearest photons of the map, which count as
/// `divisor` says.
///
/// # Safety
/// As for `pvdb_map_fluence`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pvdb_map_power_density(
    map: *const pvdb_map,
    points: *const f64,
    count: usize,
    k: usize,
    // A number, as C lets an enumeration hold any.
    divisor: u32,
    rgb: *mut f32,
) -> pvdb_status {
    guarded(|| {
        // SAFETY: the caller's.
        let (map, points, rgb) = unsafe { asked(map, points, count, rgb) }?;
        let k = NonZeroUsize::new(k).ok_or_else(|| Failure::argument("k must be at least 1"))?;
        let divisor = divisor_of(divisor)?;
        // What is refused is refused before the work.
        let refused = |error: NotCalibrated| Failure::argument(error.to_string());
        map.lit.reader_with(k, divisor).map_err(refused)?;
        let reader = || map.lit.reader_with(k, divisor).unwrap_or_else(|_| map.lit.reader());
        read(points, rgb, reader, |reader, place| {
            reader.power_density(place).value.as_vec3().to_array()
        });
        Ok(())
    })
}

/// Light along `count` segments: from `origins` (x y z [m] each) along `directions` (x y z each, of any length but 0) over `t_max` metres (one a
/// ray; infinity for no end). `radiance` takes what travels back [W/(m^2 sr)], scattered and emitted, and lights that are seen within the segment;
/// `transmittance` the share of light from behind it that passes (R G B each); either may be null. Equal `seed`s give
/// equal results.
///
/// # Safety
/// `map` is null or a living map; arrays point to 3 * count numbers each, `t_max` to count, that nobody else uses meanwhile, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pvdb_map_radiance(
    map: *const pvdb_map,
    origins: *const f64,
    directions: *const f64,
    t_max: *const f64,
    count: usize,
    seed: u64,
    radiance: *mut f32,
    transmittance: *mut f32,
) -> pvdb_status {
    guarded(|| {
        // SAFETY: the caller's.
        let map = unsafe { borrow(map, "map") }?;
        // SAFETY: the caller's.
        let (origins, directions, t_max) = unsafe {
            (
                items::<3>(origins, count, "origins")?,
                items::<3>(directions, count, "directions")?,
                items::<1>(t_max, count, "t_max")?,
            )
        };
        let given = |numbers: *mut f32| if numbers.is_null() { 0 } else { count };
        // SAFETY: the caller's; a null pointer has no items.
        let (radiance, transmittance) = unsafe {
            (
                room::<3>(radiance, given(radiance), "radiance")?,
                room::<3>(transmittance, given(transmittance), "transmittance")?,
            )
        };
        let rays = rays(origins, directions, t_max)?;
        let seen: Vec<[[f32; 3]; 2]> = rays
            .par_iter()
            .enumerate()
            .with_min_len(SHARE)
            .map_init(
                || map.lit.reader(),
                |reader, (number, (ray, t_max))| {
                    let mut random = Stream::Pixel.random(seed, number as u64);
                    let seen = reader.radiance(ray, *t_max, &mut random);
                    let light = seen.single_scatter + seen.multiple_scatter + seen.emission;
                    [light, seen.transmittance].map(|color| color.as_vec3().to_array())
                },
            )
            .collect();
        for (number, [light, _]) in radiance.iter_mut().zip(&seen) {
            *number = *light;
        }
        for (number, [_, passing]) in transmittance.iter_mut().zip(&seen) {
            *number = *passing;
        }
        Ok(())
    })
}

/// Rays of unit direction, each with its length.
fn rays(
    origins: &[[f64; 3]],
    directions: &[[f64; 3]],
    t_max: &[[f64; 1]],
) -> Result<Vec<(Ray, f64)>, Failure> {
    let ray = |((origin, direction), [t_max]): ((&[f64; 3], &[f64; 3]), &[f64; 1])| {
        let origin = finite(origin)?;
        let direction = finite(direction)?.try_normalize();
        let direction = direction.ok_or_else(|| Failure::argument("a direction has no length"))?;
        if t_max.is_nan() || *t_max < 0.0 {
            return Err(Failure::argument(format!("t_max must not be {t_max}")));
        }
        Ok((Ray::new(origin, direction), *t_max))
    };
    origins.iter().zip(directions).zip(t_max).map(ray).collect()
}

fn finite(place: &[f64; 3]) -> Result<DVec3, Failure> {
    let place = DVec3::from_array(*place);
    if place.is_finite() {
        return Ok(place);
    }
    Err(Failure::argument("a coordinate is not finite"))
}

fn divisor_of(number: u32) -> Result<Divisor, Failure> {
    match number {
        0 => Ok(Divisor::K),
        1 => Ok(Divisor::KMinus1),
        2 => Ok(Divisor::KMinusHalf),
        3 => Ok(Divisor::Calibrated),
        _ => Err(Failure::argument(format!("there is no divisor {number}"))),
    }
}

/// A map, the points it is asked about, and room for the answers.
type Asked<'a> = (&'a pvdb_map, Vec<DVec3>, &'a mut [[f32; 3]]);

/// # Safety
/// As for `pvdb_map_fluence`.
unsafe fn asked<'a>(
    map: *const pvdb_map,
    points: *const f64,
    count: usize,
    rgb: *mut f32,
) -> Result<Asked<'a>, Failure> {
    // SAFETY: the caller's.
    unsafe {
        let points = items::<3>(points, count, "points")?;
        let places = points.iter().map(finite).collect::<Result<_, _>>()?;
        Ok((borrow(map, "map")?, places, room::<3>(rgb, count, "rgb")?))
    }
}

/// Answers for all points, on all threads.
fn read<'a>(
    points: Vec<DVec3>,
    rgb: &mut [[f32; 3]],
    reader: impl Fn() -> Box<dyn LightReader + 'a> + Send + Sync,
    answer: impl Fn(&mut dyn LightReader, DVec3) -> [f32; 3] + Sync,
) {
    let shares = rgb.par_chunks_mut(SHARE).zip(points.par_chunks(SHARE));
    shares.for_each_init(reader, |reader, (rgb, points)| {
        rgb.iter_mut()
            .zip(points)
            .for_each(|(stored, place)| *stored = answer(reader.as_mut(), *place));
    });
}
