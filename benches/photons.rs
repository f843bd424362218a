//! Trace, build and gather in a fog of optical depth 2; columns of shadows and rays through smoke; whole renders, of one pass and to an error of 5 %.
//!
//! `cargo bench --bench photons`

use std::num::NonZeroUsize;
use std::path::Path;

use divan::{Bencher, black_box, counter::ItemsCount};
use photonvdb::emission::{Emission, EmissionKind};
use photonvdb::lattice::{CameraDeposit, Cells, Deposit, LatticeShape};
use photonvdb::light::{Light, PointLight, Shadows};
use photonvdb::map::{Columns, NearestPhotons, PhotonMap};
use photonvdb::math::{DVec3, Ray, Rgb, Stream};
use photonvdb::medium::{Bounds, Extinction, Medium, MediumExtinction, Phase, UniformExtinction};
use photonvdb::render::{LitScene, RenderOptions, Unobserved, render};
use photonvdb::scene::{Overrides, Scene};
use photonvdb::trace::{MapFrame, TraceSettings, TracedPhotons, trace_into, trace_photons};

fn main() {
    divan::main();
}

const FOG: UniformExtinction = UniformExtinction { sigma_t: 1.0 };
const PHOTONS: u64 = 200_000;

fn medium() -> Medium {
    Medium {
        bounds: Bounds::Box { min: DVec3::NEG_ONE, max: DVec3::ONE },
        extinction: MediumExtinction::Uniform(FOG),
        albedo: Rgb::splat(0.9),
        color: None,
        emissivity: None,
        phase: Phase::Isotropic,
    }
}

const LIGHT: Light =
    Light::Point(PointLight { position: DVec3::new(0.3, 0.4, 0.2), intensity: Rgb::ONE });
const SETTINGS: TraceSettings =
    TraceSettings { max_order: 1000, min_stored_order: 1, max_stored: usize::MAX };

fn emission<'a>(lights: &'a [Light], medium: &'a Medium, kind: EmissionKind) -> Emission<'a> {
    let opacity = |ray: &Ray| {
        medium.bounds.intersect(ray).map_or(0.0, |span| FOG.opacity(ray, span, Rgb::ONE))
    };
    Emission::new(lights, medium, opacity, 1.0, kind, PHOTONS, 0)
}

fn trace(medium: &Medium, kind: EmissionKind) -> TracedPhotons {
    let frame = MapFrame::of(medium, None);
    trace_photons(&emission(&[LIGHT], medium, kind), medium, &FOG, frame, SETTINGS, |_| ())
}

#[divan::bench(args = [EmissionKind::Random, EmissionKind::Stratified, EmissionKind::Sobol])]
fn trace_fog(bencher: Bencher, kind: EmissionKind) {
    let medium = medium();
    bencher.counter(ItemsCount::new(PHOTONS)).bench_local(|| trace(&medium, kind).photons.len());
}

/// Flights into a lattice of 32^3 cells, which takes the place of the map.
#[divan::bench]
fn fill_lattice(bencher: Bencher) {
    let (medium, lights) = (medium(), [LIGHT]);
    let emission = emission(&lights, &medium, EmissionKind::Stratified);
    let Some(shape) = LatticeShape::new(&medium.bounds, 32) else { return };
    bencher.counter(ItemsCount::new(PHOTONS)).bench_local(|| {
        let empty = CameraDeposit::<_, f32>::new(&shape, &FOG, Phase::Isotropic, DVec3::Z);
        let (filled, _) = trace_into(&emission, &medium, &FOG, SETTINGS, vec![empty], |_| ());
        Cells::from_sums(&shape, filled.into_iter().map(Deposit::into_sums).collect()).at(DVec3::Z)
    });
}

#[divan::bench]
fn build_map(bencher: Bencher) {
    let medium = medium();
    let photons = trace(&medium, EmissionKind::Stratified).photons;
    let frame = MapFrame::of(&medium, None);
    bencher.counter(ItemsCount::new(photons.len())).bench_local(|| {
        PhotonMap::build(black_box(&photons), frame, Columns::default()).map(|map| map.len())
    });
}

