//! Reading a lit medium along rays.

use crate::estimate::{Estimator, InScattered};
use crate::film::PixelDepths;
use crate::lattice::Lamps;
use crate::light::{Light, LightChoice, Shadows, transmittance_to};
use crate::math::{Random, Ray, Rgb, Span, exp, uniform};
use crate::medium::{Extinction, RayProfile};
use crate::render::distances::{ByTransmittance, InverseDistance, even_quantile};
use crate::render::emitted_light::emitted_light;
use crate::render::photon_query::PhotonQuery;
use crate::render::ray_depths::ray_depths;
use crate::render::scattered_light::ScatteredLight;
use crate::render::single_scatter::ScatteringRay;
use crate::scene::{Background, Scene};

/// Light along a ray, by its way through the medium.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayRadiance {
    /// Of lights, scattered once \[W/(m^2 sr)\].
    pub single_scatter: Rgb,
    /// Scattered twice or more; of the medium's own light, all that is scattered.
    pub multiple_scatter: Rgb,
    /// From lights seen directly, and of the medium's own, attenuated.
    pub emission: Rgb,
    /// Transmittance of the ray's whole part in the medium.
    pub transmittance: Rgb,
    /// How deep the ray looks, where it is asked for.
    pub depths: PixelDepths,
}

/// How a ray is looked along.
#[derive(Clone, Copy, Debug)]
pub struct Looking<'a> {
    /// Lights whose single scattering is computed elsewhere.
    pub skipped: &'a [usize],
    /// The pixel that queries are for.
    pub pixel: u32,
    /// Where in each stratum of the ray it is looked at, in \[0, 1): uniform.
    pub phase: f64,
}

/// Reads a lit medium, from one thread: light along rays.
pub struct Reader<'a, E, S> {
    scene: &'a Scene,
    extinction: &'a E,
    scattered_light: S,
    shadows: Option<&'a Shadows>,
    most_samples: [usize; 2],
    choice: LightChoice,
    finds_depths: bool,
    profile: RayProfile,
    queries: Vec<PhotonQuery>,
}

impl<'a, E: Extinction> Reader<'a, E, Estimator<'a, E>> {
    /// Estimates at places.
    pub fn estimator(&mut self) -> &mut Estimator<'a, E> {
        &mut self.scattered_light
    }
}

impl<'a, E: Extinction, S: ScatteredLight> Reader<'a, E, S> {
    /// A reader, to which `scattered_light` says what is scattered more than once.
    pub fn new(scene: &'a Scene, extinction: &'a E, scattered_light: S) -> Self {
        let (profile, queries) = (RayProfile::default(), Vec::new());
        let (shadows, choice) = (None, LightChoice::All);
        Self {
            scene,
            extinction,
            scattered_light,
            shadows,
            most_samples: [usize::MAX; 2],
            choice,
            finds_depths: false,
            profile,
            queries,
        }
    }

    /// The same with what is known of shadows.
    pub fn with_shadows(mut self, shadows: &'a Shadows) -> Self {
        self.shadows = Some(shadows);
        self
    }

    /// The same with no more than so many points a ray, of single and of multiple scattering, where many rays share a pixel.
    pub fn with_most_samples(mut self, most_samples: [usize; 2]) -> Self {
        self.most_samples = most_samples;
        self
    }

    /// The same for some light alone.
    pub fn with_choice(mut self, choice: LightChoice) -> Self {
        self.choice = choice;
        self
    }

    /// The same with depths, if `finds_depths`.
    pub fn with_depths(mut self, finds_depths: bool) -> Self {
        self.finds_depths = finds_depths;
        self
    }

    /// The lights looked at, each with its number.
    fn lights(&self) -> impl Iterator<Item = (usize, &'a Light)> {
        let choice = self.choice;
        self.scene.lights.iter().enumerate().filter(move |(index, _)| choice.has_light(*index))
    }

    /// Transmittance of a ray up to `max_distance` \[m\].
    pub fn transmittance_along(&self, ray: &Ray, max_distance: f64) -> Rgb {
        let (origin, direction) = (ray.origin, ray.direction);
        transmittance_to(&self.scene.medium, self.extinction, origin, direction, max_distance)
    }

    /// Light that travels back along a ray from up to `max_distance` \[m\] ahead.
    pub fn light_along(
        &mut self,
        ray: &Ray,
        max_distance: f64,
        random: &mut Random,
    ) -> RayRadiance {
        let mut queries = std::mem::take(&mut self.queries);
        queries.clear();
        let looking = Looking { skipped: &[], pixel: 0, phase: uniform(random) };
        let mut radiance = self.direct_light(ray, max_distance, looking, &mut queries, random);
        for query in &queries {
            let scattered = self.answer(query);
            radiance.single_scatter += scattered.single;
            radiance.multiple_scatter += scattered.multiple;
        }
        self.queries = queries;
        radiance
    }

