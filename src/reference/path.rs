//! One path: light that reaches a camera ray, over all orders of scattering.
//!
//! The ray flies to a collision by delta tracking (in closed form where the medium is uniform), scatters by the phase
//! function, and so on until it leaves the medium or roulette ends it, which looks at the throughput alone. Each segment and each collision adds what the
//! lights send there:
//!
//! * lights seen along the segment, weighed against having been sampled from its start; a sky that is the same all around is not sampled,
//!   but found by the paths that leave;
//! * one place for each near light by equi-angular sampling, lit by that light;
//! * the collision, lit by every light;
//! * from the collision one ray aimed at each point light in the medium, with one place on it (see [`aim`](super::aim)).
//!
//! All weights are balance heuristics over these ways (see [`segment`](super::segment)): no light makes an infinite variance.

mod lights;

use crate::light::{Environment, Light, LightChoice, Shadows};
use crate::math::{DVec3, Random, Ray, Rgb, Span, max_channel, uniform};
use crate::medium::{Extinction, Flight, Medium, Phase};
use crate::scene::{Background, Scene};

use super::equi_angular::EquiAngular;
use super::glow::glow;
use super::segment::Segment;

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

/// What a flight finds, each to be multiplied by the throughput before it \[W/(m^2 sr)\].
struct Flown {
    /// Light of near lights, scattered on the way.
    near: Rgb,
    /// Light of the medium itself.
    glow: Rgb,
    end: End,
}

/// How a flight ends.
enum End {
    Collision(Collision),
    Escape {
        /// Factor on the throughput.
        weight: Rgb,
    },
    Absorbed,
}

/// Where it collides.
struct Collision {
    place: DVec3,
    /// How it scatters there.
    phase: Phase,
    /// After it.
    throughput: Rgb,
    /// Of all lights, scattered here; to be multiplied by the throughput after it.
    light: Rgb,
}

/// Traces paths, from one thread.
pub(crate) struct PathTracer<'a, E> {
    medium: &'a Medium,
    extinction: &'a E,
    lights: &'a [Light],
    shadows: Option<&'a Shadows>,
    /// Radiance that is the same all around: found by the paths that leave, and not sampled.
    even_sky: Rgb,
    /// Whether there is an environment that is not even.
    has_environment: bool,
    /// Whether a ray may meet a light that is sampled.
    has_extended: bool,
    background: Background,
    /// The light that counts.
    choice: LightChoice,
    /// For each light, sampling of distances on the current segment.
    towards: Vec<Option<EquiAngular>>,
    /// For each light, the density of all ways that find the last collision over that of the flight.
    ways: Vec<f64>,
}

impl<'a, E: Extinction> PathTracer<'a, E> {
    pub(crate) fn new(scene: &'a Scene, extinction: &'a E) -> Self {
        let lights = &scene.lights;
        Self {
            medium: &scene.medium,
            extinction,
            lights,
            shadows: None,
            even_sky: lights.iter().filter_map(even_sky).sum(),
            has_environment: lights.iter().any(is_image),
            has_extended: lights.iter().any(is_extended),
            background: scene.render.background,
            choice: LightChoice::All,
            towards: vec![None; lights.len()],
            ways: vec![1.0; lights.len()],
        }
    }

    /// The same with what is known of shadows.
    pub(crate) fn with_shadows(mut self, shadows: &'a Shadows) -> Self {
        self.shadows = Some(shadows);
        self
    }

    /// The same of some of the light.
    pub(crate) fn with_choice(mut self, choice: LightChoice) -> Self {
        let chosen = self.lights.iter().enumerate().filter(|(index, _)| choice.has_light(*index));
        self.even_sky = chosen.filter_map(|(_, light)| even_sky(light)).sum();
        self.choice = choice;
        self
    }