/// Queries along neighbouring lines, as a camera makes them.
#[divan::bench(args = [10, 50, 200])]
fn gather_k(bencher: Bencher, k: usize) {
    let medium = medium();
    let photons = trace(&medium, EmissionKind::Stratified).photons;
    let frame = MapFrame::of(&medium, None);
    let Ok(map) = PhotonMap::build(&photons, frame, Columns::default()) else { return };
    let Some(k) = NonZeroUsize::new(k) else { return };
    let places: Vec<DVec3> = (0..32 * 64)
        .map(|i| {
            let (line, step) = (i / 64, i % 64);
            let across = |n: i32| f64::from(n) * 0.01 - 0.3;
            DVec3::new(across(line % 8), across(line / 8), f64::from(step) / 32.0 - 1.0)
        })
        .collect();
    let mut finder = NearestPhotons::new(&map);
    bencher.counter(ItemsCount::new(places.len())).bench_local(|| {
        places.iter().map(|&place| f64::from(finder.find(place, k, 10.0).radius)).sum::<f64>()
    });
}

fn load(path: &str, overrides: &Overrides) -> Option<Scene> {
    Scene::load_with(&Path::new(env!("CARGO_MANIFEST_DIR")).join(path), overrides).ok()
}

/// Optical depth towards the sun, in columns through smoke.
#[divan::bench(sample_count = 10)]
fn columns_of_shadows(bencher: Bencher) {
    let scene = load("examples/scenes/smoke_sun.toml", &Overrides::default());
    let Some(Scene { lights, medium, .. }) = &scene else { return };
    let MediumExtinction::Grid(grid) = &medium.extinction else { return };
    bencher
        .bench_local(|| Shadows::of(lights, medium, &**grid, 1 << 16).transmittance(0, DVec3::Y));
}

/// Rays through smoke: optical depth, single scattering, and estimates from the k nearest photons on the way.
#[divan::bench(sample_count = 10)]
fn march_rays(bencher: Bencher) {
    let overrides =
        Overrides { photons: Some(100_000), resolution: Some([64, 36]), ..Overrides::default() };
    let Some(scene) = load("examples/scenes/smoke_sun.toml", &overrides) else { return };
    let Ok(lit) = LitScene::prepare(&scene, &Unobserved) else { return };
    let mut reader = lit.reader();
    let mut random = Stream::Pixel.random(0, 0);
    bencher.counter(ItemsCount::new(64 * 36u32)).bench_local(|| {
        let rays = (0..64 * 36).map(|i| scene.camera.ray(f64::from(i % 64), f64::from(i / 64)));
        rays.map(|ray| reader.radiance(&ray, f64::INFINITY, &mut random).multiple_scatter)
            .sum::<Rgb>()
    });
}

/// Whole renders of example scenes at 64 x 36.
#[divan::bench(args = ["fog_point", "fog_spot", "smoke_sun"], sample_count = 10)]
fn render_scene(bencher: Bencher, name: &str) {
    let overrides =
        Overrides { photons: Some(100_000), resolution: Some([64, 36]), ..Overrides::default() };
    let Some(scene) = load(&format!("examples/scenes/{name}.toml"), &overrides) else { return };
    let options = RenderOptions::passes(1);
    bencher.bench_local(|| render(&scene, &options, &Unobserved).map(|made| made.film.width));
}

/// Whole renders at 128 x 128 until the estimated error is 5 %.
#[divan::bench(args = ["fog_point", "fog_spot", "smoke_sun"], sample_count = 10)]
fn render_to_error(bencher: Bencher, name: &str) {
    let path = format!("tests/scenes/{name}.toml");
    let Some(scene) = load(&path, &Overrides::default()) else { return };
    let options = RenderOptions { target_error: Some(0.05), ..RenderOptions::passes(1000) };
    bencher.bench_local(|| render(&scene, &options, &Unobserved).map(|made| made.film.width));
}
