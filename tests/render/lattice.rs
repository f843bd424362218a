//! Light gathered in a lattice: against the path tracer, which has no lattice, and against itself on other threads.

use std::path::{Path, PathBuf};

use photonvdb::film::{Film, compare, read_rgb};
use photonvdb::math::mean_channel;
use photonvdb::reference::{Limits, Unwatched, render_reference};
use photonvdb::render::{Gather, RenderOptions, Unobserved, render};
use photonvdb::scene::{Overrides, Scene};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf()
}

fn scene(name: &str, text: &str, overrides: &Overrides) -> Scene {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(format!("{name}.toml"));
    let media = root().join("media");
    std::fs::write(&path, text.replace("MEDIA", media.to_str().unwrap())).unwrap();
    Scene::load_with(&path, overrides).unwrap()
}

const CAMERA: &str = "[camera]\nposition = [1.1, 0.9, 2.6]\nlook_at = [0.0, 0.0, 0.0]\nvertical_fov = 42.0\nresolution = [16, 12]\n";

const POINT: &str = "[[light]]\nkind = \"point\"\nposition = [0.3, 0.4, -0.2]\nintensity = 1.0\n";

const SUN: &str = "[[light]]\nkind = \"directional\"\ndirection = [0.5, -1.0, -0.3]\nirradiance = [3.0, 2.5, 2.0]\n";

const SKY: &str = "[[light]]\nkind = \"environment\"\nradiance = [0.2, 0.3, 0.5]\n";

/// Scenes with every kind of medium, of bounds and of phase function.
fn scenes() -> Vec<(&'static str, String)> {
    let boxed = "bounds = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }";
    let fog = |rest: &str| format!("{CAMERA}[medium]\nkind = \"homogeneous\"\n{rest}\n");
    let smoke = |rest: &str| {
        let place = "transform = { translate = [0.0, -0.6, 0.0] }";
        format!(
            "{CAMERA}[medium]\nkind = \"vdb\"\nfile = \"MEDIA/smoke_plume.vdb\"\n{place}\n{rest}\n"
        )
    };
    vec![
        ("box", fog(&format!("{boxed}\nsigma_t = 1.5\nalbedo = 0.9\n{POINT}"))),
        (
            "ball",
            fog(&format!(
                "bounds = {{ center = [0.0, 0.1, 0.0], radius = 0.9 }}\nsigma_t = 3.0\nalbedo = [0.9, 0.8, 0.6]\n{SUN}"
            )),
        ),
        ("chromatic", fog(&format!("{boxed}\nsigma_t = [0.3, 1.0, 3.0]\nalbedo = 0.9\n{POINT}"))),
        (
            "forward",
            fog(&format!(
                "{boxed}\nsigma_t = 2.0\nalbedo = 0.95\nphase = {{ kind = \"henyey-greenstein\", g = 0.6 }}\n{SKY}"
            )),
        ),
        (
            "smoke in fog",
            smoke(&format!(
                "density_scale = 8.0\nalbedo = 0.8\n{}\n{SUN}{SKY}",
                fog(&format!("{boxed}\nsigma_t = 0.4\nalbedo = 0.95"))
                    .replace(CAMERA, "")
                    .replace("[medium]", "[[medium]]")
            ))
            .replace("\n[medium]", "\n[[medium]]"),
        ),
        (
            "smoke",
            smoke(&format!(
                "density_scale = 8.0\nalbedo = 0.8\nphase = {{ kind = \"henyey-greenstein\", g = 0.3 }}\n{SUN}{SKY}"
            )),
        ),
    ]
}

fn mean(film: &Film) -> f64 {
    let sum: f64 = film.pixels.iter().map(|pixel| mean_channel(pixel.radiance())).sum();
    sum / film.pixels.len() as f64
}

/// Means of images over 16 independent renders against those over 512 paths a pixel. `allowed` is the share that they may be off by.
fn assert_agrees(name: &str, text: &str, gather: &str, allowed: f64) {
    let batches: Vec<f64> = (0..16)
        .map(|seed| {
            let overrides = Overrides {
                photons: Some(16384),
                seed: Some(seed),
                gather: Some(gather.into()),
                bounces: (gather == "bounce").then_some(2),
                samples_per_pixel: (gather == "bounce").then_some(64),
                ..Overrides::default()
            };
            let scene = scene(name, text, &overrides);
            mean(&render(&scene, &RenderOptions::passes(1), &Unobserved).unwrap().film)
        })
        .collect();
    let found = batches.iter().sum::<f64>() / 16.0;
    let squares = batches.iter().map(|batch| (batch - found).powi(2)).sum::<f64>();
    let limits = Limits { samples: Some(512), ..Limits::default() };
    let scene = scene(name, text, &Overrides::default());
    let reference = render_reference(&scene, &limits, &Unwatched).unwrap();
    let pixels = reference.film.pixels.len() as f64;
    let variance: f64 =
        reference.film.pixels.iter().map(|pixel| pixel.variance.max_element()).sum();
    let error = (squares / 15.0 / 16.0 + variance / (pixels * pixels)).sqrt();
    let difference = (found - reference.mean).abs();
    let allowed = 4.5 * error + allowed * reference.mean;
    assert!(difference < allowed, "{name}, {gather}: {found} for {} +- {error}", reference.mean);
    assert!(error < 0.02 * reference.mean, "{name}: a test that tells something: {error}");
}

