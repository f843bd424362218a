//! Estimates from the photon map: power density, fluence and in-scattered radiance, from the k nearest photons.
//!
//! With r_k the distance of the k-th photon and V the part of that ball inside the medium, the estimate of power
//! density is the photons' power, the k-th counted as the [`Divisor`] says, over V (Jensen and Christensen
//! 1998; the numerators k, k - 1 and k - 1/2 are the thesis's chapters 3 and 4; [`CountLaw`] finds the one without bias).
//!
//! Fluence divides each photon by sigma_t at its own place. In a grid sigma_t may vanish within the ball, where
//! no photon can be; photons are therefore weighted by h(sigma_t) / sigma_t with h = min(sigma_t, c), and V
//! becomes the integral of h over the ball: every h gives the same mean in a constant fluence, and this one
//! bounds the weights. c is sigma_t at the query. Where the ball is not filled evenly, photons are weighted besides so
//! that a linear fluence is read exactly ([`BallMoments`](crate::medium::BallMoments)); power density is the plain estimate.

mod count_law;
mod divisor;
mod kernel;

pub use count_law::CountLaw;
pub use divisor::Divisor;
pub use kernel::Kernel;

use std::num::NonZeroUsize;

use divisor::Shares;

use crate::map::{Columns, Nearest, NearestPhotons, PhotonMap};
use crate::math::{Ball, DVec3, Rgb};
use crate::medium::{Extinction, ISOTROPIC, Medium, Scattering};

/// How the map is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimateOptions {
    /// Photons of one estimate.
    pub k: NonZeroUsize,
    /// What k equal photons count as, from [`Divisor::constant`] or [`CountLaw::constant`]: what is less than k is taken off
    /// the k-th photon, and what is less than k - 1 off the others.
    pub constant: f64,
    /// Weight by distance.
    pub kernel: Kernel,
    /// Largest radius \[m\]. Where fewer than k photons are within, all of them count, over that ball.
    pub max_radius: f64,
}

/// An estimate at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The quantity estimated, per channel.
    pub value: Rgb,
    /// Radius of the kernel \[m\].
    pub radius: f64,
    /// Photons found.
    pub photon_count: usize,
}

/// An estimate of the light scattered towards a direction, per sigma_s \[W/(m^2 sr)\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InScattered {
    /// From photons that had not scattered before, where the map keeps orders; else 0.
    pub single: Rgb,
    /// From all others.
    pub multiple: Rgb,
    /// Radius of the kernel \[m\].
    pub radius: f64,
    /// Photons found.
    pub photon_count: usize,
}

/// Reads a photon map, from one thread.
pub struct Estimator<'a, E> {
    medium: &'a Medium,
    extinction: &'a E,
    finder: NearestPhotons<'a>,
    options: EstimateOptions,
}

impl<'a, E: Extinction> Estimator<'a, E> {
    /// A reader of `map`, whose photons were traced in `medium` with that `extinction`.
    pub fn new(
        medium: &'a Medium,
        extinction: &'a E,
        map: &'a PhotonMap,
        options: EstimateOptions,
    ) -> Self {
        Self { medium, extinction, finder: NearestPhotons::new(map), options }
    }

    /// Power density at a place \[W/m^3\].
    pub fn power_density(&mut self, place: DVec3) -> Estimate {
        let Self { medium, finder, options, .. } = self;
        let map = finder.map();
        let nearest = finder.find(place, options.k, options.max_radius);
        let radius = f64::from(nearest.radius) * map.frame().unit;
        let volume = options.kernel.mass(medium.bounds.overlap(Ball { center: place, radius }));
        let sum = match options.kernel {
            Kernel::Constant => equally_weighted(map, &nearest, *options),
            Kernel::Epanechnikov => {
                let mut sum = Rgb::ZERO;
                let add = |photon, weight| sum += rgb(map.power(photon)) * weight;
                for_weighted(&nearest, *options, add);
                sum
            }
        };
        Estimate { value: over(sum, volume), radius, photon_count: nearest.photons.len() }
    }

    /// Fluence at a place \[W/m^2\].
    pub fn fluence(&mut self, place: DVec3) -> Estimate {
        let gathered = self.gather_fluence(place, 0.5, |_, power, weight| power * weight);
        let value = gathered.single + gathered.multiple;
        Estimate { value, radius: gathered.radius, photon_count: gathered.photon_count }
    }

    /// Light scattered at a place into a direction of travel, per sigma_s: the phase-weighted fluence \[W/(m^2 sr)\].
    /// `turn` in \[0, 1) turns the quadrature of the ball.
    pub fn in_scattered(&mut self, place: DVec3, direction: DVec3, turn: f64) -> InScattered {
        let scattering = self.extinction.scattering_at(self.medium, place);
        let map = self.finder.map();
        self.gather_fluence(place, turn, |photon, power, weight| match map.direction(photon) {
            Some(incoming) => scattering.scatter(power, weight, incoming.dot(direction)),
            None => power * (weight * ISOTROPIC),
        })
    }

