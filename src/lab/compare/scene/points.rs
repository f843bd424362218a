//! Places of a scene where photons are, and what the maps of each way of emission read there.

use std::num::NonZeroUsize;

use rayon::prelude::*;

use super::error::SceneComparisonError;
use super::place::{Balls, Place, STEP_COUNT};
use super::request::SceneComparison;
use crate::emission::EmissionKind;
use crate::lab::compare::query_errors::{QueryErrors, photons_sought};
use crate::lab::compare::row::Sample;
use crate::map::NearestPhotons;
use crate::math::{Stream, uniform};
use crate::render::{LitScene, Unobserved};
use crate::scene::Scene;

/// Photons that the inner balls of all maps together hold: the density there is known to 7 % at a place, to 0.2 % over a
/// thousand.
const INNER_COUNT: f64 = 200.0;

/// Most readings kept: 32 bytes each.
const MOST_READINGS: u128 = 10_000_000;

/// What all maps say.
pub(super) struct PointSamples {
    /// Of each way of emission, k by k.
    pub(super) samples: Vec<Vec<Sample>>,
    /// Processor time of a map and its queries, of each way \[s\].
    pub(super) seconds: Vec<Option<f64>>,
    /// Photons of a map in the inner ball, in the mean.
    pub(super) inner_count: f64,
}

/// Asks `runs` maps of each way of emission at the same places.
pub(super) fn measure(
    request: &SceneComparison,
    scene: &mut Scene,
    ks: &[u64],
    processor_seconds: &impl Fn() -> Option<f64>,
    advanced: &mut impl FnMut(),
) -> Result<PointSamples, SceneComparisonError> {
    let map_count = request.emissions.len() as u128 * u128::from(request.runs);
    let values = map_count * u128::from(request.queries) * ks.len() as u128;
    if values > MOST_READINGS {
        return Err(SceneComparisonError::TooMuch {
            what: "points",
            values,
            limit: MOST_READINGS,
            flags: "--queries, --runs or the number of --k",
        });
    }
    let largest = ks.last().copied().unwrap_or(1);
    let sought = photons_sought(largest);
    let per_step = (map_count - 1) as f64 * sought as f64 / STEP_COUNT as f64;
    let inner_step = ((INNER_COUNT / per_step).ceil() as usize).clamp(1, STEP_COUNT);
    let balls = Balls { ks, inner_step };
    let mut places = places(request, scene, sought, largest)?;

    let mut seconds = Vec::new();
    for &kind in &request.emissions {
        let started = processor_seconds();
        for run in 0..request.runs {
            let seed = Stream::Experiment.hash(request.seed, 2 + kind as u64);
            prepare(scene, kind, Stream::Experiment.hash(seed, run));
            let lit = LitScene::prepare(scene, &Unobserved)?;
            let stored = lit.map().len();
            let asked = places.par_chunks_mut(16).map(|places| {
                let mut finder = NearestPhotons::new(lit.map());
                places.iter_mut().try_for_each(|place| place.ask(&mut finder, balls))
            });
            asked
                .collect::<Option<()>>()
                .ok_or_else(|| too_few(request, scene, stored, largest, largest))?;
            advanced();
        }
        let spent = started.zip(processor_seconds()).map(|(start, end)| end - start);
        seconds.push(spent.map(|spent| spent / request.runs as f64));
    }

    let bounds = &scene.medium.bounds;
    let of_map = |map: usize| {
        let mut errors = vec![QueryErrors::default(); ks.len()];
        for place in &places {
            let read = place.errors(map, map_count as usize, balls, bounds);
            for (errors, read) in errors.iter_mut().zip(read) {
                errors.intrinsic.add(read.intrinsic);
                errors.smoothing.add(read.smoothing);
                errors.total.add(read.total);
            }
        }
        errors
    };
    let maps: Vec<Vec<QueryErrors>> = (0..map_count as usize).into_par_iter().map(of_map).collect();
    let samples = maps.chunks(request.runs as usize).map(|maps| {
        (0..ks.len()).map(|index| Sample::of(maps.iter().map(|errors| errors[index]))).collect()
    });
    let inner_count = sought as f64 * inner_step as f64 / STEP_COUNT as f64;
    Ok(PointSamples { samples: samples.collect(), seconds, inner_count })
}

/// Makes the scene emit so.
pub(super) fn prepare(scene: &mut Scene, kind: EmissionKind, seed: u64) {
    scene.photons.emission = kind;
    scene.photons.seed = seed;
}

