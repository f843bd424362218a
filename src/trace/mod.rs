//! Tracing: from emitted photons to photons stored at collisions.
//!
//! A photon flies until it collides: its first flight is exactly inverted, so that strata hold; later ones are
//! analytic in uniform media and delta tracking in grids. At a collision it is stored with its power before the albedo,
//! and scatters. It survives with the probability that its power keeps, so that photons stay equally strong and the
//! mean is exact. Photons are traced in fixed shares that are merged in order: the result does not depend on the
//! number of threads.

mod balance;
mod frame;
mod photon;

pub use balance::PowerBalance;
pub use frame::MapFrame;
pub use photon::Photon;

use rayon::prelude::*;

use crate::emission::{Emission, EmittedPhoton};
use crate::math::{Ray, Rgb, max_channel, uniform};
use crate::medium::{Extinction, Flight, Medium, RayProfile};

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

/// Traces all photons of `emission`. `advanced` is told of photons done, from any thread; `cancelled` ends early.
pub fn trace_photons<E: Extinction>(
    emission: &Emission,
    medium: &Medium,
    extinction: &E,
    frame: MapFrame,
    settings: TraceSettings,
    advanced: impl Fn(u64) + Sync,
) -> TracedPhotons {
    let count = emission.count();
    let shares = count.div_ceil(SHARE);
    // A batch of shares at a time bounds what is held twice while merging.
    let batch = 64 * rayon::current_num_threads() as u64;
    let mut traced = TracedPhotons { emitted_count: count, ..TracedPhotons::default() };
    for first in (0..shares).step_by(batch as usize) {
        let parts: Vec<Path<E>> = (first..(first + batch).min(shares))
            .into_par_iter()
            .map(|share| {
                let end = ((share + 1) * SHARE).min(count);
                let mut path = Path::new(medium, extinction, frame, settings);
                for index in share * SHARE..end {
                    if let Some(photon) = emission.photon(index) {
                        path.follow(photon);
                    }
                }
                advanced(end - share * SHARE);
                path
            })
            .collect();
        for part in parts {
            traced.balance.add(&part.balance);
            if traced.photons.len() + part.photons.len() > settings.max_stored {
                traced.overflow = true;
                return traced;
            }
            traced.photons.extend_from_slice(&part.photons);
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
    let mut path = Path::new(medium, extinction, frame, settings);
    let trace = |photon: Option<EmittedPhoton>| {
        photon.into_iter().for_each(|photon| path.follow(photon));
        std::mem::take(&mut path.photons)
    };
    emitted.map(trace).collect()
}

/// The paths of one share of the photons.
struct Path<'a, E> {
    medium: &'a Medium,
    extinction: &'a E,
    frame: MapFrame,
    settings: TraceSettings,
    photons: Vec<Photon>,
    balance: PowerBalance,
    profile: RayProfile,
}

impl<'a, E: Extinction> Path<'a, E> {
    fn new(
        medium: &'a Medium,
        extinction: &'a E,
        frame: MapFrame,
        settings: TraceSettings,
    ) -> Self {
        let (photons, balance) = (Vec::new(), PowerBalance::default());
        let profile = RayProfile::default();
        Self { medium, extinction, frame, settings, photons, balance, profile }
    }

    /// Follows one photon from its light to its end.
    fn follow(&mut self, photon: EmittedPhoton) {
        let EmittedPhoton { mut ray, mut power, first_flight, mut random, is_from_medium } = photon;
        let min_stored_order = if is_from_medium { 0 } else { self.settings.min_stored_order };
        self.balance.emitted += power;
        for order in 0.. {
            let Some(span) = self.medium.bounds.intersect(&ray) else { break };
            let flight = if order == 0 {
                let profile = &mut self.profile;
                let boosted =
                    self.extinction.boosted_flight(&ray, span, power, first_flight, profile);
                let passing = power * (1.0 - boosted.share);
                let escaped = self.reweigh(passing, boosted.escape_weight);
                self.balance.escaped += escaped;
                power *= boosted.share;
                boosted.flight
            } else {
                self.extinction.sample_flight(&ray, span, power, &mut random)
            };
            let distance = match flight {
                Flight::Escape { weight } => {
                    power = self.reweigh(power, weight);
                    break;
                }
                Flight::Collision { distance, weight } => {
                    power = self.reweigh(power, weight);
                    distance
                }
            };
            ray.origin = ray.at(distance);
            if order >= min_stored_order {
                self.store(&ray, power, order);
            }
            if order >= self.settings.max_order {
                self.balance.truncated += power;
                return;
            }
            let scattered = power * self.medium.albedo_at(ray.origin);
            let survival = (max_channel(scattered) / max_channel(power)).min(1.0);
            if survival < 1.0 && uniform(&mut random) >= survival {
                self.balance.absorbed += power;
                return;
            }
            let survivor = scattered / survival;
            self.balance.absorbed += power - survivor;
            power = survivor;
            ray.direction = self.medium.phase.sample_direction(ray.direction, &mut random);
        }
        self.balance.escaped += power;
    }

    /// Applies the weight of a flight, which is 1 but in chromatic media.
    fn reweigh(&mut self, power: Rgb, weight: Rgb) -> Rgb {
        let weighted = power * weight;
        self.balance.resampled += power - weighted;
        weighted
    }

    /// Stores the collision at the ray's origin.
    fn store(&mut self, ray: &Ray, power: Rgb, order: u32) {
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
