//! One path: light that reaches a camera ray, over all orders of scattering.
//!
//! The ray flies to a collision by delta tracking (in closed form where the medium is uniform), scatters by the phase
//! function, and so on until it leaves the medium or roulette ends it, which looks at the throughput alone. Each segment and each collision adds what the
//! lights send there:
//!
//! * lights seen along the segment, weighed against having been sampled from its start;
//! * one place for each near light by equi-angular sampling, lit by that light;
//! * the collision, lit by every light;
//! * from the collision one ray aimed at each point light in the medium, with one place on it (see [`aim`](super::aim)).
//!
//! All weights are balance heuristics over these ways (see [`segment`](super::segment)): no light makes an infinite variance.

use crate::light::Light;
use crate::math::{DVec3, Random, Ray, Rgb, Span, max_channel, uniform};
use crate::medium::{Extinction, Flight, Medium};
use crate::scene::{Background, Scene};

use super::aim::Aim;
use super::equi_angular::EquiAngular;
use super::glow::glow;
use super::light_sample::{pdf_light, sample_light};
use super::segment::{Segment, peak_of};

/// Throughput below which a path survives with the probability of its share of this.
const ROULETTE_BELOW: f64 = 0.25;

/// Light found by one path, by its way through the medium \[W/(m^2 sr)\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathLight {
    /// Of lights, scattered once.
    pub single_scatter: Rgb,
    /// Scattered twice or more; of the medium's own light, all that is scattered.
    pub multiple_scatter: Rgb,
    /// From lights seen directly, and of the medium's own, attenuated.
    pub emission: Rgb,
    /// Transmittance of the ray's whole part in the medium.
    pub transmittance: Rgb,
}

impl PathLight {
    /// All light.
    pub fn radiance(&self) -> Rgb {
        self.single_scatter + self.multiple_scatter + self.emission
    }

    /// Adds light of lights that was scattered `order` times.
    fn add(&mut self, order: u64, light: Rgb) {
        match order {
            0 => self.emission += light,
            1 => self.single_scatter += light,
            _ => self.multiple_scatter += light,
        }
    }

    /// Adds light of the medium that was scattered `order` times.
    fn add_glow(&mut self, order: u64, light: Rgb) {
        self.add(if order == 0 { 0 } else { 2 }, light);
    }
}

/// Traces paths, from one thread.
pub(super) struct PathTracer<'a, E> {
    medium: &'a Medium,
    extinction: &'a E,
    lights: &'a [Light],
    has_environment: bool,
    background: Background,
    /// For each light, sampling of distances on the current segment.
    towards: Vec<Option<EquiAngular>>,
    /// For each light, the density of all ways that find the last collision over that of the flight.
    ways: Vec<f64>,
}

impl<'a, E: Extinction> PathTracer<'a, E> {
    pub(super) fn new(scene: &'a Scene, extinction: &'a E) -> Self {
        let lights = &scene.lights;
        Self {
            medium: &scene.medium,
            extinction,
            lights,
            has_environment: lights.iter().any(|light| matches!(light, Light::Environment(_))),
            background: scene.render.background,
            towards: vec![None; lights.len()],
            ways: vec![1.0; lights.len()],
        }
    }

    /// An estimate of the light that travels back along a ray.
    pub(super) fn light_along(&mut self, mut ray: Ray, random: &mut Random) -> PathLight {
        let mut seen = PathLight::default();
        let (mut throughput, mut phase_density) = (Rgb::ONE, None);
        for order in 0.. {
            let span = self.medium.bounds.intersect(&ray);
            let needs_whole = order == 0 || self.has_environment;
            let whole = match span {
                Some(span) if needs_whole => {
                    self.extinction.estimate_transmittance(&ray, span, random)
                }
                _ => Rgb::ONE,
            };
            if order == 0 {
                seen.transmittance = whole;
            }
            seen.add(order, throughput * self.lights_along(&ray, phase_density, whole, random));
            let Some(span) = span else { break };
            let (medium, extinction) = (self.medium, self.extinction);
            let segment = Segment { medium, extinction, ray, span, throughput, phase_density };
            seen.add(order + 1, throughput * self.near_lights(&segment, random));
            let flight = extinction.sample_flight(&ray, span, throughput, random);
            let (distance, weight) = match flight {
                Flight::Escape { .. } => (span.end, None),
                Flight::Collision { distance, weight } => (distance, Some(weight)),
            };
            seen.add_glow(order, throughput * glow(&segment, distance, random));
            let Some(weight) = weight else { break };

            let place = ray.at(distance);
            throughput *= weight * medium.albedo_at(place);
            if throughput == Rgb::ZERO {
                break;
            }
            seen.add(order + 1, throughput * self.lights_at(&segment, distance, random));
            let aimed = self.aimed_light(place, ray.direction, throughput, random);
            seen.add(order + 2, throughput * aimed);
            match roulette(throughput, random) {
                Some(survivor) => throughput = survivor,
                None => break,
            }
            let direction = medium.phase.sample_direction(ray.direction, random);
            phase_density = Some(medium.phase.density(direction.dot(ray.direction)));
            ray = Ray::new(place, direction);
        }
        seen
    }

