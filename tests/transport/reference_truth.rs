//! The path tracer against exact answers: airlight, glowing balls of all orders, furnaces, its own variance.

use crate::grid_support::cloud;
use crate::transport_support::*;
use photonvdb::light::{Environment, EnvironmentImage, Light, QuadLight, SphereLight};
use photonvdb::math::{DAffine3, DVec3, Ray, Rgb, Stream, uniform};
use photonvdb::medium::vdb::Limits as VolumeLimits;
use photonvdb::medium::{Bounds, Emissivity, Flame, Medium, Phase, ValueGrid, blackbody_radiance};
use photonvdb::reference::{
    Limits, PathLight, Reference, ReferenceError, Unwatched, path_light, render_reference,
};
use photonvdb::scene::Scene;

/// A figure of the paths along a ray, from runs of `paths` each.
fn along(scene: &Scene, ray: &Ray, paths: u64, figure: impl Fn(&PathLight) -> f64) -> Runs {
    Runs::of((0..RUNS).map(|run| {
        let mut random = Stream::Experiment.random(run, 3);
        let one = |_| figure(&path_light(scene, ray, &mut random).unwrap());
        (0..paths).map(one).sum::<f64>() / paths as f64
    }))
}

fn vector(row: &serde_json::Value, key: &str) -> DVec3 {
    DVec3::from_slice(&numbers(row, key))
}

/// All 15 rays, within noise of a few percent at most. A ray that ends does so on a ball's surface.
#[test]
fn airlight_of_a_point_light() {
    for row in truth("airlight.json").as_array().unwrap() {
        let name = row["name"].as_str().unwrap();
        let sigma_t = number(row, "sigma_t");
        let bounds = match (row["medium"].as_str().unwrap(), row["tmax"].as_f64()) {
            ("infinite", Some(end)) => ball(end),
            ("infinite", None) => Bounds::Infinite,
            _ => CUBE,
        };
        let medium = grey_fog(bounds, sigma_t, number(row, "albedo"), number(row, "g"));
        let scene = scene(medium, one_watt(vector(row, "light")), 1);
        let ray = Ray::new(vector(row, "origin"), vector(row, "dir_unnormalised").normalize());
        let found = along(&scene, &ray, 500, |seen| seen.single_scatter.x);
        let exact = number(row, "L");
        // In the thinnest media one path in a million collides, and brings a millionth of the light.
        found.assert_within(exact, 2e-6 * exact, name);
        // Of a sharp lobe only the few paths tell that meet it.
        let noise = if number(row, "g").abs() > 0.9 { 0.15 } else { 0.05 };
        assert!(found.error < noise * exact, "{name}: {found:?}");
    }
}

/// Every order, from outside and grazing.
#[test]
fn glowing_balls() {
    for row in truth("glow.json").as_array().unwrap() {
        let (albedo, radius) = (number(row, "albedo"), number(row, "R"));
        let scene = scene(grey_fog(ball(radius), 1.0, albedo, 0.0), one_watt(DVec3::ZERO), 1);
        for (impact, exact) in numbers(row, "b_over_R").into_iter().zip(numbers(row, "L")) {
            let ray = Ray::new(DVec3::new(impact * radius, 0.0, -9.0), DVec3::Z);
            let found = along(&scene, &ray, 150, |seen| seen.radiance().x);
            let what = format!("albedo {albedo}, radius {radius}, b/R {impact}");
            found.assert_is(exact, &what);
            assert!(found.error < 0.15 * exact, "{what}: {found:?}");
        }
    }
}

/// Every order, and the first alone, in a medium without end.
#[test]
fn glow_in_a_medium_without_end() {
    for row in truth("glow_infinite.json").as_array().unwrap() {
        let albedo = number(row, "albedo");
        let (distance, impact) = (number(row, "camera_distance"), number(row, "impact"));
        let scene = scene(grey_fog(Bounds::Infinite, 1.0, albedo, 0.0), one_watt(DVec3::ZERO), 1);
        let start = (distance * distance - impact * impact).sqrt();
        let ray = Ray::new(DVec3::new(impact, 0.0, -start), DVec3::Z);
        let what = format!("albedo {albedo}, from {distance}, impact {impact}");
        let paths = if albedo < 0.95 { 200 } else { 30 };
        let found = along(&scene, &ray, paths, |seen| seen.radiance().x);
        found.assert_is(number(row, "L_total"), &what);
        let single = along(&scene, &ray, paths, |seen| seen.single_scatter.x);
        single.assert_is(number(row, "L_single"), &format!("{what}, single"));
        // From ten mean free paths away few paths come near the light.
        assert!(distance > 5.0 || found.error < 0.15 * found.mean, "{what}: {found:?}");
    }
}