/// Cells of finite size may be off by 1 %.
#[test]
fn images_agree_with_paths() {
    for (name, text) in scenes() {
        assert_agrees(name, &text, "lattice", 0.01);
    }
}

/// After two bounces little is left of what cells are off by: also where light comes from all around, from an area or in a medium that scatters forward.
#[test]
fn bounced_paths_agree_with_paths() {
    let lit = format!(
        "{CAMERA}[medium]\nkind = \"homogeneous\"\nbounds = {{ min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }}\nsigma_t = 8.0\nalbedo = 0.98\n"
    );
    let quad = "[[light]]\nkind = \"quad\"\ncorner = [-0.5, 1.5, -0.5]\nedge_u = [1.0, 0.0, 0.0]\nedge_v = [0.0, 0.0, 1.0]\nradiance = 2.0\n";
    let dense = [
        ("dense, sun", format!("{lit}{SUN}")),
        ("dense, sky and quad", format!("{lit}{SKY}{quad}")),
    ];
    for (name, text) in scenes().into_iter().chain(dense) {
        assert_agrees(name, &text, "bounce", 0.005);
    }
}

#[test]
fn any_number_of_threads_gives_the_same_pixels() {
    for ((name, text), bounces) in
        scenes().into_iter().flat_map(|scene| [(scene.clone(), false), (scene, true)])
    {
        let gather = bounces.then(|| "bounce".to_string());
        let overrides = Overrides { photons: Some(20_000), gather, ..Overrides::default() };
        let scene = scene(name, &text, &overrides);
        assert_eq!(scene.render.gather, if bounces { Gather::Bounce } else { Gather::Lattice });
        let films: Vec<Film> = [1, 2, 7]
            .into_iter()
            .map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let render =
                    || render(&scene, &RenderOptions::passes(2), &Unobserved).unwrap().film;
                pool.install(render)
            })
            .collect();
        assert_eq!(films[0], films[1], "{name}");
        assert_eq!(films[0], films[2], "{name}");
    }
}

/// What passes say of their error is right within a factor of 1.5, against images of a light tracer.
#[test]
fn estimated_errors_are_those_against_references() {
    for name in ["fog_point", "fog_spot", "smoke_sun"] {
        let path = |extension: &str| root().join(format!("tests/scenes/{name}.{extension}"));
        let scene = Scene::load(&path("toml")).unwrap();
        let noise: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(path("ref.json")).unwrap()).unwrap();
        let noise = noise["reference_relrmse_noise"].as_f64().unwrap();
        let options = RenderOptions { target_error: Some(0.1), ..RenderOptions::passes(1000) };
        let made = render(&scene, &options, &Unobserved).unwrap();
        let estimated = made.report.error.unwrap().total();
        assert!(estimated <= 0.1 && made.report.passes_done >= 3, "{name}: {estimated}");
        let reference = read_rgb(&path("exr")).unwrap();
        let image = photonvdb::film::RgbImage::from(&made.film);
        let measured = compare(&image, &reference).unwrap().rel_rmse;
        let ratio = (measured * measured - noise * noise).max(0.0).sqrt() / estimated;
        assert!((1.0 / 1.5..1.5).contains(&ratio), "{name}: {measured} for {estimated}");
    }
}

/// Where light is scattered many times faces are bright within less than a cell: paths are bounced, and what the image says of its error, filter
/// and all, is right. The reference is made here, of noise far below.
#[test]
fn dense_fog_is_bounced_and_knows_its_error() {
    let text = format!(
        "{CAMERA}[medium]\nkind = \"homogeneous\"\nbounds = {{ min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }}\nsigma_t = 10.0\nalbedo = 0.95\n{SUN}"
    );
    let sizes = Overrides { resolution: Some([48, 36]), ..Overrides::default() };
    let scene = scene("dense", &text, &sizes);
    assert_eq!(scene.render.gather, Gather::Bounce);
    let limits = Limits { samples: Some(4096), ..Limits::default() };
    let reference = render_reference(&scene, &limits, &Unwatched).unwrap();
    let noise = reference.progress.relative_error;
    let options = RenderOptions { target_error: Some(0.08), ..RenderOptions::passes(1000) };
    let made = render(&scene, &options, &Unobserved).unwrap();
    let image = photonvdb::film::RgbImage::from(&made.film);
    let truth = photonvdb::film::RgbImage::from(&reference.film);
    let measured = compare(&image, &truth).unwrap().rel_rmse;
    let estimated = made.report.error.unwrap().total();
    assert!(estimated <= 0.08 && noise < 0.03, "{estimated} {noise}");
    assert!(made.report.filter_radius > 0, "{:?}", made.report);
    let ratio = (measured * measured - noise * noise).max(0.0).sqrt() / estimated;
    assert!((1.0 / 1.5..1.5).contains(&ratio), "{measured} for {estimated}, reference {noise}");
}

/// With a limit of time alone the image is the best of that time, and it has an error to tell.
#[test]
fn time_budgets_end_renders() {
    let path = root().join("tests/scenes/fog_point.toml");
    let small = Overrides { resolution: Some([24, 24]), ..Overrides::default() };
    let scene = Scene::load_with(&path, &small).unwrap();
    let options = RenderOptions { seconds: Some(1.0), ..RenderOptions::passes(u32::MAX) };
    let made = render(&scene, &options, &Unobserved).unwrap();
    assert!(made.report.passes_done >= 2, "{:?}", made.report);
    assert!(made.report.error.is_some_and(|error| error.noise > 0.0));
}
