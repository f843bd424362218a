//! Several volumes in one space: exact identities, sharing of grids, white furnaces, scene files.

use std::path::Path;
use std::sync::Arc;

use crate::grid_support::cloud;
use crate::transport_support::*;
use photonvdb::film::{Film, Pixel};
use photonvdb::math::{DAffine3, DVec3, Ray, Rgb, Span, Stream, uniform};
use photonvdb::medium::{
    BoostedQuantile, Bounds, Extinction, Flight, Medium, MediumExtinction, Phase, RayProfile,
    Volumes, VolumesError,
};
use photonvdb::reference::path_light;
use photonvdb::render::{Gather, RenderError, RenderOptions, Unobserved, render};
use photonvdb::scene::{Overrides, Plan, Scene, SceneFile};

fn together(media: Vec<Medium>) -> Medium {
    Medium::of_volumes(media).unwrap()
}

fn volumes(medium: &Medium) -> &Volumes {
    match &medium.extinction {
        MediumExtinction::Several(volumes) => volumes,
        _ => panic!("one medium alone"),
    }
}

/// A scene file in a folder of its own; MEDIA stands for the folder of volumes.
fn load(text: &str, extension: &str, overrides: &Overrides) -> Result<Scene, String> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(format!("s.{extension}"));
    let media = format!("{}/media", env!("CARGO_MANIFEST_DIR"));
    std::fs::write(&path, text.replace("MEDIA", &media)).unwrap();
    Scene::load_with(&path, overrides).map_err(|error| error.to_string())
}

const HEAD: &str = "[camera]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\nresolution = [8, 8]\n[[light]]\nkind = \"point\"\nposition = [0, 3, 0]\nintensity = 10\n";

fn smoke(density_scale: f64, rest: &str) -> String {
    format!(
        "[[medium]]\nkind = \"vdb\"\nfile = \"MEDIA/smoke_plume.vdb\"\ndensity_scale = {density_scale}\nalbedo = 0.9\n{rest}\n"
    )
}

const FOG: &str = "[[medium]]\nkind = \"homogeneous\"\nbounds = { min = [-2, -2, -2], max = [2, 2, 2] }\nsigma_t = 0.3\nalbedo = 0.95\n";

/// Rays through a ball, some from inside it.
fn rays(radius: f64) -> Vec<Ray> {
    let mut random = Stream::Experiment.random(1, 0);
    (0..200)
        .map(|i| {
            let far = if i % 3 == 0 { 0.2 * radius } else { 4.0 * radius };
            let impact = radius * uniform(&mut random);
            passing_ray(DVec3::ZERO, impact, far, &mut random)
        })
        .collect()
}

fn assert_close(a: f64, b: f64, tolerance: f64, what: &str) {
    assert!((a - b).abs() <= tolerance * (1.0 + a.abs().max(b.abs())), "{what}: {a} {b}");
}

/// Everything that a ray asks of two halves is what it asks of the whole.
fn assert_same_rays<E: Extinction>(halves: &Medium, whole: &Medium, one: &E, what: &str) {
    let sum = volumes(halves);
    let radius = whole.bounds.enclosing_ball().unwrap().radius;
    let (mut of_sum, mut of_one) = (RayProfile::default(), RayProfile::default());
    let mut met = 0;
    for ray in rays(radius) {
        let (Some(span), Some(wide)) =
            (whole.bounds.intersect(&ray), halves.bounds.intersect(&ray))
        else {
            continue;
        };
        met += 1;
        let depth = one.optical_depth(&ray, span).x;
        assert_close(sum.optical_depth(&ray, wide).x, depth, 1e-12, what);
        let transmittance = one.transmittance(&ray, span).x;
        assert_close(sum.transmittance(&ray, wide).x, transmittance, 1e-12, what);
        sum.profile(&ray, wide, &mut of_sum);
        one.profile(&ray, span, &mut of_one);
        for step in 0..=50 {
            let distance = span.start + span.length() * f64::from(step) / 50.0;
            let place = ray.at(distance);
            if whole.bounds.contains(place) {
                assert_close(sum.sigma_t(place).x, one.sigma_t(place).x, 1e-12, what);
            }
            let [a, b] = [&of_sum, &of_one].map(|profile| profile.optical_depth(distance).x);
            assert_close(a, b, 1e-10, what);
        }
        for u in [0.0, 0.1, 0.5, 0.9, 0.999] {
            let flights = [
                (
                    sum.invert_flight(&ray, wide, Rgb::ONE, u),
                    one.invert_flight(&ray, span, Rgb::ONE, u),
                ),
                {
                    let boosted = BoostedQuantile { u, boost: 1.7 };
                    let mut profile = RayProfile::default();
                    let a = sum.boosted_flight(&ray, wide, Rgb::ONE, boosted, &mut profile, false);
                    let b = one.boosted_flight(&ray, span, Rgb::ONE, boosted, &mut profile, false);
                    assert_close(a.share, b.share, 1e-9, what);
                    (a.flight, b.flight)
                },
            ];
            for (a, b) in flights {
                match (a, b) {
                    (Flight::Escape { .. }, Flight::Escape { .. }) => {}
                    (
                        Flight::Collision { distance: a, .. },
                        Flight::Collision { distance: b, .. },
                    ) => {
                        let [a, b] =
                            [a, b].map(|d| one.optical_depth(&ray, Span::new(span.start, d)).x);
                        // Within a voxel a profile has the quadratic for the cubic.
                        assert_close(a, b, 1e-2, what);
                    }
                    other => panic!("{what}: {other:?}"),
                }
            }
        }
    }
    assert!(met > 50, "{met}");
}

