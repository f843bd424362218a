use photonvdb::{film::*, render::*, scene::*};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let t = std::time::Instant::now();
    let mut scene = Scene::load(a[1].as_ref()).unwrap_or_else(|e| {
        eprintln!("{e}");
        std::process::exit(2)
    });
    for kv in &a[3..] {
        let (k, v) = kv.split_once('=').unwrap();
        match k {
            "n" => scene.photons.count = v.parse::<f64>().unwrap() as u64,
            "k" => scene.estimate.k = v.parse().unwrap(),
            "spp" => scene.render.samples_per_pixel = v.parse().unwrap(),
            "march" => scene.render.march_samples = v.parse().unwrap(),
            "light" => scene.render.light_samples = v.parse().unwrap(),
            "only" => scene.render.photons_only = v == "1",
            "seed" => scene.photons.seed = v.parse().unwrap(),
            "r" => scene.estimate.max_radius = Some(v.parse().unwrap()),
            "em" => {
                scene.photons.emission = match v {
                    "random" => photonvdb::emission::EmissionKind::Random,
                    "sobol" => photonvdb::emission::EmissionKind::Sobol,
                    _ => photonvdb::emission::EmissionKind::Stratified,
                }
            }
            _ => panic!(),
        }
    }
    let load = t.elapsed().as_secs_f64();
    let r = render(&scene, &RenderOptions { passes: 1 }, &Unobserved).unwrap();
    let s = r.report.seconds;
    println!(
        "load {load:.3} trace {:.3} build {:.3} gather {:.3}; emitted {} stored {} bytes/photon {}",
        s.trace,
        s.build,
        s.gather,
        r.report.emitted_count,
        r.report.stored_count,
        r.report.bytes_per_photon
    );
    let b = r.report.power;
    println!(
        "balance {:?} rel {:e}",
        b,
        ((b.emitted - b.absorbed - b.escaped - b.truncated - b.resampled) / b.emitted)
            .abs()
            .max_element()
    );
    let n = r.film.pixels.len() as f64;
    let mean = |f: &dyn Fn(&Pixel) -> photonvdb::math::Rgb| {
        r.film.pixels.iter().map(f).sum::<photonvdb::math::Rgb>() / n
    };
    println!(
        "single {} multiple {} emission {} T {}",
        mean(&|p| p.single_scatter),
        mean(&|p| p.multiple_scatter),
        mean(&|p| p.emission),
        mean(&|p| p.transmittance)
    );
    println!(
        "radius {:.4} count {:.1}",
        r.film.pixels.iter().map(|p| p.kernel_radius).sum::<f64>() / n,
        r.film.pixels.iter().map(|p| p.photon_count).sum::<f64>() / n
    );
    if let Ok(reference) = read_rgb(a[1].replace(".toml", ".exr").as_ref()) {
        println!("{:?}", compare(&RgbImage::from(&r.film), &reference));
    }
    write_preview_png(a[2].as_ref(), &r.film, None).unwrap();
}
