//! One pass over the film: the camera's rays, pixel by pixel.

use rayon::prelude::*;

use crate::emission::Strata;
use crate::film::{Film, Pixel};
use crate::math::{DVec2, Random, Rgb, Stream, uniform};
use crate::medium::Extinction;
use crate::render::pass_seed;
use crate::render::photon_query::{PhotonQuery, sort_along_curve};
use crate::render::pixel_peak::{WeightedPlace, polar_sample};
use crate::render::pixel_samples::{PixelSample, PixelSamples};
use crate::render::scattered_light::ScatteredLight;
use crate::render::{Observer, Reader};
use crate::scene::Scene;

/// Edge of the square of pixels that one task renders.
const TILE: usize = 16;

/// Rays for the single scattering of a light in the pixel that holds it, a pass.
const PEAK_RAYS: usize = 256;

/// Rays for the single scattering of a light in pixels near it, where it varies as the inverse distance.
const SLOPE_RAYS: usize = 64;

/// 1 over the golden ratio: its multiples modulo 1 are even.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// How near that is \[pixels\]: beyond, a pixel's own rays see less than 10 % of variation.
const SLOPE_REACH: f64 = 8.0;

/// Adds a pass to the film.
pub fn add_pass<'a, E: Extinction + 'a, S: ScatteredLight>(
    film: &mut Film,
    scene: &'a Scene,
    reader: impl Fn() -> Reader<'a, E, S> + Sync,
    pass: u32,
    observer: &dyn Observer,
) {
    let (width, height) = (film.width, film.height);
    let columns = width.div_ceil(TILE);
    let seed = pass_seed(scene.photons.seed, pass);
    let first_sample = u64::from(pass) * scene.render.samples_per_pixel as u64;
    let peaks = peaks(scene);
    let tiles: Vec<Vec<(usize, Pixel)>> = (0..columns * height.div_ceil(TILE))
        .into_par_iter()
        .map(|tile| {
            let (left, top) = (tile % columns * TILE, tile / columns * TILE);
            let mut pass = TilePass::new(scene, first_sample, &peaks, reader());
            let mut indices = Vec::new();
            for y in top..(top + TILE).min(height) {
                for x in left..(left + TILE).min(width) {
                    let index = y * width + x;
                    let mut shift = Stream::Pixel.random(scene.photons.seed, index as u64);
                    let samples = PixelSamples::new(&mut shift);
                    let mut random = Stream::Pixel.random(!seed, index as u64);
                    pass.add_pixel(x, y, &samples, &mut random);
                    indices.push(index);
                }
            }
            let pixels: Vec<(usize, Pixel)> = indices.into_iter().zip(pass.finish()).collect();
            observer.advanced(pixels.len() as u64);
            pixels
        })
        .collect();
    for (index, pixel) in tiles.into_iter().flatten() {
        film.pixels[index] = sum(&film.pixels[index], &pixel);
    }
}

/// Images of the lights that shine from a position inside the medium: (light, place on the image).
fn peaks(scene: &Scene) -> Vec<(usize, DVec2)> {
    let shining = |(index, light): (usize, &crate::light::Light)| {
        let position = light.position().filter(|p| scene.medium.bounds.contains(*p))?;
        Some((index, scene.camera.project(position)?))
    };
    match scene.render.photons_only {
        true => Vec::new(),
        false => scene.lights.iter().enumerate().filter_map(shining).collect(),
    }
}

/// The pixels of a tile in the making.
struct TilePass<'a, E, S> {
    scene: &'a Scene,
    /// Number of the pass's first sample.
    first_sample: u64,
    peaks: &'a [(usize, DVec2)],
    reader: Reader<'a, E, S>,
    pixels: Vec<Pixel>,
    /// Queries answered for each pixel.
    query_counts: Vec<usize>,
    queries: Vec<PhotonQuery>,
}

/// Queries kept before they are answered: enough to be dense, few enough for any number of samples.
const QUERY_BATCH: usize = 16384;

impl<'a, E: Extinction, S: ScatteredLight> TilePass<'a, E, S> {
    fn new(
        scene: &'a Scene,
        first_sample: u64,
        peaks: &'a [(usize, DVec2)],
        reader: Reader<'a, E, S>,
    ) -> Self {
        let (pixels, query_counts, queries) = (Vec::new(), Vec::new(), Vec::new());
        Self { scene, first_sample, peaks, reader, pixels, query_counts, queries }
    }