#[test]
fn overlapping_halves_are_the_whole() {
    let fog = |sigma_t| grey_fog(CUBE, sigma_t, 0.9, 0.0);
    let whole = fog(3.0);
    let MediumExtinction::Uniform(one) = &whole.extinction else { panic!() };
    assert_same_rays(&together(vec![fog(1.0), fog(2.0)]), &whole, one, "fog");

    let place = DAffine3::from_scale(DVec3::splat(0.1));
    let grid = |scale| grid_medium(cloud(10).extinction(place, scale), Rgb::splat(0.9), 0.0);
    let whole = grid(6.0);
    let MediumExtinction::Grid(one) = &whole.extinction else { panic!() };
    assert_same_rays(&together(vec![grid(2.0), grid(4.0)]), &whole, &**one, "cloud");

    let smokes = format!("{HEAD}{}{}", smoke(15.0, ""), smoke(25.0, ""));
    let smokes = load(&smokes, "toml", &Overrides::default()).unwrap();
    let whole = load(&format!("{HEAD}{}", smoke(40.0, "")), "toml", &Overrides::default()).unwrap();
    let MediumExtinction::Grid(one) = &whole.medium.extinction else { panic!() };
    assert_same_rays(&smokes.medium, &whole.medium, &**one, "smoke");
}

/// Quantiles of drawn flights are uniform, escapes as many as the transmittance says; ratio tracking has its mean.
#[test]
fn flights_end_where_the_sum_of_extinctions_says() {
    let place = DAffine3::from_translation(DVec3::new(0.3, 0.1, 0.0))
        * DAffine3::from_scale(DVec3::splat(0.08));
    let medium = together(vec![
        grid_medium(cloud(10).extinction(place, 4.0), Rgb::ONE, 0.0),
        grey_fog(ball(0.8), 0.7, 0.9, 0.0),
        grey_fog(Bounds::Box { min: DVec3::ZERO, max: DVec3::splat(2.0) }, 0.4, 0.9, 0.0),
    ]);
    let sum = volumes(&medium);
    let ray = Ray::new(DVec3::new(-3.0, -0.9, -0.2), DVec3::new(3.0, 1.2, 0.4).normalize());
    let span = medium.bounds.intersect(&ray).unwrap();
    let opacity = sum.opacity(&ray, span, Rgb::ONE);
    assert!(opacity > 0.3 && opacity < 0.999, "{opacity}");
    let batches: Vec<[f64; 4]> = (0..64)
        .map(|batch| {
            let mut random = Stream::Experiment.random(2, batch);
            let mut sums = [0.0; 4];
            for _ in 0..2000 {
                if let Flight::Collision { distance, .. } =
                    sum.sample_flight(&ray, span, Rgb::ONE, &mut random)
                {
                    let passed = Span::new(span.start, distance);
                    let quantile = sum.opacity(&ray, passed, Rgb::ONE) / opacity;
                    sums[0] += 1.0 / opacity;
                    sums[1] += 2.0 * quantile / opacity;
                    sums[2] += 3.0 * quantile * quantile / opacity;
                }
                sums[3] += sum.estimate_transmittance(&ray, span, &mut random).x / (1.0 - opacity);
            }
            sums.map(|sum| sum / 2000.0)
        })
        .collect();
    for (index, what) in ["collisions", "mean", "square", "transmittance"].into_iter().enumerate() {
        Runs::of(batches.iter().map(|batch| batch[index])).assert_is(1.0, what);
    }
}

