//! One pass over the film: the camera's rays, pixel by pixel.

use rayon::prelude::*;

use crate::film::{Film, Pixel, PixelDepths};
use crate::light::LightChoice;
use crate::math::{DVec2, Random, Rgb, Stream, mean_channel, uniform};
use crate::medium::Extinction;
use crate::render::error_estimate::is_probed;
use crate::render::photon_query::{PhotonQuery, sort_along_curve};
use crate::render::pixel_peak::{PolarPixel, holds};
use crate::render::pixel_samples::{PixelSample, PixelSamples};
use crate::render::reader::Looking;
use crate::render::scattered_light::ScatteredLight;
use crate::render::{Observer, Reader};
use crate::scene::Scene;

/// Edge of the square of pixels that one task renders.
const TILE: usize = 16;

/// Rays for the single scattering of a light in the pixel that holds it, for each that other pixels have.
const PEAK_RAYS: usize = 64;

/// The same in pixels near it, where it varies as the inverse distance.
const SLOPE_RAYS: usize = 16;

/// 1 / x and 1 / x^2 with x^3 = x + 1: their multiples modulo 1 are even in the plane.
const PLANE_STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];

/// How near that is \[pixels\]: a sixteenth of the image, but no less and no more than this. At 8 pixels a pixel's own rays see 10 % of variation.
const SLOPE_REACH: [f64; 2] = [8.0, 32.0];

/// What a pass over the film looks for.
pub struct FilmPass<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Seed of the pass.
    pub seed: u64,
    /// 0 or 1: passes of either half place their rays between each other's, and independently of the other half's.
    pub half: u32,
    /// Rays a pixel.
    pub samples_per_pixel: usize,
    /// Number of the first of them among those of all passes of the half.
    pub first_sample: u64,
    /// The light looked for.
    pub choice: LightChoice,
    /// Whether depths are, too.
    pub finds_depths: bool,
}

/// What a pass finds.
pub struct PassFilm {
    /// The image.
    pub film: Film,
    /// What light from coarse cells would add to each probed pixel, mean channel; empty without cells.
    pub coarse_differences: Vec<f64>,
}

impl PassFilm {
    /// The first part of a pass that is rendered light by light, its light in one layer of those of such names.
    pub fn into_layer(mut self, names: &[String], layer: usize) -> Self {
        self.film = self.film.with_lights(names);
        if let Some(light) = self.film.lights.get_mut(layer) {
            light.radiance = self.film.pixels.iter().map(Pixel::radiance).collect();
        }
        self
    }

    /// Adds the light of another part of the pass, which is seen along the same rays. `layer` is that of its lights, if there are any.
    pub fn add_light(&mut self, part: &PassFilm, layer: Option<usize>) {
        for (pixel, of_part) in self.film.pixels.iter_mut().zip(&part.film.pixels) {
            pixel.single_scatter += of_part.single_scatter;
            pixel.multiple_scatter += of_part.multiple_scatter;
            pixel.emission += of_part.emission;
        }
        if let Some(light) = layer.and_then(|layer| self.film.lights.get_mut(layer)) {
            let pixels = light.radiance.iter_mut().zip(&part.film.pixels);
            pixels.for_each(|(sum, pixel)| *sum += pixel.radiance());
        }
        for (sum, difference) in self.coarse_differences.iter_mut().zip(&part.coarse_differences) {
            *sum += difference;
        }
    }
}

