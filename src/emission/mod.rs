//! Emission: from lights, and from a medium that glows, to photons on their way into the medium.
//!
//! Photon i of n belongs to a light, or to the medium, in proportion to the power that each sends into the bounds. Its
//! *primary sample* (place, direction, quantile of the first free flight) is drawn independently, one a
//! stratum, or from an Owen-scrambled Sobol sequence; everything depends on (seed, i) alone. A [`Guide`] sends
//! photons where they collide, and the first collision is made likelier than it is, at the price of
//! the photon's power: with opacity o = 1 - T on its way it collides with probability p = min(1, o / mean o) and
//! the power share o / p.

pub mod aim;
mod cone_table;
mod emitter;
mod guide;
mod sobol;
mod strata;

pub use emitter::Emitter;
pub use guide::Guide;
pub use sobol::Sobol;
pub use strata::{Interval, MAX_DIMENSIONS, Strata};

use std::ops::Range;

use crate::light::{Light, LightChoice};
use crate::math::{DVec2, Random, Ray, Rgb, Stream, uniform};
use crate::medium::{BoostedQuantile, Medium};

/// How photons are sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmissionKind {
    /// Independent random numbers.
    Random,
    /// One photon a stratum of direction or position and first free flight together.
    Stratified,
    /// Owen-scrambled Sobol points.
    Sobol,
}

/// Which photons to emit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EmissionSettings {
    /// How they are sampled.
    pub kind: EmissionKind,
    /// How many, rounded up to whole rays.
    pub count: u64,
    /// Photons at a time that leave along one ray, in strata of their first flight: at least 1.
    pub photons_per_ray: u64,
    /// Seed of all of them.
    pub seed: u64,
}

/// A photon that has left its light.
#[derive(Clone, Debug)]
pub struct EmittedPhoton {
    /// From the light, or, for light from infinitely far, from before the medium.
    pub ray: Ray,
    /// \[W\], already divided by the number of photons.
    pub power: Rgb,
    /// Quantile of the first free flight, and how much likelier its collision is made.
    pub first_flight: BoostedQuantile,
    /// The stream of the photon's further path.
    pub random: Random,
    /// Number of the ray, where photons share one: then they have the same.
    pub ray_number: Option<u64>,
    /// Whether the medium itself emitted it: then its first collision, too, is known from photons alone.
    pub is_from_medium: bool,
}

/// A ray along which photons leave.
#[derive(Clone, Copy, Debug)]
pub struct EmittedRay {
    ray: Ray,
    /// Of each photon \[W\].
    power: Rgb,
    /// How much likelier first collisions are made.
    boost: f64,
    number: u64,
    is_from_medium: bool,
}

/// All photons of one pass.
#[derive(Debug)]
pub struct Emission<'a> {
    seed: u64,
    count: u64,
    photons_per_ray: u64,
    lights: Vec<LightShare<'a>>,
    choice: LightChoice,
}

/// The rays of one light: `first..first + count`.
#[derive(Debug)]
struct LightShare<'a> {
    emitter: Emitter<'a>,
    /// Whose they are.
    source: LightChoice,
    first: u64,
    count: u64,
    sampler: PrimarySampler,
    guide: Option<Guide>,
    collision_boost: f64,
}

/// Where primary samples come from.
#[derive(Debug)]
enum PrimarySampler {
    Random,
    Stratified(Strata),
    Sobol(Sobol),
}

impl<'a> Emission<'a> {
    /// Prepares `count` photons from the lights into the medium, and from the medium itself if it has light of its own.
    /// `opacity` is that of a ray through the medium; it and `mean_free_path` \[m\], a typical one, shape where photons go, nothing else.
    pub fn new(
        lights: &'a [Light],
        medium: &'a Medium,
        opacity: impl Fn(&Ray) -> f64,
        mean_free_path: f64,
        kind: EmissionKind,
        count: u64,
        seed: u64,
    ) -> Self {
        let settings = EmissionSettings { kind, count, photons_per_ray: 1, seed };
        Self::with_settings(lights, medium, opacity, mean_free_path, settings)
    }