fn layers(film: &Film) -> [f64; 2] {
    let mean = |layer: fn(&Pixel) -> Rgb| {
        film.pixels.iter().map(layer).sum::<Rgb>().x / film.pixels.len() as f64
    };
    [mean(|p| p.single_scatter), mean(|p| p.multiple_scatter)]
}

fn assert_same_images(parts: Medium, whole: Medium, gather: Gather, what: &str) {
    let [parts, whole] = [parts, whole].map(|medium| {
        let mut scene = scene(medium, one_watt(DVec3::new(0.3, 1.4, 0.2)), 5000);
        (scene.camera.width, scene.camera.height) = (12, 9);
        scene.render.gather = gather;
        scene.render.lattice = Some(12);
        over_seeds(&mut scene, |scene| {
            layers(&render(scene, &RenderOptions::passes(1), &Unobserved).unwrap().film)
        })
    });
    for (layer, (parts, whole)) in ["single", "multiple"].iter().zip(parts.iter().zip(whole)) {
        let error = parts.error.hypot(whole.error);
        Runs { error, ..*parts }.assert_is(whole.mean, &format!("{what}, {gather:?}, {layer}"));
    }
}

#[test]
fn images_of_halves_are_those_of_the_whole() {
    let fog = |sigma_t, albedo| grey_fog(CUBE, sigma_t, albedo, 0.4);
    for gather in [Gather::Lattice, Gather::Knn] {
        let halves = together(vec![fog(0.8, 0.9), fog(0.8, 0.9)]);
        assert_same_images(halves, fog(1.6, 0.9), gather, "halves");
        // Each collision is with soot or with fog.
        let dirty = together(vec![fog(0.8, 1.0), fog(0.8, 0.0), fog(0.8, 0.8)]);
        assert_same_images(dirty, fog(2.4, 0.6), gather, "soot");
    }
    // Isotropic and forward scattering in one place make a mixture of lobes.
    let [g, isotropic] = [0.7, 0.0].map(photonvdb::medium::Lobe::henyey_greenstein);
    let mixed =
        Medium { phase: Phase::two_lobes(g, isotropic, 0.25), ..grey_fog(CUBE, 1.6, 0.9, 0.0) };
    let parts = together(vec![grey_fog(CUBE, 0.4, 0.9, 0.7), grey_fog(CUBE, 1.2, 0.9, 0.0)]);
    assert_same_images(parts, mixed, Gather::Knn, "phase functions");
}

#[test]
fn instances_share_their_grid() {
    let other = "transform = { translate = [1, 0.2, 0], rotate = [0, 30, 0], scale = 0.5 }";
    let text = format!("{HEAD}{}{}{FOG}", smoke(40.0, ""), smoke(10.0, other));
    let scene = load(&text, "toml", &Overrides::default()).unwrap();
    let media = volumes(&scene.medium).media();
    let grids: Vec<_> = media
        .iter()
        .filter_map(|medium| match &medium.extinction {
            MediumExtinction::Grid(grid) => Some(grid),
            _ => None,
        })
        .collect();
    assert_eq!((media.len(), grids.len()), (3, 2));
    assert!(Arc::ptr_eq(grids[0].shared_grid(), grids[1].shared_grid()));
    assert!(grids[1].bounds() != grids[0].bounds());
    let alone = load(&format!("{HEAD}{}", smoke(40.0, "")), "toml", &Overrides::default()).unwrap();
    assert_eq!(scene.grids.len(), 1);
    assert_eq!((scene.grids[0].volumes, alone.grids[0].volumes), (2, 1));
    assert_eq!(scene.grids[0].memory_bytes, alone.grids[0].memory_bytes);
    // Another precision is another grid, and a limit on memory counts both.
    let half = format!("{text}{}", smoke(10.0, "precision = \"half\""));
    let both = load(&half, "toml", &Overrides::default()).unwrap();
    assert_eq!(both.grids.len(), 2);
    let held = alone.grids[0].memory_bytes;
    let limited = |bytes| Overrides { max_volume_memory: Some(bytes), ..Overrides::default() };
    let least = (held..).step_by(1 << 18).find(|b| load(&text, "toml", &limited(*b)).is_ok());
    let error = load(&half, "toml", &limited(least.unwrap())).unwrap_err();
    assert!(error.contains("medium[3].density"), "{error}");
}