    /// Lights that the ray meets, weighed against sampling them from its start. `whole` is the transmittance of the whole ray.
    fn lights_along(
        &self,
        ray: &Ray,
        phase_density: Option<f64>,
        whole: Rgb,
        random: &mut Random,
    ) -> Rgb {
        let mut sum = Rgb::ZERO;
        for (light, ways) in self.lights.iter().zip(&self.ways) {
            let Some((distance, radiance)) = light.seen_along(ray) else { continue };
            let is_background = phase_density.is_none() && distance.is_infinite();
            if is_background && self.background == Background::Holdout {
                continue;
            }
            if radiance == Rgb::ZERO {
                continue;
            }
            let weight = phase_density.map_or(1.0, |phase| {
                let sampled = pdf_light(light, ray.origin, ray.direction);
                if sampled > 0.0 { phase / (phase + ways * sampled) } else { 1.0 }
            });
            let transmittance = if distance.is_finite() {
                self.transmittance(ray.origin, ray.direction, distance, random)
            } else {
                whole
            };
            sum += radiance * transmittance * weight;
        }
        sum
    }

    /// Light of each near light, scattered at one place of the segment drawn towards it.
    fn near_lights(&mut self, segment: &Segment<E>, random: &mut Random) -> Rgb {
        let mut sum = Rgb::ZERO;
        for (index, light) in self.lights.iter().enumerate() {
            let towards = segment.equi_angular(light);
            if let Some(towards) = &towards {
                sum += self.near_light(segment, light, towards, random);
            }
            self.towards[index] = towards;
        }
        sum
    }

    fn near_light(
        &self,
        segment: &Segment<E>,
        light: &Light,
        towards: &EquiAngular,
        random: &mut Random,
    ) -> Rgb {
        let distance = towards.sample_distance(uniform(random));
        let place = segment.ray.at(distance);
        let sigma_t = self.extinction.sigma_t(place);
        let sigma_s = sigma_t * self.medium.albedo_at(place);
        if sigma_s == Rgb::ZERO {
            return Rgb::ZERO;
        }
        let flight = segment.flight_density(distance, sigma_t);
        let density = segment.density(light, Some(towards), distance, flight);
        let scattered =
            self.light_at(light, place, segment.ray.direction, [flight, density], random);
        if scattered == Rgb::ZERO {
            return Rgb::ZERO;
        }
        let passed = Span::new(segment.span.start, distance);
        sigma_s * scattered * self.extinction.estimate_transmittance(&segment.ray, passed, random)
    }

    /// Light of all lights, scattered at the collision that ends a segment.
    fn lights_at(&mut self, segment: &Segment<E>, distance: f64, random: &mut Random) -> Rgb {
        let place = segment.ray.at(distance);
        let flight = segment.flight_density(distance, self.extinction.sigma_t(place));
        let mut sum = Rgb::ZERO;
        for (index, light) in self.lights.iter().enumerate() {
            let ways = match &self.towards[index] {
                Some(towards) if flight > 0.0 => {
                    segment.density(light, Some(towards), distance, flight) / flight
                }
                _ => 1.0,
            };
            self.ways[index] = ways;
            sum += self.light_at(light, place, segment.ray.direction, [1.0, ways], random);
        }
        sum
    }

    /// Light of the point lights in the medium, scattered on rays aimed at them and then at `place`.
    fn aimed_light(
        &self,
        place: DVec3,
        direction: DVec3,
        throughput: Rgb,
        random: &mut Random,
    ) -> Rgb {
        let mut sum = Rgb::ZERO;
        let (medium, extinction) = (self.medium, self.extinction);
        for light in self.lights {
            let aim = peak_of(light, medium).and_then(|peak| Aim::new(place, peak));
            let Some(aim) = aim else { continue };
            let ray = Ray::new(place, aim.sample_direction(random));
            let Some(span) = medium.bounds.intersect(&ray) else { continue };
            let phase_density = Some(medium.phase.density(ray.direction.dot(direction)));
            let segment = Segment { medium, extinction, ray, span, throughput, phase_density };
            if let Some(towards) = segment.equi_angular(light) {
                sum += self.near_light(&segment, light, &towards, random);
            }
        }
        sum
    }

    /// Phase-weighted light from one direction towards a light, attenuated, over the density of all ways that find it: `density` is
    /// that of all ways that find the place, of which `flight` may go on to meet the light by itself.
    fn light_at(
        &self,
        light: &Light,
        place: DVec3,
        direction: DVec3,
        [flight, density]: [f64; 2],
        random: &mut Random,
    ) -> Rgb {
        let Some(sample) = sample_light(light, place, random) else { return Rgb::ZERO };
        // Against the light's travel, as the path goes: the phase function is the same both ways.
        let phase = self.medium.phase.density(sample.from.direction.dot(direction));
        let met = sample.pdf.map_or(0.0, |pdf| flight * phase / pdf);
        let weighted = sample.from.irradiance * (phase / (density + met));
        if weighted == Rgb::ZERO {
            return Rgb::ZERO;
        }
        weighted * self.transmittance(place, sample.from.direction, sample.from.distance, random)
    }

    fn transmittance(
        &self,
        place: DVec3,
        direction: DVec3,
        distance: f64,
        random: &mut Random,
    ) -> Rgb {
        let ray = Ray::new(place, direction);
        let inside = self.medium.bounds.intersect(&ray);
        let before = inside.and_then(|span| span.intersect(Span::new(0.0, distance)));
        before.map_or(Rgb::ONE, |span| self.extinction.estimate_transmittance(&ray, span, random))
    }
}

/// The throughput of a survivor.
fn roulette(throughput: Rgb, random: &mut Random) -> Option<Rgb> {
    let survival = max_channel(throughput) / ROULETTE_BELOW;
    if survival >= 1.0 {
        return Some(throughput);
    }
    (uniform(random) < survival).then(|| throughput / survival)
}