    /// The part of that light that needs no photons, and the queries that give the rest.
    pub fn direct_light(
        &mut self,
        ray: &Ray,
        max_distance: f64,
        looking: Looking,
        queries: &mut Vec<PhotonQuery>,
        random: &mut Random,
    ) -> RayRadiance {
        let Looking { skipped, pixel, phase } = looking;
        let inside = self.scene.medium.bounds.intersect(ray);
        let Some(span) = inside.and_then(|s| s.intersect(Span::new(0.0, max_distance))) else {
            return RayRadiance {
                emission: self.unscattered(ray, max_distance, |_| Rgb::ONE),
                transmittance: Rgb::ONE,
                ..RayRadiance::default()
            };
        };
        self.extinction.profile(ray, span, &mut self.profile);
        let profile = &self.profile;
        let mut radiance = RayRadiance {
            emission: self.unscattered(ray, max_distance, |distance| {
                exp(-profile.optical_depth(distance.clamp(span.start, span.end)))
            }),
            transmittance: exp(-profile.optical_depth(span.end)),
            ..RayRadiance::default()
        };
        if let Some(emissivity) = &self.scene.medium.emissivity
            && self.choice.has_medium()
        {
            let medium = &self.scene.medium;
            radiance.emission += emitted_light(medium, emissivity, ray, span, profile, random);
        }
        if self.finds_depths {
            let medium = &self.scene.medium;
            radiance.depths = ray_depths(medium, self.extinction, ray, span, profile, phase);
        }
        if !self.scene.render.photons_only {
            radiance.single_scatter = self.single_scatter(ray, span, skipped, phase, random);
        }
        self.push_queries(ray, span, pixel, phase, queries, random);
        radiance
    }

    /// Single scattering alone of one light, from `samples` distances.
    pub fn single_scatter_of(
        &mut self,
        ray: &Ray,
        light: usize,
        samples: usize,
        phase: f64,
        random: &mut Random,
    ) -> Rgb {
        let Some(span) = self.scene.medium.bounds.intersect(ray) else { return Rgb::ZERO };
        self.extinction.profile(ray, span, &mut self.profile);
        self.scattering_ray(ray, span).single_scatter(
            (light, &self.scene.lights[light]),
            samples,
            phase,
            random,
        )
    }

    fn scattering_ray<'r>(&'r self, ray: &'r Ray, span: Span) -> ScatteringRay<'r, E> {
        let (medium, profile) = (&self.scene.medium, &self.profile);
        ScatteringRay {
            medium,
            extinction: self.extinction,
            shadows: self.shadows,
            ray,
            span,
            profile,
        }
    }

    fn single_scatter(
        &self,
        ray: &Ray,
        span: Span,
        skipped: &[usize],
        phase: f64,
        random: &mut Random,
    ) -> Rgb {
        let scattering = self.scattering_ray(ray, span);
        let samples = self.scene.render.light_samples.min(self.most_samples[0]);
        let lights = self.lights().filter(|(index, _)| !skipped.contains(index));
        lights.map(|light| scattering.single_scatter(light, samples, phase, random)).sum()
    }

    /// Lights seen along the ray; a background that is held out is none of them.
    fn unscattered(&self, ray: &Ray, max_distance: f64, transmittance: impl Fn(f64) -> Rgb) -> Rgb {
        let is_background_seen = self.scene.render.background == Background::Visible;
        let visible = self.lights().filter(|(_, light)| light.is_visible());
        let seen = visible.filter_map(|(_, light)| light.seen_along(ray));
        let near = seen.filter(|(distance, _)| {
            *distance <= max_distance && (is_background_seen || distance.is_finite())
        });
        near.map(|(distance, radiance)| radiance * transmittance(distance)).sum()
    }

    /// Queries at distances that are equally spaced in transmittance.
    fn push_queries(
        &self,
        ray: &Ray,
        span: Span,
        pixel: u32,
        phase: f64,
        queries: &mut Vec<PhotonQuery>,
        random: &mut Random,
    ) {
        let Some(by_transmittance) = ByTransmittance::new(&self.profile, span) else { return };
        let samples = self.scene.render.march_samples.min(self.most_samples[1]);
        let count = samples as f64;
        let lamps = self.scattered_light.lamps();
        for stratum in 0..samples {
            let u = even_quantile(stratum, phase, samples);
            let distance = by_transmittance.sample_distance(u, uniform(random));
            let place = ray.at(distance);
            let sigma_t = if E::IS_UNIFORM { self.extinction.sigma_t(place) } else { Rgb::ONE };
            let share = lamps.map_or(1.0, |lamps| lamps.even_share(place));
            let weight = by_transmittance.scattering_weight(distance, sigma_t, count)
                * self.extinction.albedo_at(&self.scene.medium, place)
                * share;
            let (towards, turn) = (-ray.direction, uniform(random));
            queries.push(PhotonQuery { place, towards, weight, turn, pixel });
        }
        if let Some(lamps) = lamps {
            let samples = samples.div_ceil(2);
            self.push_queries_near(lamps, (ray, span), samples, (pixel, phase), queries);
        }
    }