impl<'a> FilmPass<'a> {
    /// Renders the pass. Every thread takes readers of its own.
    pub fn render<E: Extinction + 'a, S: ScatteredLight>(
        &self,
        reader: impl Fn() -> Reader<'a, E, S> + Sync,
        observer: &dyn Observer,
    ) -> PassFilm {
        let camera = &self.scene.camera;
        let (width, height) = (camera.width, camera.height);
        let columns = width.div_ceil(TILE);
        let peaks = peaks(self.scene, self.choice);
        let tiles: Vec<Vec<RenderedPixel>> = (0..columns * height.div_ceil(TILE))
            .into_par_iter()
            .map(|tile| {
                let (left, top) = (tile % columns * TILE, tile / columns * TILE);
                let mut pass = TilePass::new(self, &peaks, reader());
                for y in top..(top + TILE).min(height) {
                    for x in left..(left + TILE).min(width) {
                        pass.add_pixel(x, y);
                    }
                }
                let pixels = pass.finish();
                observer.advanced(pixels.len() as u64);
                pixels
            })
            .collect();
        let mut film = Film::new(width, height);
        if self.finds_depths {
            film = film.with_depths();
        }
        let mut coarse_differences = Vec::new();
        for made in tiles.into_iter().flatten() {
            film.pixels[made.index] = made.pixel;
            if let Some(depths) = &mut film.depths {
                depths[made.index] = made.depths;
            }
            coarse_differences.extend(made.coarse_difference);
        }
        PassFilm { film, coarse_differences }
    }
}

/// A pixel in the making.
#[derive(Default)]
struct RenderedPixel {
    /// In the film.
    index: usize,
    pixel: Pixel,
    depths: PixelDepths,
    /// Queries answered.
    query_count: usize,
    /// What coarse cells would add, if it is asked for.
    coarse_difference: Option<f64>,
}

/// Images of the lights that shine from a position inside the medium: (light, place on the image).
fn peaks(scene: &Scene, choice: LightChoice) -> Vec<(usize, DVec2)> {
    let shining = |(index, light): (usize, &crate::light::Light)| {
        choice.has_light(index).then_some(())?;
        let position = light.position().filter(|p| scene.medium.bounds.contains(*p))?;
        Some((index, scene.camera.project(position)?))
    };
    match scene.render.photons_only {
        true => Vec::new(),
        false => scene.lights.iter().enumerate().filter_map(shining).collect(),
    }
}

/// The pixels of a tile in the making.
struct TilePass<'p, 'a, E, S> {
    pass: &'p FilmPass<'a>,
    peaks: &'p [(usize, DVec2)],
    /// [`SLOPE_REACH`] of this image.
    slope_reach: f64,
    reader: Reader<'a, E, S>,
    pixels: Vec<RenderedPixel>,
    queries: Vec<PhotonQuery>,
}

/// Queries kept before they are answered: enough to be dense, few enough for any number of samples.
const QUERY_BATCH: usize = 16384;

impl<'p, 'a, E: Extinction, S: ScatteredLight> TilePass<'p, 'a, E, S> {
    fn new(pass: &'p FilmPass<'a>, peaks: &'p [(usize, DVec2)], reader: Reader<'a, E, S>) -> Self {
        let reader = reader.with_choice(pass.choice).with_depths(pass.finds_depths);
        let pixels = pass.scene.camera.width * pass.scene.camera.height;
        let [least, most] = SLOPE_REACH;
        let slope_reach = ((pixels as f64).sqrt() / 16.0).clamp(least, most);
        Self { pass, peaks, slope_reach, reader, pixels: Vec::new(), queries: Vec::new() }
    }