    /// The same with rays that photons may share: what is known of the way through the medium serves them all.
    pub fn with_settings(
        lights: &'a [Light],
        medium: &'a Medium,
        opacity: impl Fn(&Ray) -> f64,
        mean_free_path: f64,
        settings: EmissionSettings,
    ) -> Self {
        let EmissionSettings { kind, count, photons_per_ray, seed } = settings;
        let of_light = |(index, light): (usize, &'a Light)| {
            (LightChoice::Light(index), Emitter::new(light, &medium.bounds))
        };
        let of_medium = Emitter::of_medium(medium).map(|emitter| (LightChoice::Medium, emitter));
        let emitters: Vec<(LightChoice, Emitter)> = lights
            .iter()
            .enumerate()
            .map(of_light)
            .chain(of_medium)
            .filter(|(_, emitter)| emitter.power_estimate() > 0.0)
            .collect();
        let powers: Vec<f64> = emitters.iter().map(|(_, e)| e.power_estimate()).collect();
        let rays = count.div_ceil(photons_per_ray);
        let mut first = 0;
        let mut lights = Vec::new();
        for (index, ((source, emitter), count)) in
            emitters.into_iter().zip(share_out(rays, &powers)).enumerate()
        {
            let sampler = match kind {
                EmissionKind::Random => PrimarySampler::Random,
                EmissionKind::Stratified => {
                    let extents = emitter.extents(mean_free_path);
                    // Photons of one ray are strata of its flight; of a medium's dimensions the flight is one too many.
                    let shared = usize::from(photons_per_ray > 1);
                    let dimensions = (extents.len() - shared).min(MAX_DIMENSIONS);
                    let extents = &extents[..dimensions];
                    PrimarySampler::Stratified(Strata::new(count, extents))
                }
                EmissionKind::Sobol => PrimarySampler::Sobol(Sobol::new(seed, index as u64)),
            };
            let (guide, collision_boost) = guide_of(&emitter, &opacity, index as u64);
            lights.push(LightShare {
                emitter,
                source,
                first,
                count,
                sampler,
                guide,
                collision_boost,
            });
            first += count;
        }
        let (count, choice) = (first * photons_per_ray, LightChoice::All);
        Self { seed, count, photons_per_ray, lights, choice }
    }

    /// Makes the photons those of another seed, everything else the same.
    pub fn reseed(&mut self, seed: u64) {
        self.seed = seed;
        for (index, light) in self.lights.iter_mut().enumerate() {
            if let PrimarySampler::Sobol(sobol) = &mut light.sampler {
                *sobol = Sobol::new(seed, index as u64);
            }
        }
    }

    /// Looks at the photons of some light alone, which stay what they are among all.
    pub fn choose(&mut self, choice: LightChoice) {
        self.choice = choice;
    }

    /// The rays of the light looked at, by number: all of them at first. Of a ray's photons, `photons_per_ray` each, the first has the
    /// ray's number times that.
    pub fn rays(&self) -> Range<u64> {
        if self.choice == LightChoice::All {
            return 0..self.count / self.photons_per_ray;
        }
        let light = self.lights.iter().find(|light| light.source == self.choice);
        light.map_or(0..0, |light| light.first..light.first + light.count)
    }

    /// Photons of the light looked at.
    pub fn chosen_count(&self) -> u64 {
        let rays = self.rays();
        (rays.end - rays.start) * self.photons_per_ray
    }

    /// Photons of the pass: the count asked for, or 0 where no light reaches the bounds.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Photons that leave along one ray.
    pub fn photons_per_ray(&self) -> u64 {
        self.photons_per_ray
    }

    /// Photon `index`, below [`Emission::count`]. `None` where the light sends nothing along the sample,
    /// as outside a spot's cone: the photon counts as emitted with no power.
    pub fn photon(&self, index: u64) -> Option<EmittedPhoton> {
        self.redrawn(index, self.seed)
    }