#[test]
fn a_plan_tells_of_volumes() {
    let plan = |text: &str| Plan::of(&load(text, "toml", &Overrides::default()).unwrap());
    let same = plan(&format!("{HEAD}{FOG}{}{}", smoke(1.0, ""), smoke(2.0, "")));
    let text = same.to_string();
    assert!(
        text.starts_with("3 volumes, 2 from density grids, isotropic, 1 point light: majorants, no emission\ndensity from grid \"density\" of smoke_plume.vdb, used 2 times, 2 MB\n"),
        "{text}"
    );
    assert!(text.ends_with("their flights gathered in a lattice"), "{text}");
    let phase = "phase = { kind = \"droplets\", diameter_um = 12 }\n";
    let mixed = plan(&format!("{HEAD}{FOG}{phase}{}", smoke(1.0, "")));
    let text = mixed.to_string();
    assert!(text.contains("each with its own phase function"), "{text}");
    assert!(text.ends_with("; no lattice, as volumes differ in their phase functions"), "{text}");
    assert_eq!(mixed.gather, Gather::Knn);
}

/// Under radiance 1 from all sides a medium that absorbs nothing is invisible, whatever overlaps in it.
#[test]
fn white_furnaces() {
    let place = DAffine3::from_scale(DVec3::splat(0.1));
    let furnaces = [
        ("fogs", together(vec![grey_fog(CUBE, 1.0, 1.0, 0.6), grey_fog(CUBE, 1.0, 1.0, -0.4)])),
        (
            "cloud in fog",
            together(vec![
                grid_medium(cloud(10).extinction(place, 4.0), Rgb::ONE, 0.7),
                grey_fog(ball(1.1), 0.8, 1.0, 0.0),
            ]),
        ),
    ];
    for (name, medium) in furnaces {
        let mut scene = scene(medium, white_sky(), 10_000);
        scene.render.photons_only = true;
        let [seen] = over_seeds(&mut scene, |scene| {
            let mut random = Stream::Experiment.random(scene.photons.seed, 3);
            let rays: Vec<Ray> = (0..70)
                .map(|_| passing_ray(DVec3::ZERO, 0.6 * uniform(&mut random), 5.0, &mut random))
                .collect();
            let seen = mean_seen(scene, &rays, &mut random);
            [(seen.single + seen.multiple).x / (1.0 - seen.emission.x)]
        });
        // As the furnaces of one medium: collisions of one photon lie together.
        seen.assert_within(1.0, 0.01, &format!("{name}, photons"));
        scene.render.photons_only = false;
        let mut random = Stream::Experiment.random(4, 0);
        let paths = (0..32).map(|_| {
            let paths = (0..500).map(|_| {
                let ray = passing_ray(DVec3::ZERO, 0.9 * uniform(&mut random), 5.0, &mut random);
                path_light(&scene, &ray, &mut random).unwrap().radiance().x
            });
            paths.sum::<f64>() / 500.0
        });
        Runs::of(paths.collect::<Vec<_>>().into_iter()).assert_is(1.0, &format!("{name}, paths"));
    }
}

/// Emissivities add up, at points and in all, and heat glows by the sigma_a of its own volume.
#[test]
fn glowing_volumes_add_up() {
    let fire = |rest: &str| {
        format!(
            "[[medium]]\nkind = \"vdb\"\nfile = \"MEDIA/fire.vdb\"\ndensity_scale = 9\nalbedo = 0.8\ntemperature = \"temperature\"\nflame = \"flame\"\n{rest}\n"
        )
    };
    let moved = fire("emission_scale = 0.5\ntransform = { translate = [0.4, 0.1, 0] }");
    let one = |text: &str| load(&format!("{HEAD}{text}"), "toml", &Overrides::default()).unwrap();
    let (first, second) = (one(&fire("")), one(&moved));
    let both = one(&format!("{}{moved}{FOG}", fire("")));
    assert_eq!(both.grids.len(), 3, "{:?}", both.grids);
    let power = |scene: &Scene| {
        scene.medium.emissivity.as_ref().unwrap().cells().unwrap().power().element_sum()
    };
    let ratio = power(&both) / (power(&first) + power(&second));
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    let sum = volumes(&both.medium);
    let (min, max) = first.medium.bounds.extent().unwrap();
    let mut random = Stream::Experiment.random(5, 0);
    let mut glowing = 0;
    for _ in 0..2000 {
        let u: [f64; 3] = std::array::from_fn(|_| uniform(&mut random));
        let place = min + (max - min) * DVec3::from_array(u);
        let parts = first.medium.emissivity_at(place) + second.medium.emissivity_at(place);
        let whole = both.medium.emissivity_at(place);
        let split = both.medium.heat_at(place) * sum.sigma_t(place) + both.medium.flame_at(place);
        glowing += i32::from(parts.x > 0.0);
        assert!((whole - parts).abs().max_element() <= 1e-12 * parts.x, "{place}");
        assert!((split - parts).abs().max_element() <= 1e-12 * parts.x, "{place}");
    }
    assert!(glowing > 100, "{glowing}");
}