fn smooth_cloud(g: f64) -> Medium {
    let place = DAffine3::from_scale(DVec3::splat(0.1));
    grid_medium(cloud(10).extinction(place, 6.0), DVec3::ONE, g)
}

fn smoke(g: f64) -> Medium {
    let medium = Scene::load(&tests().join("scenes/smoke_sun.toml")).unwrap().medium;
    Medium { albedo: DVec3::ONE, phase: Phase::HenyeyGreenstein { g }, ..medium }
}

/// Rays through the middle of a medium, another for each path.
fn seen_through_the_middle(scene: &Scene, paths: u64, figure: impl Fn(&PathLight) -> f64) -> Runs {
    let middle = scene.medium.bounds.enclosing_ball().unwrap();
    Runs::of((0..RUNS).map(|run| {
        let mut random = Stream::Experiment.random(run, 5);
        let mut sum = 0.0;
        for _ in 0..paths {
            let impact = 0.6 * middle.radius * uniform(&mut random).sqrt();
            let ray = passing_ray(middle.center, impact, 3.0 * middle.radius, &mut random);
            sum += figure(&path_light(scene, &ray, &mut random).unwrap());
        }
        sum / paths as f64
    }))
}

/// Radiance 1 from all sides and no absorption: radiance 1 along every ray.
#[test]
fn white_furnaces() {
    let sky = || {
        let image = EnvironmentImage::new(8, 4, vec![[1.0; 3]; 32], 0.3);
        Light::Environment(Environment::Image(Box::new(image)))
    };
    type White = fn(f64) -> Medium;
    let media: [(&str, White); 4] = [
        ("box", |g| grey_fog(CUBE, 2.0, 1.0, g)),
        ("ball", |g| grey_fog(ball(1.0), 5.0, 1.0, g)),
        ("cloud", smooth_cloud),
        ("smoke", smoke),
    ];
    for (name, medium) in media {
        for g in [-0.5, 0.0, 0.85] {
            let light = if g == 0.0 { sky() } else { white_sky() };
            let scene = scene(medium(g), light, 1);
            let found = seen_through_the_middle(&scene, 400, |seen| seen.radiance().x);
            // Paths tell of the sky where they leave: of those that cross the ball at once, 5e-5 of all, there may be none.
            found.assert_within(1.0, 3e-4, &format!("{name}, g {g}"));
            assert!(found.error < 0.01, "{name}, g {g}: {found:?}");
        }
    }
}

/// A furnace that glows: as hot as the sky around it, nothing of it is seen, whatever its albedo and extinction.
#[test]
fn a_medium_as_hot_as_its_surroundings_is_invisible() {
    let kelvin = 1600.0;
    let everywhere = {
        let mut voxels = crate::grid_support::Voxels { background: kelvin, ..Default::default() };
        voxels.set([0; 3], kelvin);
        let place = DAffine3::from_scale(DVec3::splat(0.1));
        ValueGrid::new(&voxels.sparse(), place, &VolumeLimits::default()).unwrap().unwrap()
    };
    let sky = blackbody_radiance(f64::from(kelvin));
    let mut hot =
        scene(fog(CUBE, Rgb::new(0.5, 1.0, 3.0), Rgb::new(0.9, 0.5, 0.0), 0.3), white_sky(), 1);
    hot.lights = vec![Light::Environment(Environment::Constant(sky))];
    hot.medium = hot.medium.with_emissivity(Emissivity::new(Some(everywhere), None, 1.0));
    for channel in 0..2 {
        let found =
            seen_through_the_middle(&hot, 400, |seen| seen.radiance()[channel] / sky[channel]);
        found.assert_is(1.0, &format!("channel {channel}"));
    }
}

/// Flames of emissivity 1 that nothing attenuates: the length of the ray through them.
#[test]
fn flames_add_up_along_the_ray() {
    let mut voxels = crate::grid_support::Voxels { background: 1.0, ..Default::default() };
    voxels.set([0; 3], 1.0);
    let place = DAffine3::from_scale(DVec3::splat(0.1));
    let grid = ValueGrid::new(&voxels.sparse(), place, &VolumeLimits::default()).unwrap().unwrap();
    let flame = Flame { grid, color: Rgb::new(1.0, 0.5, 0.0) };
    let mut burning = scene(grey_fog(CUBE, 0.0, 0.0, 0.0), white_sky(), 1);
    burning.lights.clear();
    burning.medium = burning.medium.with_emissivity(Emissivity::new(None, Some(flame), 1.0));
    let ray = Ray::new(DVec3::new(0.2, 0.3, -4.0), DVec3::Z);
    let mut random = Stream::Experiment.random(0, 0);
    let seen = path_light(&burning, &ray, &mut random).unwrap();
    assert!((seen.emission - Rgb::new(2.0, 1.0, 0.0)).abs().max_element() < 1e-12, "{seen:?}");
    assert_eq!(seen.transmittance, Rgb::ONE);
}