    /// Photon `index` with the random numbers of another seed: from the same stratum, and otherwise independent. The
    /// points of a Sobol sequence stay where they are.
    pub fn redrawn(&self, index: u64, seed: u64) -> Option<EmittedPhoton> {
        if self.photons_per_ray > 1 {
            let ray = self.redrawn_ray(index / self.photons_per_ray, seed)?;
            return Some(self.photon_along(&ray, index, seed));
        }
        let mut random = Stream::Photon.random(seed, index);
        let light = self.light_of(index)?;
        let sample = light.sampler.sample(index - light.first, &mut random);
        // The dimensions that lead to the ray come first, then the flight.
        let quantile = sample.get(light.emitter.dimensions()).copied();
        let u = quantile.unwrap_or_else(|| uniform(&mut random));
        let EmittedRay { ray, power, boost, is_from_medium, .. } =
            light.ray(index, sample, self.photons_per_ray)?;
        let first_flight = BoostedQuantile { u, boost };
        Some(EmittedPhoton { ray, power, first_flight, random, ray_number: None, is_from_medium })
    }

    /// The ray that photons `number` times [`Emission::photons_per_ray`] and on share, where they are several; `None` as of
    /// [`Emission::photon`].
    pub fn ray(&self, number: u64) -> Option<EmittedRay> {
        self.redrawn_ray(number, self.seed)
    }

    fn redrawn_ray(&self, number: u64, seed: u64) -> Option<EmittedRay> {
        let light = self.light_of(number)?;
        let mut random = Stream::Ray.random(seed, number);
        let sample = light.sampler.sample(number - light.first, &mut random);
        light.ray(number, sample, self.photons_per_ray)
    }

    /// Photon `index`, one of those of `ray`.
    pub fn photon_of(&self, ray: &EmittedRay, index: u64) -> EmittedPhoton {
        self.photon_along(ray, index, self.seed)
    }

    fn photon_along(&self, ray: &EmittedRay, index: u64, seed: u64) -> EmittedPhoton {
        let mut random = Stream::Photon.random(seed, index);
        let stratum = (index % self.photons_per_ray) as f64 + uniform(&mut random);
        let u = stratum / self.photons_per_ray as f64;
        let first_flight = BoostedQuantile { u, boost: ray.boost };
        let &EmittedRay { ray, power, number, is_from_medium, .. } = ray;
        let ray_number = Some(number);
        EmittedPhoton { ray, power, first_flight, random, ray_number, is_from_medium }
    }

    /// The light that sends a ray.
    fn light_of(&self, number: u64) -> Option<&LightShare<'a>> {
        self.lights.iter().rev().find(|light| light.first <= number)
    }
}

impl LightShare<'_> {
    /// The ray of a sample, for photons each of which carries its part of the light's power.
    fn ray(
        &self,
        number: u64,
        sample: [f64; MAX_DIMENSIONS],
        photons_per_ray: u64,
    ) -> Option<EmittedRay> {
        let [a, b, c, d, e] = sample;
        let (place, density) = match &self.guide {
            Some(guide) => guide.warp(DVec2::new(a, b)),
            None => (DVec2::new(a, b), 1.0),
        };
        let (ray, power) = self.emitter.sample_ray([place.x, place.y, c, d, e])?;
        let power = power / ((self.count * photons_per_ray) as f64 * density);
        let boost = (self.collision_boost / density).max(1.0);
        Some(EmittedRay { ray, power, boost, number, is_from_medium: self.emitter.is_medium() })
    }
}

/// The guide of a light, where its rays have two dimensions, and how likely its first collisions are to be made.
fn guide_of(emitter: &Emitter, opacity: &impl Fn(&Ray) -> f64, index: u64) -> (Option<Guide>, f64) {
    let mut random = Stream::Guide.random(0, index);
    let mut inner = random.clone();
    if emitter.dimensions() == 2 {
        let of_place = |p: DVec2| {
            emitter.sample_ray([p.x, p.y, 0.5, 0.5, 0.5]).map_or(0.0, |(ray, _)| opacity(&ray))
        };
        return match Guide::new(&mut random, of_place) {
            Some((guide, mean)) => (Some(guide), 1.0 / mean),
            None => (None, 1.0),
        };
    }
    let probes = 1024;
    let sum: f64 = (0..probes)
        .filter_map(|_| emitter.sample_ray(std::array::from_fn(|_| uniform(&mut inner))))
        .map(|(ray, _)| opacity(&ray))
        .sum();
    (None, if sum > 0.0 { f64::from(probes) / sum } else { 1.0 })
}