#[test]
fn scene_files_say_what_is_wrong_with_which() {
    let fails = |text: &str| load(text, "toml", &Overrides::default()).unwrap_err();
    for (media, expected) in [
        (FOG.replace("0.3", "[0.1, 0.2, 0.3]"), "medium[1].sigma_t: must be one number where"),
        (
            FOG.replace("{ min = [-2, -2, -2], max = [2, 2, 2] }", "\"infinite\""),
            "medium[1].bounds: one of several media needs a box or a ball",
        ),
        (FOG.replace("albedo", "albdo"), "medium[1].albdo: unknown key; did you mean \"albedo\"?"),
        (smoke(1.0, "density = \"no\""), "medium[1].density: "),
        (smoke(1.0, "").replace("plume", "plum"), "medium[1].file: "),
    ] {
        let error = fails(&format!("{HEAD}{FOG}{media}"));
        assert!(error.contains(expected), "{error}");
    }
    let none = "medium = []\n[camera]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\n";
    assert!(fails(none).contains("medium: a scene needs a medium"), "{}", fails(none));
    let chromatic = fog(CUBE, Rgb::new(1.0, 2.0, 3.0), Rgb::ONE, 0.0);
    let media = vec![grey_fog(CUBE, 1.0, 1.0, 0.0), chromatic];
    assert_eq!(Medium::of_volumes(media).unwrap_err(), VolumesError::Chromatic(1));
    assert_eq!(Medium::of_volumes(Vec::new()).unwrap_err(), VolumesError::None);
}

#[test]
fn a_list_of_one_is_a_medium() {
    let read = |text: &str, extension: &str| load(text, extension, &Overrides::default()).unwrap();
    let (list, table) =
        (format!("{HEAD}{FOG}"), format!("{HEAD}{}", FOG.replace("[[medium]]", "[medium]")));
    let (list, table) = (read(&list, "toml"), read(&table, "toml"));
    assert_eq!(list.hash, table.hash);
    assert!(matches!(list.medium.extinction, MediumExtinction::Uniform(_)));
    let json = r#"{"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0], "resolution": [8, 8]},
        "light": [{"kind": "point", "position": [0, 3, 0], "intensity": 10}],
        "medium": [FOG, FOG]}"#;
    let fog = r#"{"kind": "homogeneous", "bounds": {"min": [-2, -2, -2], "max": [2, 2, 2]}, "sigma_t": 0.3, "albedo": 0.95}"#;
    let json = read(&json.replace("FOG", fog), "json");
    assert_eq!(json.hash, read(&format!("{HEAD}{FOG}{FOG}"), "toml").hash);
    assert_eq!(volumes(&json.medium).media().len(), 2);
}

#[test]
fn files_of_volumes_are_written_again_and_overridden() {
    let directory = tempfile::tempdir().unwrap();
    let text = format!("{HEAD}{FOG}{}", smoke(1.0, ""));
    let [first, again] = ["a.toml", "b.toml"].map(|name| directory.path().join(name));
    std::fs::write(&first, &text).unwrap();
    let overrides = Overrides { sdf_to_fog: Some(true), ..Overrides::default() };
    let read = |path: &Path, overrides: &Overrides| SceneFile::load(path, overrides).unwrap();
    let file = read(&first, &overrides);
    assert!(file != read(&first, &Overrides::default()));
    std::fs::write(&again, toml::to_string(&file).unwrap()).unwrap();
    assert_eq!(read(&again, &Overrides::default()), file);
}

#[test]
fn a_lattice_of_one_phase_function_is_refused_to_several() {
    let medium = together(vec![grey_fog(CUBE, 1.0, 0.9, 0.6), grey_fog(CUBE, 1.0, 0.9, 0.0)]);
    let mut scene = scene(medium, white_sky(), 100);
    scene.render.gather = Gather::Lattice;
    let rendered = render(&scene, &RenderOptions::passes(1), &Unobserved);
    assert!(matches!(rendered, Err(RenderError::NoLattice)));
    let phase = "phase = { kind = \"draine\", g = 0.2, alpha = 1 }\n";
    let asked = format!("{HEAD}{FOG}{phase}{}[render]\ngather = \"lattice\"\n", smoke(1.0, ""));
    let scene = load(&asked, "toml", &Overrides::default()).unwrap();
    assert_eq!(scene.render.gather, Gather::Knn);
    assert!(
        scene.warnings.iter().any(|w| w.starts_with("render.gather: ")),
        "{:?}",
        scene.warnings
    );
}
