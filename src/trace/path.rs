//! One photon's path, and what is kept of it.

use crate::emission::EmittedPhoton;
use crate::math::{Ray, Rgb, Span, max_channel, uniform};
use crate::medium::{Extinction, Flight, Medium, RayProfile};
use crate::trace::{PowerBalance, TraceSettings};

/// What is kept of photons' paths: collisions for a photon map, flights for a lattice.
pub trait Keep: Send {
    /// Whether [`Keep::flight`] is of use.
    const FLIGHTS: bool;

    /// A photon of `power` \[W\] has flown over `flight`, distances of `ray` from where it scattered `order` times.
    fn flight(&mut self, ray: &Ray, flight: Span, power: Rgb, order: u32);

    /// A photon of `power` \[W\] that has scattered `order` times collides at the ray's origin.
    fn collision(&mut self, ray: &Ray, power: Rgb, order: u32);
}

/// Follows photons, one after the other.
pub(super) struct Path<'a, E, K> {
    medium: &'a Medium,
    extinction: &'a E,
    settings: TraceSettings,
    /// What was kept so far.
    pub keep: K,
    /// Where the power went so far.
    pub balance: PowerBalance,
    /// That of the ray of this number.
    profile: RayProfile,
    profile_of: Option<u64>,
}

impl<'a, E: Extinction, K: Keep> Path<'a, E, K> {
    pub fn new(medium: &'a Medium, extinction: &'a E, settings: TraceSettings, keep: K) -> Self {
        let (balance, profile) = (PowerBalance::default(), RayProfile::default());
        Self { medium, extinction, settings, keep, balance, profile, profile_of: None }
    }

    /// Follows one photon from its light to its end.
    pub fn follow(&mut self, photon: &EmittedPhoton) {
        let EmittedPhoton { mut ray, mut power, first_flight, ref random, .. } = *photon;
        let mut random = random.clone();
        let is_from_medium = photon.is_from_medium;
        let min_kept_order = if is_from_medium { 0 } else { self.settings.min_stored_order };
        self.balance.emitted += power;
        for order in 0.. {
            let Some(span) = self.medium.bounds.intersect(&ray) else { break };
            let keeps_flight = K::FLIGHTS && order >= min_kept_order;
            // A first collision made likelier weighs right, its flight would not.
            let flight = if order == 0 && !keeps_flight {
                let number = photon.ray_number;
                let is_known = number.is_some() && self.profile_of == number;
                self.profile_of = number;
                let profile = &mut self.profile;
                let boosted = self.extinction.boosted_flight(
                    &ray,
                    span,
                    power,
                    first_flight,
                    profile,
                    is_known,
                );
                let passing = power * (1.0 - boosted.share);
                let escaped = self.reweigh(passing, boosted.escape_weight);
                self.balance.escaped += escaped;
                power *= boosted.share;
                boosted.flight
            } else {
                self.extinction.sample_flight(&ray, span, power, &mut random)
            };
            if keeps_flight {
                let end = match flight {
                    Flight::Escape { .. } => span.end,
                    Flight::Collision { distance, .. } => distance,
                };
                self.keep.flight(&ray, Span::new(span.start, end), power, order);
            }
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
            if order >= min_kept_order {
                self.keep.collision(&ray, power, order);
            }
            if order >= self.settings.max_order {
                self.balance.truncated += power;
                return;
            }
            let struck = self.extinction.struck(self.medium, ray.origin, &mut random);
            let scattered = power * struck.albedo_at(ray.origin);
            let survival = (max_channel(scattered) / max_channel(power)).min(1.0);
            if survival < 1.0 && uniform(&mut random) >= survival {
                self.balance.absorbed += power;
                return;
            }
            let survivor = scattered / survival;
            self.balance.absorbed += power - survivor;
            power = survivor;
            ray.direction = struck.phase.sample_direction(ray.direction, &mut random);
        }
        self.balance.escaped += power;
    }

    /// Applies the weight of a flight, which is 1 but in chromatic media.
    #[inline]
    fn reweigh(&mut self, power: Rgb, weight: Rgb) -> Rgb {
        if !E::IS_CHROMATIC {
            return power;
        }
        let weighted = power * weight;
        self.balance.resampled += power - weighted;
        weighted
    }
}
