//! A dozen small images against goldens of the path tracer (`tests/goldens`), by metric: what moves any of them shows here.
//!
//! `PHOTONVDB_REMAKE_GOLDENS=1` makes them anew, with the tolerances and docs/GOLDENS.md.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use exr::prelude::write_rgb_file;
use photonvdb::film::{Film, ImageError, RgbImage, compare, read_rgb, write_preview_png};
use photonvdb::math::Rgb;
use photonvdb::reference::{Limits, Reference, Unwatched, render_reference};
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::Scene;
use serde::{Deserialize, Serialize};

const REMAKE: &str = "PHOTONVDB_REMAKE_GOLDENS";

/// Scenes in the order of the page.
const NAMES: [&str; 13] = [
    "fog_point",
    "fog_spot",
    "fog_sun",
    "smoke_sun",
    "cloud",
    "dense",
    "fire",
    "rgb_fog",
    "colour_smoke",
    "sky",
    "quad",
    "sphere",
    "inside",
];

/// Paths a pixel of a golden, unless it is good to `GOLDEN_ERROR` before.
const GOLDEN_SAMPLES: u64 = 1024;
const GOLDEN_ERROR: f64 = 0.004;

/// Seeds of the photon maps that tolerances are measured from; the test takes others.
const MEASURED_SEEDS: std::ops::Range<u64> = 100..108;

/// Paths a pixel of the test.
const TEST_SAMPLES: u64 = 8;

/// What was measured when a golden was made.
#[derive(Deserialize, Serialize)]
struct Measured {
    name: String,
    /// Paths a pixel.
    samples: u64,
    /// Noise of its pixels over its mean.
    noise: f64,
    /// Standard error of the mean of all pixels, by channel \[W/(m^2 sr)\].
    mean_error: [f64; 3],
    /// Photon maps: root-mean-square difference from the golden over its mean, and its spread over seeds.
    rel_rmse: f64,
    rel_rmse_spread: f64,
    /// Photon maps: mean over that of the golden, and its spread over seeds.
    mean_ratio: f64,
    mean_ratio_spread: f64,
}

fn root() -> PathBuf {
    env!("CARGO_MANIFEST_DIR").into()
}

fn golden(name: &str, ending: &str) -> PathBuf {
    root().join("tests/goldens").join(format!("{name}.{ending}"))
}

fn scene(name: &str, seed: u64) -> Scene {
    let mut scene = Scene::load(&golden(name, "toml")).unwrap();
    scene.photons.seed = seed;
    scene
}

fn by_paths(scene: &Scene, limits: &Limits) -> Reference {
    render_reference(scene, limits, &Unwatched).unwrap()
}

fn by_photons(scene: &Scene) -> Film {
    render(scene, &RenderOptions::passes(1), &Unobserved).unwrap().film
}

fn mean_error(film: &Film) -> Rgb {
    let variance: Rgb = film.pixels.iter().map(|pixel| pixel.variance).sum();
    variance.map(f64::sqrt) / film.pixels.len() as f64
}

fn mean(pixels: &[[f32; 3]]) -> Rgb {
    let sum: Rgb = pixels.iter().map(|pixel| glam::Vec3::from_array(*pixel).as_dvec3()).sum();
    sum / pixels.len() as f64
}

#[test]
fn images_are_like_their_goldens() {
    if std::env::var_os(REMAKE).is_some() {
        remake();
    }
    let text = std::fs::read_to_string(golden("goldens", "json")).unwrap();
    let all: Vec<Measured> = serde_json::from_str(&text).unwrap();
    assert_eq!(all.iter().map(|measured| measured.name.as_str()).collect::<Vec<_>>(), NAMES);
    for measured in &all {
        let truth = read_rgb(&golden(&measured.name, "exr")).unwrap();
        let scene = scene(&measured.name, 7);
        check_photons(measured, compare(&(&by_photons(&scene)).into(), &truth).unwrap());
        let limits = Limits { samples: Some(TEST_SAMPLES), ..Limits::default() };
        check_paths(measured, &by_paths(&scene, &limits).film, &truth);
    }
}

/// Six spreads, and a tenth of the error for what eight seeds do not tell of rare pixels.
fn check_photons(measured: &Measured, found: ImageError) {
    let Measured { name, rel_rmse, mean_ratio, .. } = measured;
    println!("{name}: photons {found:?}, measured {rel_rmse:.4}, {mean_ratio:.4}");
    let tolerance = 6.0 * measured.rel_rmse_spread + 0.1 * rel_rmse;
    assert!(found.rel_rmse < rel_rmse + tolerance, "{name}: {found:?}");
    let tolerance = 6.0 * measured.mean_ratio_spread;
    assert!((found.mean_ratio - mean_ratio).abs() < tolerance, "{name}: {found:?}");
}