impl PrimarySampler {
    /// A point of the unit cube.
    fn sample(&self, index: u64, random: &mut Random) -> [f64; MAX_DIMENSIONS] {
        match self {
            Self::Random => std::array::from_fn(|_| uniform(random)),
            Self::Stratified(strata) => strata.cell(index).map(|i| i.at(uniform(random))),
            Self::Sobol(sobol) => std::array::from_fn(|dimension| {
                let bits = f64::from(sobol.coordinate(index as u32, dimension));
                ((bits + uniform(random)) / 4_294_967_296.0).min(1.0 - f64::EPSILON / 2.0)
            }),
        }
    }
}

/// Divides `count` in proportion to positive `weights`, none left without one if there are enough.
fn share_out(count: u64, weights: &[f64]) -> Vec<u64> {
    let total: f64 = weights.iter().sum();
    let (mut sum, mut given) = (0.0, 0);
    let mut shares: Vec<u64> = weights
        .iter()
        .map(|weight| {
            sum += weight / total;
            let end = ((sum * count as f64).round() as u64).min(count).max(given);
            let share = end - given;
            given = end;
            share
        })
        .collect();
    while let (Some(poor), Some(rich)) = (
        shares.iter().position(|&share| share == 0),
        (0..shares.len()).max_by_key(|&i| shares[i]).filter(|&i| shares[i] > 1),
    ) {
        shares[poor] += 1;
        shares[rich] -= 1;
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;

    #[test]
    fn photons_are_shared_by_power_and_none_is_lost() {
        assert_eq!(share_out(10, &[1.0, 4.0]), [2, 8]);
        assert_eq!(share_out(10, &[1e-9, 1.0, 1.0]), [1, 5, 4]);
        assert_eq!(share_out(2, &[1.0, 1.0, 1.0]).iter().sum::<u64>(), 2);
        assert_eq!(share_out(1_000_003, &[0.3, 0.3, 0.4]).iter().sum::<u64>(), 1_000_003);
    }

    /// First flights fill equal intervals far more evenly than chance would: they are a dimension of the strata and of
    /// the Sobol sequence, whatever the dimensions of the light.
    #[test]
    fn first_flights_are_stratified() {
        use crate::light::{Environment, PointLight};
        use crate::medium::{Bounds, MediumExtinction, Phase, UniformExtinction};
        let medium = Medium {
            bounds: Bounds::Sphere { center: DVec3::ZERO, radius: 1.0 },
            extinction: MediumExtinction::Uniform(UniformExtinction { sigma_t: 1.0 }),
            albedo: Rgb::ONE,
            color: None,
            phase: Phase::Isotropic,
            emissivity: None,
        };
        let point =
            Light::Point(PointLight { position: DVec3::new(0.1, 0.0, 0.0), intensity: Rgb::ONE });
        let sky = Light::Environment(Environment::Constant(Rgb::ONE));
        // Bins: about as many as strata along the flight, 4096^(1/3) and 4096^(1/5).
        for (light, bins) in [([point], 16), ([sky], 5)] {
            for (kind, range) in [
                (EmissionKind::Random, 0.05..5.0),
                (EmissionKind::Stratified, 0.0..0.4),
                (EmissionKind::Sobol, 0.0..0.02),
            ] {
                let emission = Emission::new(&light, &medium, |_| 0.5, 1.0, kind, 4096, 3);
                let mut counts = vec![0.0; bins];
                for index in 0..4096 {
                    let photon = emission.photon(index).expect("a photon");
                    counts[(photon.first_flight.u * bins as f64) as usize] += 1.0;
                }
                // Independent counts have a mean of chi^2 / bins of about 1.
                let expected = 4096.0 / bins as f64;
                let squares = counts.iter().map(|c: &f64| (c - expected).powi(2) / expected);
                let chi = squares.sum::<f64>() / bins as f64;
                assert!(range.contains(&chi), "{kind:?}, {bins} bins: {chi}");
            }
        }
    }
}
