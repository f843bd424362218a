//! What the lights send to a path: along a segment, to places of it drawn towards them, to the collision that ends it, and to
//! rays aimed from there.

use crate::light::{Illumination, Light};
use crate::math::{DVec3, Random, Ray, Rgb, Span, uniform};
use crate::medium::{Extinction, Phase};
use crate::reference::aim::Aim;
use crate::reference::equi_angular::EquiAngular;
use crate::reference::light_sample::{pdf_light, sample_light};
use crate::reference::segment::{Segment, peak_of};
use crate::scene::Background;

use super::{PathTracer, even_sky};

impl<E: Extinction> PathTracer<'_, E> {
    /// Lights that the ray meets, weighed against sampling them from its start. `whole` is the transmittance of the whole ray.
    pub(super) fn lights_along(
        &self,
        ray: &Ray,
        phase_density: Option<f64>,
        whole: Rgb,
        random: &mut Random,
    ) -> Rgb {
        let mut sum = Rgb::ZERO;
        for (index, light) in self.chosen_lights() {
            let ways = self.ways[index];
            let Some((distance, radiance)) = light.seen_along(ray) else { continue };
            let is_held_out = distance.is_infinite() && self.background == Background::Holdout;
            let is_seen_by_camera = phase_density.is_none();
            if is_seen_by_camera && (is_held_out || !light.is_visible()) {
                continue;
            }
            // An even sky is the camera's to see; scattered, paths find it where they leave.
            let is_found = phase_density.is_some() && even_sky(light).is_some();
            if radiance == Rgb::ZERO || is_found {
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
    pub(super) fn near_lights(&mut self, segment: &Segment<E>, random: &mut Random) -> Rgb {
        let mut sum = Rgb::ZERO;
        for (index, light) in self.chosen_lights() {
            let towards = segment.equi_angular(light);
            if let Some(towards) = &towards {
                sum += self.near_light(segment, (index, light), towards, random);
            }
            self.towards[index] = towards;
        }
        sum
    }

    fn near_light(
        &self,
        segment: &Segment<E>,
        (index, light): (usize, &Light),
        towards: &EquiAngular,
        random: &mut Random,
    ) -> Rgb {
        let distance = towards.sample_distance(uniform(random));
        let place = segment.ray.at(distance);
        let sigma_t = self.extinction.sigma_t(place);
        let struck = self.extinction.struck(self.medium, place, random);
        let sigma_s = sigma_t * struck.albedo_at(place);
        if sigma_s == Rgb::ZERO {
            return Rgb::ZERO;
        }
        let flight = segment.flight_density(distance, sigma_t);
        let density = segment.density(light, Some(towards), distance, flight);
        let arriving = Ray::new(place, segment.ray.direction);
        let from = (index, light);
        let scattered = self.light_at(from, &arriving, struck.phase, [flight, density], random);
        if scattered == Rgb::ZERO {
            return Rgb::ZERO;
        }
        let passed = Span::new(segment.span.start, distance);
        sigma_s * scattered * self.extinction.estimate_transmittance(&segment.ray, passed, random)
    }

    /// Light of all lights, scattered at the collision that ends a segment.
    pub(super) fn lights_at(
        &mut self,
        segment: &Segment<E>,
        distance: f64,
        phase: Phase,
        random: &mut Random,
    ) -> Rgb {
        let place = segment.ray.at(distance);
        let arriving = Ray::new(place, segment.ray.direction);
        let flight = segment.flight_density(distance, self.extinction.sigma_t(place));
        let mut sum = Rgb::ZERO;
        for (index, light) in self.chosen_lights() {
            if even_sky(light).is_some() {
                continue;
            }
            let ways = match &self.towards[index] {
                Some(towards) if flight > 0.0 => {
                    segment.density(light, Some(towards), distance, flight) / flight
                }
                _ => 1.0,
            };
            self.ways[index] = ways;
            sum += self.light_at((index, light), &arriving, phase, [1.0, ways], random);
        }
        sum
    }

    /// Light of the point lights in the medium, scattered on rays aimed at them and then where a ray arrives, its origin.
    pub(super) fn aimed_light(
        &self,
        arriving: &Ray,
        phase: Phase,
        throughput: Rgb,
        random: &mut Random,
    ) -> Rgb {
        let mut sum = Rgb::ZERO;
        let (medium, extinction) = (self.medium, self.extinction);
        for (index, light) in self.chosen_lights() {
            let aim = peak_of(light, medium).and_then(|peak| Aim::new(arriving.origin, peak));
            let Some(aim) = aim else { continue };
            let ray = Ray::new(arriving.origin, aim.sample_direction(random));
            let Some(span) = medium.bounds.intersect(&ray) else { continue };
            let phase_density = Some(phase.density(ray.direction.dot(arriving.direction)));
            let segment = Segment { medium, extinction, ray, span, throughput, phase_density };
            if let Some(towards) = segment.equi_angular(light) {
                sum += self.near_light(&segment, (index, light), &towards, random);
            }
        }
        sum
    }

    /// Phase-weighted light from one direction towards a light, attenuated, where a ray arrives, its origin; over the density of all ways that
    /// find it: `density` is that of all ways that find the place, of which `flight` may go on to meet the light by itself.
    fn light_at(
        &self,
        (index, light): (usize, &Light),
        arriving: &Ray,
        phase: Phase,
        [flight, density]: [f64; 2],
        random: &mut Random,
    ) -> Rgb {
        let Some(sample) = sample_light(light, arriving.origin, random) else { return Rgb::ZERO };
        // Against the light's travel, as the path goes: the phase function is the same both ways.
        let phase = phase.density(sample.from.direction.dot(arriving.direction));
        let met = sample.pdf.map_or(0.0, |pdf| flight * phase / pdf);
        let weighted = sample.from.irradiance * (phase / (density + met));
        if weighted == Rgb::ZERO {
            return Rgb::ZERO;
        }
        let place = arriving.origin;
        let known = self.shadows.and_then(|shadows| shadows.transmittance(index, place));
        let Illumination { direction, distance, .. } = sample.from;
        weighted * known.unwrap_or_else(|| self.transmittance(place, direction, distance, random))
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