/// The mean within the noise of both.
fn check_paths(measured: &Measured, found: &Film, truth: &RgbImage) {
    let difference = mean(&RgbImage::from(found).pixels) - mean(&truth.pixels);
    let golden_error = Rgb::from_array(measured.mean_error);
    let error = mean_error(found);
    for channel in 0..3 {
        let error = error[channel].hypot(golden_error[channel]);
        let z = difference[channel] / error.max(1e-300);
        println!("{}: paths, channel {channel}: z {z:+.2}", measured.name);
        assert!(z.abs() < 4.5, "{}: z {z}", measured.name);
    }
}

fn remake() {
    let all: Vec<Measured> = NAMES.iter().map(|name| remake_one(name)).collect();
    std::fs::write(golden("goldens", "json"), serde_json::to_string_pretty(&all).unwrap() + "\n")
        .unwrap();
    std::fs::write(root().join("docs/GOLDENS.md"), page(&all)).unwrap();
}

fn remake_one(name: &str) -> Measured {
    let limits = Limits {
        samples: Some(GOLDEN_SAMPLES),
        relative_error: Some(GOLDEN_ERROR),
        ..Limits::default()
    };
    let Reference { film, progress, .. } = by_paths(&scene(name, 0), &limits);
    let truth = RgbImage::from(&film);
    let pixel = |x: usize, y: usize| <(f32, f32, f32)>::from(truth.pixels[y * truth.width + x]);
    write_rgb_file(golden(name, "exr"), truth.width, truth.height, pixel).unwrap();
    write_preview_png(&picture(name), &film, None).unwrap();
    let errors: Vec<ImageError> = MEASURED_SEEDS
        .map(|seed| compare(&(&by_photons(&scene(name, seed))).into(), &truth).unwrap())
        .collect();
    let [rel_rmse, rel_rmse_spread] = mean_and_spread(errors.iter().map(|error| error.rel_rmse));
    let [mean_ratio, mean_ratio_spread] =
        mean_and_spread(errors.iter().map(|error| error.mean_ratio));
    println!("{name}: {progress:?}, photons {rel_rmse:.4}, {mean_ratio:.4}");
    Measured {
        name: name.to_owned(),
        samples: progress.samples,
        noise: progress.relative_error,
        mean_error: mean_error(&film).to_array(),
        rel_rmse,
        rel_rmse_spread,
        mean_ratio,
        mean_ratio_spread,
    }
}

fn mean_and_spread(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
    [mean, (squares / (count - 1.0)).sqrt()]
}

fn picture(name: &str) -> PathBuf {
    root().join("docs/goldens").join(format!("{name}.png"))
}

/// The first line of a scene file says what it shows.
fn title(scene: &Path) -> String {
    let text = std::fs::read_to_string(scene).unwrap();
    text.lines().next().unwrap().trim_start_matches("# ").to_owned()
}

fn page(all: &[Measured]) -> String {
    let mut page = String::from(
        "# Goldens\n\n\
         Images of 64 x 36 pixels by the path tracer (`photonvdb reference`), which has no bias. `tests/goldens.rs` compares the photon \
         mapper and the path tracer of today with them; `PHOTONVDB_REMAKE_GOLDENS=1 cargo test --test goldens` makes them, and this \
         page, anew.\n\n\
         *Noise* is that of a golden's pixel, over the image's mean. *Difference* is that of the photon mapper with 30 000 photons, k = 50, one \
         pass: root of the mean squared difference of the pixels, over the mean, its spread over eight seeds, and the ratio of the means. Where a light is \
         seen in the fog, one pixel of hundreds of times the mean decides both.\n\n\
         | golden | scene | paths a pixel | noise | difference | mean |\n|---|---|---|---|---|---|\n",
    );
    for measured in all {
        let Measured { name, samples, noise, rel_rmse, rel_rmse_spread, mean_ratio, .. } = measured;
        let title = title(&golden(name, "toml"));
        writeln!(
            page,
            "| <img src=\"goldens/{name}.png\" alt=\"{name}\" width=\"256\"> | [`{name}`](../tests/goldens/{name}.toml): {title} \
             | {samples} | {:.2} % | {:.1} ± {:.1} % | {mean_ratio:.4} |",
            100.0 * noise,
            100.0 * rel_rmse,
            100.0 * rel_rmse_spread,
        )
        .unwrap();
    }
    page
}
