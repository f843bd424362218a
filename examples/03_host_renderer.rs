//! A host renderer that takes its fog from photonvdb.
//!
//! The host has surfaces of its own, here one opaque ball over a background. For every camera ray it asks for
//! the light of the fog in front of what it hit, and composites its own colour through the transmittance. The
//! photon map is built once and read by all threads. Photons know nothing of the host's surfaces: the ball
//! hides the fog behind it, but casts no shadow into it.
//!
//! ```sh
//! cargo run --release --example 03_host_renderer
//! ```

use std::path::Path;
use std::thread;

use photonvdb::film::{ExrOptions, Film, Pixel, RenderMetadata, write_exr, write_preview_png};
use photonvdb::math::{DVec3, Ray, Rgb, Stream, uniform};
use photonvdb::render::{LightReader, LitScene, Unobserved};
use photonvdb::scene::{Overrides, Scene};

const THREADS: usize = 4;
const RAYS_PER_PIXEL: usize = 4;

/// The host's world: a ball in front of a dim background.
struct Ball {
    center: DVec3,
    radius: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let size = Overrides { resolution: Some([256, 256]), k: Some(200), ..Overrides::default() };
    let scene = Scene::load_with(Path::new("examples/scenes/fog_spot.toml"), &size)?;
    let lit = LitScene::prepare(&scene, &Unobserved)?;
    println!("{} photons stored", lit.report().stored_count);
    print_fluence(lit.reader().as_mut());

    let ball = Ball { center: DVec3::new(-0.15, 0.0, 0.25), radius: 0.3 };
    let (width, height) = (scene.camera.width, scene.camera.height);
    let mut film = Film::new(width, height);
    // Each thread takes a band of rows, and a reader of its own.
    let band = height.div_ceil(THREADS) * width;
    thread::scope(|scope| {
        for (index, pixels) in film.pixels.chunks_mut(band).enumerate() {
            let (scene, lit, ball) = (&scene, &lit, &ball);
            scope.spawn(move || {
                let mut reader = lit.reader();
                for (offset, pixel) in pixels.iter_mut().enumerate() {
                    *pixel = shade(scene, reader.as_mut(), ball, index * band + offset);
                }
            });
        }
    });

    std::fs::create_dir_all("output")?;
    let (image, preview) =
        (Path::new("output/host_renderer.exr"), Path::new("output/host_renderer.png"));
    write_exr(image, &film, &ExrOptions::default(), &RenderMetadata::new())?;
    write_preview_png(preview, &film, None)?;
    println!("wrote {} and {}", image.display(), preview.display());
    Ok(())
}

/// Scattered fluence at places across the beam.
fn print_fluence(reader: &mut dyn LightReader) {
    for y in [-0.8, -0.4, 0.0, 0.4, 0.8] {
        let place = DVec3::new(0.0, y, 0.0);
        let estimate = reader.fluence(place);
        println!("fluence at {place}: {:.3} W/m^2 within {:.3} m", estimate.value, estimate.radius);
    }
}

/// One pixel: the fog in front of the host's surface, and that surface through the fog.
fn shade(scene: &Scene, reader: &mut dyn LightReader, ball: &Ball, index: usize) -> Pixel {
    let (x, y) = (index % scene.camera.width, index / scene.camera.width);
    let mut random = Stream::Pixel.random(scene.photons.seed, index as u64);
    let share = 1.0 / RAYS_PER_PIXEL as f64;
    let mut pixel = Pixel::default();
    for _ in 0..RAYS_PER_PIXEL {
        let ray =
            scene.camera.ray(x as f64 + uniform(&mut random), y as f64 + uniform(&mut random));
        let hit = ball.distance_along(&ray);
        let fog = reader.radiance(&ray, hit.unwrap_or(f64::INFINITY), &mut random);
        let behind = match hit {
            Some(distance) => ball.color(ray.at(distance)),
            None => Rgb::new(0.02, 0.03, 0.05),
        };
        pixel.single_scatter += fog.single_scatter * share;
        pixel.multiple_scatter += fog.multiple_scatter * share;
        pixel.emission += (fog.emission + fog.transmittance * behind) * share;
        // The ball is opaque: nothing of what the film is laid over shows through it.
        pixel.transmittance += if hit.is_some() { Rgb::ZERO } else { fog.transmittance * share };
    }
    pixel
}

impl Ball {
    /// Distance to the near side.
    fn distance_along(&self, ray: &Ray) -> Option<f64> {
        let to_center = self.center - ray.origin;
        let along = to_center.dot(ray.direction);
        let under_root = self.radius * self.radius - (to_center.length_squared() - along * along);
        (under_root >= 0.0).then(|| along - under_root.sqrt()).filter(|distance| *distance > 0.0)
    }

    /// The host's own shading: a light from above.
    fn color(&self, place: DVec3) -> Rgb {
        let normal = (place - self.center) / self.radius;
        Rgb::new(0.5, 0.1, 0.05) * (0.15 + 0.85 * (0.5 + 0.5 * normal.y))
    }
}
