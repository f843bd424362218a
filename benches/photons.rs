//! Trace, build and gather in a fog of optical depth 2, and whole small renders.
//!
//! `cargo bench --bench photons`

use std::num::NonZeroUsize;
use std::path::Path;

use divan::{Bencher, black_box, counter::ItemsCount};
use photonvdb::emission::{Emission, EmissionKind};
use photonvdb::light::{Light, PointLight};
use photonvdb::map::{Columns, NearestPhotons, PhotonMap};
use photonvdb::math::{DVec3, Ray, Rgb};
use photonvdb::medium::{Bounds, Extinction, Medium, MediumExtinction, Phase, UniformExtinction};
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::{Overrides, Scene};
use photonvdb::trace::{MapFrame, TraceSettings, TracedPhotons, trace_photons};

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

fn trace(medium: &Medium, kind: EmissionKind) -> TracedPhotons {
    let lights =
        [Light::Point(PointLight { position: DVec3::new(0.3, 0.4, 0.2), intensity: Rgb::ONE })];
    let opacity = |ray: &Ray| {
        medium.bounds.intersect(ray).map_or(0.0, |span| FOG.opacity(ray, span, Rgb::ONE))
    };
    let emission = Emission::new(&lights, medium, opacity, 1.0, kind, PHOTONS, 0);
    let settings = TraceSettings { max_order: 1000, min_stored_order: 1, max_stored: usize::MAX };
    trace_photons(&emission, medium, &FOG, MapFrame::of(medium, None), settings, |_| ())
}

#[divan::bench(args = [EmissionKind::Random, EmissionKind::Stratified, EmissionKind::Sobol])]
fn trace_fog(bencher: Bencher, kind: EmissionKind) {
    let medium = medium();
    bencher.counter(ItemsCount::new(PHOTONS)).bench_local(|| trace(&medium, kind).photons.len());
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

/// Whole renders of example scenes at 64 x 36.
#[divan::bench(args = ["fog_point", "fog_spot", "smoke_sun"], sample_count = 10)]
fn render_scene(bencher: Bencher, name: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/scenes/{name}.toml"));
    let overrides =
        Overrides { photons: Some(100_000), resolution: Some([64, 36]), ..Overrides::default() };
    let Ok(scene) = Scene::load_with(&path, &overrides) else { return };
    let options = RenderOptions::passes(1);
    bencher.bench_local(|| render(&scene, &options, &Unobserved).map(|made| made.film.width));
}
