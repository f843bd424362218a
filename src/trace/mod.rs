//! Tracing: from emitted photons to photons stored at collisions.
//!
//! A photon flies until it collides: its first flight is exactly inverted, so that strata hold; later ones are
//! analytic in uniform media and delta tracking in grids. At a collision it is stored with its power before the albedo,
//! and scatters. It survives with the probability that its power keeps, so that photons stay equally strong and the
//! mean is exact. Photons are traced in fixed shares that are merged in order: the result does not depend on the
//! number of threads.

mod balance;
mod frame;
mod path;
mod photon;

pub use balance::PowerBalance;
pub use frame::MapFrame;
pub use path::Keep;
pub use photon::Photon;

use path::Path;
use rayon::prelude::*;

use crate::emission::{Emission, EmittedPhoton};
use crate::math::{Ray, Rgb, Span};
use crate::medium::{Extinction, Medium};

/// Photons traced by one task: small enough to balance the load, large enough to be worth a task.
const SHARE: u64 = 8192;

/// What to keep of the photons' paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceSettings {
    /// Scatterings followed.
    pub max_order: u32,
    /// Collisions of lower order are not stored: 1 where single scattering is computed without photons. Of photons that the
    /// medium itself emitted all are.
    pub min_stored_order: u32,
    /// Most photons to store; tracing stops beyond.
    pub max_stored: usize,
}

/// The photons of a pass.
#[derive(Clone, Debug, Default)]
pub struct TracedPhotons {
    /// Stored photons, in the order of emission.
    pub photons: Vec<Photon>,
    /// Photons emitted: what estimates are normalised by is already in the powers.
    pub emitted_count: u64,
    /// Where the power went.
    pub balance: PowerBalance,
    /// Whether the pass was cut short at `max_stored`.
    pub overflow: bool,
}

/// Traces the photons that `emission` looks at and stores their collisions. `advanced` is told of photons done, from any thread.
pub fn trace_photons<E: Extinction>(
    emission: &Emission,
    medium: &Medium,
    extinction: &E,
    frame: MapFrame,
    settings: TraceSettings,
    advanced: impl Fn(u64) + Sync,
) -> TracedPhotons {
    let count = emission.chosen_count();
    let before = emission.rays().start * emission.photons_per_ray();
    let shares = count.div_ceil(SHARE);
    // A batch of shares at a time bounds what is held twice while merging.
    let batch = 64 * rayon::current_num_threads() as u64;
    let mut traced = TracedPhotons { emitted_count: count, ..TracedPhotons::default() };
    for first in (0..shares).step_by(batch as usize) {
        let parts: Vec<(Vec<Photon>, PowerBalance)> = (first..(first + batch).min(shares))
            .into_par_iter()
            .map(|share| {
                let end = ((share + 1) * SHARE).min(count);
                let keep = Collisions { frame, extinction, photons: Vec::new() };
                let mut path = Path::new(medium, extinction, settings, keep);
                for index in share * SHARE..end {
                    if let Some(photon) = &emission.photon(before + index) {
                        path.follow(photon);
                    }
                }
                advanced(end - share * SHARE);
                (path.keep.photons, path.balance)
            })
            .collect();
        for (photons, balance) in parts {
            traced.balance.add(&balance);
            if traced.photons.len() + photons.len() > settings.max_stored {
                traced.overflow = true;
                return traced;
            }
            traced.photons.extend_from_slice(&photons);
        }
    }
    traced
}

/// Traces single photons: what each leaves behind, path by path. A photon that is not sent leaves nothing.
pub fn trace_paths<E: Extinction>(
    emitted: impl Iterator<Item = Option<EmittedPhoton>>,
    medium: &Medium,
    extinction: &E,
    frame: MapFrame,
    settings: TraceSettings,
) -> Vec<Vec<Photon>> {
    let keep = Collisions { frame, extinction, photons: Vec::new() };
    let mut path = Path::new(medium, extinction, settings, keep);
    let trace = |photon: Option<EmittedPhoton>| {
        photon.iter().for_each(|photon| path.follow(photon));
        std::mem::take(&mut path.keep.photons)
    };
    emitted.map(trace).collect()
}

/// Traces the photons that `emission` looks at into `keeps`, in parallel: keep i of n takes rays i, i + n, i + 2 n and so on with all
/// photons of each, so that what each of them sees is a thinner version of the whole. The balance is that of all photons.
pub fn trace_into<E: Extinction, K: Keep>(
    emission: &Emission,
    medium: &Medium,
    extinction: &E,
    settings: TraceSettings,
    keeps: Vec<K>,
    advanced: impl Fn(u64) + Sync,
) -> (Vec<K>, PowerBalance) {
    let step = keeps.len().max(1);
    let per_ray = emission.photons_per_ray();
    let rays = emission.rays();
    let traced: Vec<(K, PowerBalance)> = keeps
        .into_par_iter()
        .enumerate()
        .map(|(first, keep)| {
            let mut path = Path::new(medium, extinction, settings, keep);
            let mut unreported = 0;
            for number in (rays.start + first as u64..rays.end).step_by(step) {
                if per_ray == 1 {
                    emission.photon(number).iter().for_each(|photon| path.follow(photon));
                } else if let Some(ray) = emission.ray(number) {
                    (number * per_ray..(number + 1) * per_ray)
                        .for_each(|index| path.follow(&emission.photon_of(&ray, index)));
                }
                unreported += per_ray;
                if unreported >= SHARE {
                    advanced(unreported);
                    unreported = 0;
                }
            }
            advanced(unreported);
            (path.keep, path.balance)
        })
        .collect();
    let mut balance = PowerBalance::default();
    traced.iter().for_each(|(_, of_keep)| balance.add(of_keep));
    (traced.into_iter().map(|(keep, _)| keep).collect(), balance)
}

/// Keeps the collisions, for a photon map.
struct Collisions<'a, E> {
    frame: MapFrame,
    extinction: &'a E,
    photons: Vec<Photon>,
}

impl<E: Extinction> Keep for Collisions<'_, E> {
    const FLIGHTS: bool = false;

    fn flight(&mut self, _: &Ray, _: Span, _: Rgb, _: u32) {}

    fn collision(&mut self, ray: &Ray, power: Rgb, order: u32) {
        let sigma_t =
            if E::IS_UNIFORM { 0.0 } else { self.extinction.sigma_t(ray.origin).max_element() };
        self.photons.push(Photon {
            position: self.frame.to_map(ray.origin),
            direction: ray.direction.as_vec3().to_array(),
            power: power.as_vec3().to_array(),
            sigma_t: sigma_t as f32,
            order,
        });
    }
}