fn image(scene: &Scene, samples: u64) -> Reference {
    let limits = Limits { samples: Some(samples), ..Limits::default() };
    render_reference(scene, &limits, &Unwatched).unwrap()
}

/// A scene with all kinds of light, small enough to be rendered often.
fn all_lights() -> Scene {
    let mut scene = Scene::load(&tests().join("scenes/smoke_sun.toml")).unwrap();
    let center = scene.medium.bounds.enclosing_ball().unwrap().center;
    scene.lights.push(one_watt(center + DVec3::new(0.1, 0.2, 0.05)));
    scene.lights.push(white_sky());
    scene.lights.push(Light::Quad(QuadLight {
        corner: center + DVec3::new(-0.5, 0.0, 1.2),
        edge_u: DVec3::X,
        edge_v: DVec3::NEG_Y,
        radiance: Rgb::splat(2.0),
        is_visible: true,
    }));
    let radius = 0.1;
    let center = center - 0.3 * DVec3::Z;
    scene.lights.push(Light::Sphere(SphereLight {
        center,
        radius,
        radiance: Rgb::splat(4.0),
        is_visible: true,
    }));
    let size = [24, 24];
    let from = DVec3::new(0.8, -4.2, 0.6);
    let camera =
        photonvdb::camera::Camera::look_at(from, DVec3::new(0.1, 0.0, 0.0), DVec3::Z, 0.5, size);
    scene.camera = camera.unwrap();
    scene
}

/// The spread of 32 independent images, pixel by pixel, is what their variance layers say.
#[test]
fn the_variance_layer_is_the_spread_of_images() {
    let mut scene = all_lights();
    let images: Vec<Reference> = (0..RUNS)
        .map(|seed| {
            scene.photons.seed = seed;
            image(&scene, 8)
        })
        .collect();
    let count = images.len() as f64;
    let differences = (0..images[0].film.pixels.len()).map(|index| {
        let pixels = images.iter().map(|image| image.film.pixels[index]);
        let mean = pixels.clone().map(|pixel| pixel.radiance()).sum::<Rgb>() / count;
        let spread: Rgb = pixels.clone().map(|pixel| (pixel.radiance() - mean).powf(2.0)).sum();
        let claimed: Rgb = pixels.map(|pixel| pixel.variance).sum();
        // Relative to the pixel, so that no bright one decides alone.
        let scale = claimed.x / count;
        if scale > 0.0 { (spread.x / (count - 1.0) - scale) / scale } else { 0.0 }
    });
    let found = Runs::of(differences);
    found.assert_within(0.0, 0.0, "spread over variance - 1");
    assert!(found.error < 0.02, "{found:?}");
    let last = &images[0];
    assert!(last.film.pixels.iter().all(|pixel| pixel.sample_count == 8.0));
    let mean_variance =
        last.film.pixels.iter().map(|p| p.variance.element_sum() / 3.0).sum::<f64>()
            / last.film.pixels.len() as f64;
    let claimed = last.progress.relative_error * last.mean;
    assert!((mean_variance.sqrt() / claimed - 1.0).abs() < 1e-12);
}

/// One image for any number of threads and any division into passes, another for another seed.
#[test]
fn an_image_depends_on_the_seed_alone() {
    let mut scene = all_lights();
    let on_threads = |scene: &Scene, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| image(scene, 5).film)
    };
    let first = on_threads(&scene, 1);
    assert!(on_threads(&scene, 2) == first);
    assert!(on_threads(&scene, 7) == first);
    scene.photons.seed = 1;
    assert!(on_threads(&scene, 2) != first);
}

#[test]
fn an_error_asked_for_is_reached() {
    let scene = scene(grey_fog(CUBE, 1.0, 0.5, 0.0), white_sky(), 1);
    let limits = Limits { relative_error: Some(0.02), ..Limits::default() };
    let reference = render_reference(&scene, &limits, &Unwatched).unwrap();
    assert!(reference.progress.relative_error <= 0.02 && reference.progress.relative_error > 0.015);
    let endless = Limits { relative_error: Some(1e-12), seconds: Some(0.3), ..Limits::default() };
    let stopped = render_reference(&scene, &endless, &Unwatched).unwrap().progress;
    assert!(stopped.samples >= 2 && stopped.seconds < 3.0, "{stopped:?}");
}

#[test]
fn paths_without_end_are_refused() {
    let scene = scene(grey_fog(Bounds::Infinite, 1.0, 1.0, 0.0), white_sky(), 1);
    let refused = render_reference(&scene, &Limits::default(), &Unwatched);
    assert!(matches!(refused, Err(ReferenceError::Endless)));
}