    /// Sums what is `seen` of each photon's power times its weight in the fluence over those about a place. It is in proportion to
    /// the power, and the same for all photons but for what the map keeps of each.
    fn gather_fluence(
        &mut self,
        place: DVec3,
        turn: f64,
        seen: impl Fn(u32, Rgb, f64) -> Rgb,
    ) -> InScattered {
        let Self { medium, extinction, finder, options } = self;
        let map = finder.map();
        let nearest = finder.find(place, options.k, options.max_radius);
        let radius = f64::from(nearest.radius) * map.frame().unit;
        let mut gathered =
            InScattered { radius, photon_count: nearest.photons.len(), ..InScattered::default() };
        if nearest.photons.is_empty() {
            return gathered;
        }
        let sigma_t = extinction.sigma_t(place);
        let ceiling =
            if E::IS_UNIFORM { sigma_t } else { Rgb::splat(ceiling(map, &nearest, sigma_t)) };
        let ball = Ball { center: place, radius };
        let falloff = options.kernel.falloff();
        let moments = extinction.ball_moments(&medium.bounds, ball, ceiling.x, turn, falloff);
        let per_fluence = |sum: Rgb| {
            let channel = |c: usize| over_scalar(sum[c], moments.mass * ceiling[c]);
            Rgb::new(channel(0), channel(1), channel(2))
        };
        let Columns { direction, sigma_t, order } = map.columns();
        let is_even = options.kernel == Kernel::Constant && moments.tilt == DVec3::ZERO;
        if is_even && !sigma_t && !order {
            gathered.multiple = per_fluence(if direction {
                let light = |photon| seen(photon, rgb(map.power(photon)), 1.0);
                let sum = |inner: &[u32]| inner.iter().map(|&photon| light(photon)).sum();
                shared(&nearest, *options, sum, light)
            } else {
                // Photons are seen by their power alone.
                seen(nearest.photons[0], equally_weighted(map, &nearest, *options), 1.0)
            });
            return gathered;
        }
        let to_offset = 1.0 / f64::from(nearest.radius);
        for_weighted(&nearest, *options, |photon, weight| {
            let clipped = match map.sigma_t(photon) {
                Some(own) => weight * (ceiling.x / f64::from(own)).min(1.0),
                None => weight,
            };
            let clipped = match moments.tilt {
                DVec3::ZERO => clipped,
                _ => {
                    let offset = map.offset(photon, nearest.query).as_dvec3() * to_offset;
                    clipped * moments.linear_weight(offset)
                }
            };
            let light = seen(photon, rgb(map.power(photon)), clipped);
            match map.order(photon) {
                Some(0) => gathered.single += light,
                _ => gathered.multiple += light,
            }
        });
        gathered.single = per_fluence(gathered.single);
        gathered.multiple = per_fluence(gathered.multiple);
        gathered
    }
}

/// Where h levels off: sigma_t at the query, or, where there is none, the largest of the photons'.
fn ceiling(map: &PhotonMap, nearest: &Nearest, sigma_t: Rgb) -> f64 {
    if sigma_t.x > 0.0 {
        return sigma_t.x;
    }
    let own = nearest.photons.iter().filter_map(|&photon| map.sigma_t(photon));
    own.fold(0.0, |largest, s| f64::from(s).max(largest))
}

/// The power of the photons, where the kernel weighs them all alike.
#[inline]
fn equally_weighted(map: &PhotonMap, nearest: &Nearest, options: EstimateOptions) -> Rgb {
    let last = |photon| rgb(map.power(photon));
    shared(nearest, options, |inner| map.total_power(inner), last)
}

/// What the divisor leaves of the `sum` over all photons but the last, and of the last one.
#[inline]
fn shared(
    nearest: &Nearest,
    options: EstimateOptions,
    sum: impl Fn(&[u32]) -> Rgb,
    last: impl Fn(u32) -> Rgb,
) -> Rgb {
    let Some((&farthest, inner)) = nearest.photons.split_last() else { return Rgb::ZERO };
    let shares =
        if nearest.complete { Shares::of(options.constant, options.k) } else { Shares::FULL };
    sum(inner) * shares.inner + last(farthest) * shares.last
}

/// Calls `add` with each photon and its weight: the kernel's, times what the divisor leaves of it.
#[inline]
fn for_weighted(nearest: &Nearest, options: EstimateOptions, mut add: impl FnMut(u32, f64)) {
    let inverse = 1.0 / (f64::from(nearest.radius) * f64::from(nearest.radius));
    let mut inner = nearest.iter();
    let Some((last, square)) = inner.next_back() else { return };
    let kernel = options.kernel;
    let shares =
        if nearest.complete { Shares::of(options.constant, options.k) } else { Shares::FULL };
    for (photon, square) in inner {
        let weight = kernel.weight(f64::from(square) * inverse);
        add(photon, weight * shares.inner);
    }
    if shares.last > 0.0 {
        let weight = kernel.weight(f64::from(square) * inverse);
        add(last, weight * shares.last);
    }
}

fn rgb(power: [f32; 3]) -> Rgb {
    Rgb::new(f64::from(power[0]), f64::from(power[1]), f64::from(power[2]))
}

/// `sum / mass`, 0 where there is no mass.
fn over(sum: Rgb, mass: f64) -> Rgb {
    if mass > 0.0 { sum / mass } else { Rgb::ZERO }
}

fn over_scalar(sum: f64, mass: f64) -> f64 {
    if mass > 0.0 { sum / mass } else { 0.0 }
}