    /// Traces the rays of the next pixel.
    fn add_pixel(&mut self, x: usize, y: usize, along: &PixelSamples, random: &mut Random) {
        let corner = DVec2::new(x as f64, y as f64);
        let middle = corner + DVec2::splat(0.5);
        let near = |place: DVec2| (place - middle).abs().max_element() <= SLOPE_REACH;
        let peaks: Vec<(usize, DVec2)> =
            self.peaks.iter().copied().filter(|(_, place)| near(*place)).collect();
        let skipped: Vec<usize> = peaks.iter().map(|(light, _)| *light).collect();
        let number = self.pixels.len();
        self.pixels.push(Pixel::default());
        self.query_counts.push(0);

        let samples = self.scene.render.samples_per_pixel;
        let share = 1.0 / samples as f64;
        for sample in 0..samples as u64 {
            let PixelSample { offset, phase } = along.sample(self.first_sample + sample);
            let place = corner + offset;
            let ray = self.scene.camera.ray(place.x, place.y);
            let (reader, queries) = (&mut self.reader, &mut self.queries);
            let seen = reader.direct_light(
                &ray,
                f64::INFINITY,
                &skipped,
                number as u32,
                phase,
                queries,
                random,
            );
            let pixel = &mut self.pixels[number];
            pixel.single_scatter += seen.single_scatter * share;
            pixel.emission += seen.emission * share;
            pixel.transmittance += seen.transmittance * share;
            if self.queries.len() >= QUERY_BATCH {
                self.answer_queries();
            }
        }
        for (light, center) in peaks {
            let peak = self.peak(light, center, corner, random);
            self.pixels[number].single_scatter += peak;
        }
    }

    /// Adds what the photon map says to the pixels that asked.
    fn answer_queries(&mut self) {
        let mut queries = std::mem::take(&mut self.queries);
        if S::ORDERED {
            sort_along_curve(&mut queries);
        }
        let share = 1.0 / self.scene.render.samples_per_pixel as f64;
        for query in &queries {
            let scattered = self.reader.answer(query);
            let pixel = &mut self.pixels[query.pixel as usize];
            pixel.single_scatter += scattered.single * share;
            pixel.multiple_scatter += scattered.multiple * share;
            pixel.photon_count += scattered.photon_count as f64;
            pixel.kernel_radius += scattered.radius;
            self.query_counts[query.pixel as usize] += 1;
        }
        queries.clear();
        self.queries = queries;
    }

    /// The finished pixels.
    fn finish(mut self) -> Vec<Pixel> {
        self.answer_queries();
        for (pixel, &count) in self.pixels.iter_mut().zip(&self.query_counts) {
            // Linear weights may read a little below 0 where next to nothing scatters.
            pixel.single_scatter = pixel.single_scatter.max(Rgb::ZERO);
            pixel.multiple_scatter = pixel.multiple_scatter.max(Rgb::ZERO);
            if count > 0 {
                pixel.photon_count /= count as f64;
                pixel.kernel_radius /= count as f64;
            }
        }
        self.pixels
    }

    /// Single scattering of a light over a pixel that holds it, or is near it.
    fn peak(&mut self, light: usize, center: DVec2, corner: DVec2, random: &mut Random) -> Rgb {
        let within =
            (center - corner).cmpge(DVec2::ZERO).all() && (center - corner).cmplt(DVec2::ONE).all();
        let count = if within { PEAK_RAYS } else { SLOPE_RAYS };
        let strata = Strata::new(count as u64, &[1.0, 1.0]);
        let samples = self.scene.render.light_samples;
        let first = uniform(random);
        let mut sum = Rgb::ZERO;
        for index in 0..count {
            let sample = if within {
                polar_sample(center, corner, index, count, random)
            } else {
                let cell = strata.cell(index as u64);
                let offset = DVec2::new(cell[0].at(uniform(random)), cell[1].at(uniform(random)));
                WeightedPlace { position: corner + offset, weight: 1.0 }
            };
            let ray = self.scene.camera.ray(sample.position.x, sample.position.y);
            let phase = (first + index as f64 * GOLDEN).fract();
            sum +=
                self.reader.single_scatter_of(&ray, light, samples, phase, random) * sample.weight;
        }
        sum / count as f64
    }
}

fn sum(a: &Pixel, b: &Pixel) -> Pixel {
    Pixel {
        single_scatter: a.single_scatter + b.single_scatter,
        multiple_scatter: a.multiple_scatter + b.multiple_scatter,
        emission: a.emission + b.emission,
        transmittance: a.transmittance + b.transmittance,
        photon_count: a.photon_count + b.photon_count,
        kernel_radius: a.kernel_radius + b.kernel_radius,
        ..*a
    }
}