    /// The lights that count, each with its number.
    fn chosen_lights(&self) -> impl Iterator<Item = (usize, &'a Light)> + use<'a, E> {
        let choice = self.choice;
        self.lights.iter().enumerate().filter(move |(index, _)| choice.has_light(*index))
    }

    /// An estimate of the light that travels back along a ray.
    pub(super) fn light_along(&mut self, mut ray: Ray, random: &mut Random) -> PathLight {
        let mut seen = PathLight::default();
        let (mut throughput, mut phase_density) = (Rgb::ONE, None);
        for order in 0.. {
            let span = self.medium.bounds.intersect(&ray);
            let needs_whole = order == 0 || self.has_environment;
            let whole = if needs_whole { self.whole(&ray, span, random) } else { Rgb::ONE };
            if order == 0 {
                seen.transmittance = whole;
            }
            seen.add(order, throughput * self.lights_along(&ray, phase_density, whole, random));
            let sky = if order > 0 { throughput * self.even_sky } else { Rgb::ZERO };
            let Some(span) = span else {
                seen.add(order, sky);
                break;
            };
            let (medium, extinction) = (self.medium, self.extinction);
            let segment = Segment { medium, extinction, ray, span, throughput, phase_density };
            let found = self.fly(&segment, random);
            seen.add(order + 1, throughput * found.near);
            seen.add_glow(order, throughput * found.glow);
            let collision = match found.end {
                End::Collision(collision) => collision,
                End::Escape { weight } => {
                    seen.add(order, sky * weight);
                    break;
                }
                End::Absorbed => break,
            };

            throughput = collision.throughput;
            seen.add(order + 1, throughput * collision.light);
            let Collision { place, phase, .. } = collision;
            let arriving = Ray::new(place, ray.direction);
            let aimed = self.aimed_light(&arriving, phase, throughput, random);
            seen.add(order + 2, throughput * aimed);
            match roulette(throughput, random) {
                Some(survivor) => throughput = survivor,
                None => break,
            }
            let direction = phase.sample_direction(ray.direction, random);
            phase_density = Some(phase.density(direction.dot(ray.direction)));
            ray = Ray::new(place, direction);
        }
        seen
    }

    /// An estimate of the radiance that light of at least one earlier scattering makes when it is scattered at a place into the direction of
    /// travel `towards`, per sigma_s: by a path of up to `bounces` collisions, at the last of which `end` knows the same of that place.
    pub(crate) fn scattered_light(
        &mut self,
        place: DVec3,
        towards: DVec3,
        bounces: u32,
        random: &mut Random,
        mut end: impl FnMut(DVec3, DVec3) -> Rgb,
    ) -> Rgb {
        let (medium, extinction) = (self.medium, self.extinction);
        let mut sum = Rgb::ZERO;
        let (mut throughput, mut arriving) = (Rgb::ONE, Ray::new(place, -towards));
        let mut phase = extinction.struck(medium, place, random).phase;
        for bounce in 0..=bounces {
            if bounce == bounces {
                sum += throughput * end(arriving.origin, -arriving.direction);
            } else {
                sum += throughput * self.aimed_light(&arriving, phase, throughput, random);
            }
            let direction = phase.sample_direction(arriving.direction, random);
            let ray = Ray::new(arriving.origin, direction);
            let phase_density = Some(phase.density(direction.dot(arriving.direction)));
            let span = medium.bounds.intersect(&ray);
            // Lights that the first ray meets are scattered but once.
            if bounce > 0 && self.has_extended {
                let whole = match self.has_environment {
                    true => self.whole(&ray, span, random),
                    false => Rgb::ONE,
                };
                sum += throughput * self.lights_along(&ray, phase_density, whole, random);
            }
            // What the first ray meets is scattered but once.
            let sky = if bounce > 0 { throughput * self.even_sky } else { Rgb::ZERO };
            let Some(span) = span else {
                sum += sky;
                break;
            };
            if bounce == bounces {
                if sky != Rgb::ZERO {
                    let flight = extinction.sample_flight(&ray, span, throughput, random);
                    sum += sky * escape_weight(flight);
                }
                break;
            }
            let segment = Segment { medium, extinction, ray, span, throughput, phase_density };
            let found = self.fly(&segment, random);
            sum += throughput * (found.near + found.glow);
            let collision = match found.end {
                End::Collision(collision) => collision,
                End::Escape { weight } => {
                    sum += sky * weight;
                    break;
                }
                End::Absorbed => break,
            };
            throughput = collision.throughput;
            sum += throughput * collision.light;
            match roulette(throughput, random) {
                Some(survivor) => throughput = survivor,
                None => break,
            }
            arriving = Ray::new(collision.place, direction);
            phase = collision.phase;
        }
        sum
    }

    /// A free flight along a segment.
    fn fly(&mut self, segment: &Segment<E>, random: &mut Random) -> Flown {
        let near = self.near_lights(segment, random);
        let Segment { ray, span, throughput, .. } = segment;
        let flight = self.extinction.sample_flight(ray, *span, *throughput, random);
        let distance = match flight {
            Flight::Escape { .. } => span.end,
            Flight::Collision { distance, .. } => distance,
        };
        let glow = match self.choice.has_medium() {
            true => glow(segment, distance, random),
            false => Rgb::ZERO,
        };
        let end = match flight {
            Flight::Escape { weight } => End::Escape { weight },
            Flight::Collision { weight, .. } => {
                let place = ray.at(distance);
                let struck = self.extinction.struck(self.medium, place, random);
                let phase = struck.phase;
                let throughput = *throughput * weight * struck.albedo_at(place);
                match throughput {
                    Rgb::ZERO => End::Absorbed,
                    _ => {
                        let light = self.lights_at(segment, distance, phase, random);
                        End::Collision(Collision { place, phase, throughput, light })
                    }
                }
            }
        };
        Flown { near, glow, end }
    }

    /// Transmittance of a whole ray, of which `span` is in the medium.
    fn whole(&self, ray: &Ray, span: Option<Span>, random: &mut Random) -> Rgb {
        span.map_or(Rgb::ONE, |span| self.extinction.estimate_transmittance(ray, span, random))
    }
}

/// The radiance of an environment that is the same all around.
fn even_sky(light: &Light) -> Option<Rgb> {
    match light {
        Light::Environment(Environment::Constant(radiance)) => Some(*radiance),
        _ => None,
    }
}

fn is_image(light: &Light) -> bool {
    matches!(light, Light::Environment(Environment::Image(_)))
}

/// Whether a ray may meet the light, which is sampled besides.
fn is_extended(light: &Light) -> bool {
    is_image(light) || matches!(light, Light::Quad(_) | Light::Sphere(_))
}

/// Factor on the throughput of a path that leaves; 0 if it does not.
fn escape_weight(flight: Flight) -> Rgb {
    match flight {
        Flight::Escape { weight } => weight,
        Flight::Collision { .. } => Rgb::ZERO,
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