/// Places of photons of a map of its own, and how far about each to look.
fn places(
    request: &SceneComparison,
    scene: &mut Scene,
    sought: u64,
    largest: u64,
) -> Result<Vec<Place>, SceneComparisonError> {
    prepare(scene, EmissionKind::Random, Stream::Experiment.hash(request.seed, 1));
    let lit = LitScene::prepare(scene, &Unobserved)?;
    let map = lit.map();
    let stored = map.len();
    let wanted = usize::try_from(sought).ok().filter(|&sought| sought <= stored);
    let Some(wanted) = wanted.and_then(NonZeroUsize::new) else {
        return Err(too_few(request, scene, stored, largest, sought));
    };
    let frame = map.frame();
    let mut finder = NearestPhotons::new(map);
    let mut random = Stream::Experiment.random(request.seed, 1);
    let places = (0..request.queries).map(|_| {
        let photon = (uniform(&mut random) * stored as f64) as u32;
        let position = frame.to_world(map.offset(photon, [0.0; 3]).to_array());
        let nearest = finder.find(position, wanted, f64::INFINITY);
        Place::new(position, f64::from(nearest.radius) * frame.unit)
    });
    Ok(places.collect())
}

fn too_few(
    request: &SceneComparison,
    scene: &Scene,
    stored: usize,
    k: u64,
    needed: u64,
) -> SceneComparisonError {
    let is_single_left_out = !scene.render.photons_only && scene.medium.emissivity.is_none();
    let way_out = if is_single_left_out && stored == 0 {
        "no light scatters more than once; --photons-only puts what scatters once into the map, too"
    } else if is_single_left_out {
        "raise --n, lower --k, or put light scattered once into the map, too, with --photons-only"
    } else {
        "raise --n or lower --k"
    };
    SceneComparisonError::TooFewPhotons { n: request.n, stored, k, needed, way_out }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Columns, PhotonMap};
    use crate::math::DVec3;
    use crate::medium::Bounds;
    use crate::trace::{MapFrame, Photon};

    /// Independent photons, evenly in a box: k reads 1/(k - 1) too much, nothing is smoothed, and a place near a face is no
    /// worse off.
    #[test]
    fn errors_of_independent_photons_are_those_of_theory() {
        let bounds = Bounds::Box { min: DVec3::ZERO, max: DVec3::ONE };
        let ks = [5, 20];
        let balls = Balls { ks: &ks, inner_step: 40 };
        let mut random = Stream::Experiment.random(7, 0);
        let middle = DVec3::splat(0.5);
        let mut places: Vec<Place> = (0..200)
            .map(|i| {
                let at: [f64; 3] = std::array::from_fn(|_| uniform(&mut random));
                let place = DVec3::from_array(at);
                Place::new(if i % 2 == 0 { middle + 0.4 * (place - middle) } else { place }, 0.25)
            })
            .collect();
        let map_count = 64;
        for _ in 0..map_count {
            let photons: Vec<Photon> = (0..2000)
                .map(|_| Photon {
                    position: std::array::from_fn(|_| uniform(&mut random) as f32),
                    direction: [0.0, 0.0, 1.0],
                    power: [0.5e-3; 3],
                    sigma_t: 1.0,
                    order: 0,
                })
                .collect();
            let frame = MapFrame { origin: DVec3::ZERO, unit: 1.0 };
            let map = PhotonMap::build(&photons, frame, Columns::default()).unwrap();
            let mut finder = NearestPhotons::new(&map);
            places.iter_mut().for_each(|place| place.ask(&mut finder, balls).unwrap());
        }
        for (index, &k) in ks.iter().enumerate() {
            let sample = Sample::of((0..map_count).map(|map| {
                let mut errors = QueryErrors::default();
                for place in &places {
                    let read = place.errors(map, map_count, balls, &bounds).nth(index).unwrap();
                    errors.intrinsic.add(read.intrinsic);
                    errors.smoothing.add(read.smoothing);
                    errors.total.add(read.total);
                }
                errors
            }));
            let intrinsic = sample.over_maps(|map| map.intrinsic.bias());
            // The reference has an error of its own, that of 64 maps as against one's 64.
            let error = intrinsic.std_error() * 2.0_f64.sqrt();
            let exact = 1.0 / (k as f64 - 1.0);
            let z = (intrinsic.bias() - exact) / error;
            assert!(z.abs() < 4.5, "k = {k}: {} {exact}, z = {z}", intrinsic.bias());
            let smoothing = sample.over_maps(|map| map.smoothing.bias());
            // Of 5 x 63 photons a place: 6 % over 200 places, some of which share photons.
            assert!(smoothing.bias().abs() < 0.02, "k = {k}: {}", smoothing.bias());
            let total = sample.over_maps(|map| map.total.bias());
            assert!((total.bias() / intrinsic.bias() - 1.0).abs() < 0.1, "k = {k}");
        }
    }
}