    /// Traces the rays of the next pixel.
    fn add_pixel(&mut self, x: usize, y: usize) {
        let scene = self.pass.scene;
        let index = y * scene.camera.width + x;
        let shift = scene.photons.seed ^ u64::from(self.pass.half);
        let samples = PixelSamples::new(&mut Stream::Pixel.random(shift, index as u64));
        let random = &mut Stream::Pixel.random(!self.pass.seed, index as u64);

        let corner = DVec2::new(x as f64, y as f64);
        let middle = corner + DVec2::splat(0.5);
        let near = |place: DVec2| (place - middle).abs().max_element() <= self.slope_reach;
        let peaks: Vec<(usize, DVec2)> =
            self.peaks.iter().copied().filter(|(_, place)| near(*place)).collect();
        let skipped: Vec<usize> = peaks.iter().map(|(light, _)| *light).collect();
        let number = self.pixels.len();
        let coarse_difference = (S::HAS_COARSE && is_probed(x, y)).then_some(0.0);
        self.pixels.push(RenderedPixel { index, coarse_difference, ..RenderedPixel::default() });

        let count = self.pass.samples_per_pixel;
        let share = 1.0 / count as f64;
        for sample in 0..count as u64 {
            let PixelSample { offset, phase } = samples.sample(self.pass.first_sample + sample);
            let place = corner + offset;
            let ray = scene.camera.ray(place.x, place.y);
            let looking = Looking { skipped: &skipped, pixel: number as u32, phase };
            let (reader, queries) = (&mut self.reader, &mut self.queries);
            let seen = reader.direct_light(&ray, f64::INFINITY, looking, queries, random);
            let RenderedPixel { pixel, depths, .. } = &mut self.pixels[number];
            depths.add(&seen.depths, share);
            pixel.single_scatter += seen.single_scatter * share;
            pixel.emission += seen.emission * share;
            pixel.transmittance += seen.transmittance * share;
            pixel.sample_count += 1.0;
            if self.queries.len() >= QUERY_BATCH {
                self.answer_queries();
            }
        }
        for (light, center) in peaks {
            let peak = self.peak(light, center, corner, random);
            self.pixels[number].pixel.single_scatter += peak;
        }
    }

    /// Adds what photons say to the pixels that asked.
    fn answer_queries(&mut self) {
        let mut queries = std::mem::take(&mut self.queries);
        if S::ORDERED {
            sort_along_curve(&mut queries);
        }
        let share = 1.0 / self.pass.samples_per_pixel as f64;
        for query in &queries {
            let made = &mut self.pixels[query.pixel as usize];
            let scattered = match &mut made.coarse_difference {
                None => self.reader.answer(query),
                Some(sum) => {
                    let (scattered, coarse) = self.reader.compared_answer(query);
                    *sum += mean_channel(coarse) * share;
                    scattered
                }
            };
            made.pixel.single_scatter += scattered.single * share;
            made.pixel.multiple_scatter += scattered.multiple * share;
            made.pixel.photon_count += scattered.photon_count as f64;
            made.pixel.kernel_radius += scattered.radius;
            made.query_count += 1;
        }
        queries.clear();
        self.queries = queries;
    }

    /// The finished pixels.
    fn finish(mut self) -> Vec<RenderedPixel> {
        self.answer_queries();
        for RenderedPixel { pixel, query_count, .. } in &mut self.pixels {
            // Linear weights may read a little below 0 where next to nothing scatters.
            pixel.single_scatter = pixel.single_scatter.max(Rgb::ZERO);
            pixel.multiple_scatter = pixel.multiple_scatter.max(Rgb::ZERO);
            if *query_count > 0 {
                pixel.photon_count /= *query_count as f64;
                pixel.kernel_radius /= *query_count as f64;
            }
        }
        self.pixels
    }

    /// Single scattering of a light over a pixel that holds its image, or is near it.
    fn peak(&mut self, light: usize, center: DVec2, corner: DVec2, random: &mut Random) -> Rgb {
        let scene = self.pass.scene;
        let pixel = PolarPixel::new(center, corner);
        let rays = if holds(center, corner) { PEAK_RAYS } else { SLOPE_RAYS };
        let count = rays * self.pass.samples_per_pixel;
        let samples = scene.render.light_samples;
        let first: [f64; 3] = std::array::from_fn(|_| uniform(random));
        let mut sum = Rgb::ZERO;
        for index in 0..count {
            // A lattice of three dimensions: angle, distance on the image, depth along the ray.
            let step = index as f64;
            let angle = (step + first[0]) / count as f64;
            let [distance, phase] = [1, 2].map(|i| (first[i] + step * PLANE_STEPS[i - 1]).fract());
            let sample = pixel.sample(DVec2::new(angle, distance));
            let ray = scene.camera.ray(sample.position.x, sample.position.y);
            let light = self.reader.single_scatter_of(&ray, light, samples, phase, random);
            sum += light * sample.weight;
        }
        sum / count as f64
    }
}
