//! One pass over the film: the camera's rays, pixel by pixel.

use rayon::prelude::*;

use crate::emission::Strata;
use crate::film::{Film, Pixel};
use crate::math::{DVec2, Random, Rgb, Stream, uniform};
use crate::medium::Extinction;
use crate::render::pixel_peak::{WeightedPlace, polar_sample};
use crate::render::{LitMedium, Observer, Reader};
use crate::scene::Scene;

/// Edge of the square of pixels that one task renders.
const TILE: usize = 16;

/// Rays for the single scattering of a light in the pixel that holds it, a pass.
const PEAK_RAYS: usize = 256;

/// Rays for the single scattering of a light in pixels near it, where it varies as the inverse distance.
const SLOPE_RAYS: usize = 64;

/// How near that is \[pixels\]: beyond, a pixel's own rays see less than 10 % of variation.
const SLOPE_REACH: f64 = 8.0;

/// Adds a pass to the film.
pub fn add_pass<E: Extinction>(
    film: &mut Film,
    scene: &Scene,
    lit: &LitMedium<E>,
    seed: u64,
    observer: &dyn Observer,
) {
    let (width, height) = (film.width, film.height);
    let columns = width.div_ceil(TILE);
    let strata = Strata::new(scene.render.samples_per_pixel as u64, &[1.0, 1.0]);
    let peaks = peaks(scene);
    let tiles: Vec<Vec<(usize, Pixel)>> = (0..columns * height.div_ceil(TILE))
        .into_par_iter()
        .map(|tile| {
            let (left, top) = (tile % columns * TILE, tile / columns * TILE);
            let mut pass =
                PixelPass { scene, strata: &strata, peaks: &peaks, reader: lit.reader() };
            let rows = top..(top + TILE).min(height);
            let pixels: Vec<(usize, Pixel)> = rows
                .flat_map(|y| (left..(left + TILE).min(width)).map(move |x| (x, y)))
                .map(|(x, y)| {
                    let index = y * width + x;
                    let mut random = Stream::Pixel.random(seed, index as u64);
                    (index, pass.pixel(x, y, &mut random))
                })
                .collect();
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

/// What the pixels of a tile share.
struct PixelPass<'a, E> {
    scene: &'a Scene,
    strata: &'a Strata,
    peaks: &'a [(usize, DVec2)],
    reader: Reader<'a, E>,
}

impl<E: Extinction> PixelPass<'_, E> {
    fn pixel(&mut self, x: usize, y: usize, random: &mut Random) -> Pixel {
        let corner = DVec2::new(x as f64, y as f64);
        let middle = corner + DVec2::splat(0.5);
        let near = |place: DVec2| (place - middle).abs().max_element() <= SLOPE_REACH;
        let peaks: Vec<(usize, DVec2)> =
            self.peaks.iter().copied().filter(|(_, place)| near(*place)).collect();
        let skipped: Vec<usize> = peaks.iter().map(|(light, _)| *light).collect();

        let samples = self.scene.render.samples_per_pixel;
        let share = 1.0 / samples as f64;
        let mut pixel = Pixel::default();
        let mut queries = 0;
        for sample in 0..samples {
            let cell = self.strata.cell(sample as u64);
            let offset = DVec2::new(cell[0].at(uniform(random)), cell[1].at(uniform(random)));
            let place = corner + offset;
            let ray = self.scene.camera.ray(place.x, place.y);
            let seen = self.reader.light_along(&ray, f64::INFINITY, &skipped, random);
            pixel.single_scatter += seen.single_scatter * share;
            pixel.multiple_scatter += seen.multiple_scatter * share;
            pixel.emission += seen.emission * share;
            pixel.transmittance += seen.transmittance * share;
            pixel.photon_count += seen.photon_count as f64;
            pixel.kernel_radius += seen.radius_sum;
            queries += seen.query_count;
        }
        // Linear weights may read a little below 0 where next to nothing scatters.
        pixel.single_scatter = pixel.single_scatter.max(Rgb::ZERO);
        pixel.multiple_scatter = pixel.multiple_scatter.max(Rgb::ZERO);
        if queries > 0 {
            pixel.photon_count /= queries as f64;
            pixel.kernel_radius /= queries as f64;
        }
        for (light, center) in peaks {
            pixel.single_scatter += self.peak(light, center, corner, random);
        }
        pixel
    }

    /// Single scattering of a light over a pixel that holds it, or is near it.
    fn peak(&mut self, light: usize, center: DVec2, corner: DVec2, random: &mut Random) -> Rgb {
        let within =
            (center - corner).cmpge(DVec2::ZERO).all() && (center - corner).cmplt(DVec2::ONE).all();
        let count = if within { PEAK_RAYS } else { SLOPE_RAYS };
        let strata = Strata::new(count as u64, &[1.0, 1.0]);
        let samples = self.scene.render.light_samples;
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
            sum += self.reader.single_scatter_of(&ray, light, samples, random) * sample.weight;
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
    }
}