    /// Queries for the lamps' own shares of the light, at distances that follow the peak of each that the ray passes near.
    fn push_queries_near(
        &self,
        lamps: &Lamps,
        (ray, span): (&Ray, Span),
        samples: usize,
        (pixel, phase): (u32, f64),
        queries: &mut Vec<PhotonQuery>,
    ) {
        for (lamp, center, near) in lamps.near(ray, span) {
            let by_distance = InverseDistance::new(ray, near, center);
            for stratum in 0..samples {
                let distance = by_distance.sample_distance(even_quantile(stratum, phase, samples));
                let place = ray.at(distance);
                let density = samples as f64 * by_distance.pdf_distance(distance);
                let share = lamps.own_share(lamp, place) / density;
                let weight = exp(-self.profile.optical_depth(distance))
                    * self.extinction.sigma_t(place)
                    * self.extinction.albedo_at(&self.scene.medium, place)
                    * share;
                let towards = -ray.direction;
                queries.push(PhotonQuery { place, towards, weight, turn: phase, pixel });
            }
        }
    }

    /// The answer to a query, weighted.
    pub fn answer(&mut self, query: &PhotonQuery) -> InScattered {
        weighted(self.scattered_light.in_scattered(query), query)
    }

    /// The same, and what cells twice as long would add to it.
    pub fn compared_answer(&mut self, query: &PhotonQuery) -> (InScattered, Rgb) {
        let (scattered, coarse) = self.scattered_light.compared(query);
        (weighted(scattered, query), coarse * query.weight)
    }
}

fn weighted(mut scattered: InScattered, query: &PhotonQuery) -> InScattered {
    scattered.single *= query.weight;
    scattered.multiple *= query.weight;
    scattered
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::lattice::LightLattice;
    use crate::math::{DVec3, Stream};
    use crate::medium::MediumExtinction;
    use crate::render::lit_lattice::{self, ReadFrom};
    use crate::render::scattered_light::LatticeReader;
    use crate::render::{RenderReport, Unobserved};
    use crate::scene::Overrides;

    /// What is read on average along rays that pass lamps by far less than a cell is the integral of what the lattice holds, peaks and all.
    #[test]
    fn peaks_of_lamps_are_integrated_exactly() {
        let text = "[camera]\nposition = [0.0, 0.0, 3.0]\nlook_at = [0.0, 0.0, 0.0]\nvertical_fov = 40.0\nresolution = [4, 4]\n\
            [medium]\nkind = \"homogeneous\"\nbounds = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }\nsigma_t = 1.5\nalbedo = 0.9\n\
            [[light]]\nkind = \"point\"\nposition = [0.1, 0.2, 0.0]\nintensity = 1.0\n\
            [[light]]\nkind = \"point\"\nposition = [0.1, 0.2, 0.09]\nintensity = 2.0\n";
        let scene = Scene::from_text(text, Path::new("lamps.toml"), &Overrides::default()).unwrap();
        let MediumExtinction::Uniform(fog) = &scene.medium.extinction else { panic!("no fog") };
        let emission = lit_lattice::emission(&scene, fog, 20_000);
        let wanted = (16, ReadFrom::Camera, LightChoice::All);
        let mut report = RenderReport::default();
        let lattice: LightLattice =
            lit_lattice::trace(&scene, fog, &emission, wanted, &Unobserved, &mut report).unwrap();
        let phase = scene.medium.phase;
        let mut reader = Reader::new(&scene, fog, LatticeReader { lattice: &lattice, phase });
        for offset in [0.002, 0.02, 0.08] {
            let ray = Ray::new(DVec3::new(0.1 + offset, 0.2, 3.0), DVec3::NEG_Z);
            let held = |t: f64| {
                let light = lattice.scattered(ray.at(t), -ray.direction, phase).x;
                0.9 * 1.5 * (-1.5 * (t - 2.0)).exp() * light
            };
            const STEPS: usize = 400_000;
            let step = 2.0 / STEPS as f64;
            let exact = (0..STEPS).map(|i| held(2.0 + (i as f64 + 0.5) * step)).sum::<f64>() * step;
            let mut random = Stream::Experiment.random(31, 0);
            const BATCHES: usize = 32;
            let means: Vec<f64> = (0..BATCHES)
                .map(|_| {
                    let rays =
                        (0..200).map(|_| reader.light_along(&ray, f64::INFINITY, &mut random));
                    rays.map(|seen| seen.multiple_scatter.x).sum::<f64>() / 200.0
                })
                .collect();
            let mean = means.iter().sum::<f64>() / BATCHES as f64;
            let squares = means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>();
            let error = (squares / (BATCHES * (BATCHES - 1)) as f64).sqrt();
            let z = (mean - exact) / error;
            assert!(z.abs() < 4.5 && error < 5e-3 * exact, "{offset}: {mean} {exact} {error}");
        }
    }
}
