//! Light baked into voxels: against exact answers, and against the power that the photons account for.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use photonvdb::math::{DAffine3, DVec3, Rgb, mean_channel};
use photonvdb::medium::vdb::{Limits, SparseGrid, Tile};
use photonvdb::render::{BakeOptions, Baked, RenderError, Unobserved, bake, even_densities};
use photonvdb::scene::{Overrides, Scene};

const CAMERA: &str = "[camera]\nposition = [0.0, 0.0, 4.0]\nlook_at = [0.0, 0.0, 0.0]\n";

const POINT: &str =
    "[[light]]\nkind = \"point\"\nposition = [0.1, 0.2, 0.05]\nintensity = [1.0, 2.0, 4.0]\n";

fn scene(rest: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes/baked.toml");
    Scene::from_text(&format!("{CAMERA}{rest}"), &path, &Overrides::default()).unwrap()
}

fn fog(medium: &str, light: &str, photons: u64) -> Scene {
    scene(&format!(
        "[medium]\nkind = \"homogeneous\"\n{medium}\n{light}[photons]\ncount = {photons}\n"
    ))
}

const BOX: &str = "bounds = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }";

fn options() -> BakeOptions {
    BakeOptions { passes: 1, light_samples: 64, medium: 0, limits: Limits::default() }
}

fn baked(scene: &Scene, voxels: usize, options: &BakeOptions) -> (SparseGrid<f32>, Baked) {
    let densities = even_densities(&scene.medium, voxels, &options.limits).unwrap();
    let baked = bake(scene, &densities, options, &Unobserved).unwrap();
    (densities, baked)
}

/// Middles and values of all active voxels.
fn active(grid: &SparseGrid<[f32; 3]>) -> Vec<(DVec3, Rgb)> {
    let mut found = Vec::new();
    for (leaf, origin) in grid.leaves.iter().enumerate() {
        for offset in 0..512 {
            if grid.masks[leaf][offset >> 6] >> (offset & 63) & 1 == 1 {
                let step = [offset >> 6, offset >> 3 & 7, offset & 7].map(|step| step as f64);
                let index = DVec3::from_array(origin.map(f64::from)) + DVec3::from_array(step);
                let value = Rgb::from_array(grid.values[leaf * 512 + offset].map(f64::from));
                found.push((grid.index_to_world.transform_point3(index), value));
            } else {
                assert_eq!(grid.values[leaf * 512 + offset], [0.0; 3]);
            }
        }
    }
    found
}

#[test]
fn a_point_light_in_an_absorbing_medium_is_exact() {
    let sigma_t = 1.5;
    let scene = fog(&format!("{BOX}\nsigma_t = {sigma_t}\nalbedo = 0.0"), POINT, 1000);
    let (densities, baked) = baked(&scene, 20, &options());
    let position = DVec3::new(0.1, 0.2, 0.05);
    let found = active(&baked.fluence);
    assert_eq!(found.len(), 20 * 20 * 20);
    assert_eq!(
        (&densities.leaves, &densities.masks),
        (&baked.fluence.leaves, &baked.fluence.masks)
    );
    let mut nearest = f64::INFINITY;
    for (place, fluence) in found {
        let distance = place.distance(position);
        nearest = nearest.min(distance);
        // Phi e^(-sigma r) / (4 pi r^2) with Phi = 4 pi I.
        let exact = Rgb::new(1.0, 2.0, 4.0) * (-sigma_t * distance).exp() / (distance * distance);
        assert!((fluence / exact - 1.0).abs().max_element() < 1e-6, "{place}: {fluence} {exact}");
    }
    assert!(nearest < 0.1);
    assert!(active(&baked.emission).iter().all(|(_, emission)| *emission == Rgb::ZERO));
    // Every watt that does not leave the box is absorbed in it; the middles of voxels beside the light miss some of the peak.
    let absorbed = baked.report.photons.power.absorbed;
    let ratio = baked.report.absorbed / absorbed;
    assert!((ratio - 1.0).abs().max_element() < 0.1, "{ratio}");
}

/// In the voxel that holds a point light the fluence is the mean about the light: finite, and the sum over voxels is right.
#[test]
fn a_light_in_the_middle_of_a_voxel_is_finite() {
    let light = "[[light]]\nkind = \"point\"\nposition = [0.0, 0.0, 0.0]\nintensity = 1.0\n";
    let thin = "bounds = { center = [0.0, 0.0, 0.0], radius = 1.0 }\nsigma_t = 1e-9\nalbedo = 0.5";
    let scene = fog(thin, light, 1000);
    let (_, baked) = baked(&scene, 41, &options());
    let voxel = 2.0 / 41.0_f64;
    let radius = (0.75 / PI).cbrt() * voxel;
    let most = active(&baked.fluence).iter().map(|(_, light)| light.x).fold(0.0, f64::max);
    assert!((most * radius * radius / 3.0 - 1.0).abs() < 1e-6, "{most}");
    let integral: f64 = active(&baked.fluence).iter().map(|(_, light)| light.x).sum();
    // 4 pi I R
    let ratio = integral * voxel.powi(3) / (4.0 * PI);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

/// Under radiance L from everywhere, a medium that absorbs nothing is as bright as its surroundings: fluence 4 pi L.
#[test]
fn a_white_furnace_is_even() {
    let sky = "[[light]]\nkind = \"environment\"\nradiance = [0.5, 1.0, 2.0]\n";
    let radiance = Rgb::new(0.5, 1.0, 2.0);
    let ball = "bounds = { center = [5.0, 0.0, 0.0], radius = 1.0 }";
    let forward = "phase = { kind = \"henyey-greenstein\", g = 0.7 }";
    for (medium, gather, allowed) in [
        (format!("{BOX}\nsigma_t = 1.0\nalbedo = 1.0"), "lattice", 0.02),
        (format!("{BOX}\nsigma_t = 1.0\nalbedo = 1.0\n{forward}"), "lattice", 0.02),
        (format!("{ball}\nsigma_t = 1.0\nalbedo = 1.0"), "lattice", 0.02),
        (format!("{BOX}\nsigma_t = 1.0\nalbedo = 1.0"), "knn", 0.03),
        (format!("{BOX}\nsigma_t = [0.5, 1.0, 2.0]\nalbedo = 1.0"), "lattice", 0.02),
    ] {
        let scene = fog(&medium, &format!("{sky}[render]\ngather = \"{gather}\"\n"), 100_000);
        let options = BakeOptions { light_samples: 16, ..options() };
        let (_, baked) = baked(&scene, 16, &options);
        let report = &baked.report;
        let ratio = report.mean_fluence / (4.0 * PI * radiance);
        assert!((ratio - 1.0).abs().max_element() < 0.01, "{medium} {gather}: {ratio}");
        let found = active(&baked.fluence);
        let squares = |(_, light): &(DVec3, Rgb)| (light.y / (4.0 * PI) - 1.0).powi(2);
        let spread = (found.iter().map(squares).sum::<f64>() / found.len() as f64).sqrt();
        assert!(spread < 4.0 * allowed, "{medium} {gather}: {spread}");
        let sigma_s = scene.medium.extinction.sigma_t(DVec3::ZERO);
        for ((_, emission), (_, fluence)) in active(&baked.emission).into_iter().zip(found) {
            let exact = sigma_s * fluence / (4.0 * PI);
            assert!((emission / exact - 1.0).abs().max_element() < 1e-6);
        }
        assert_eq!(report.absorbed, Rgb::ZERO);
    }
}

fn cloud() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes/smoke_sun.toml")
}

/// What voxels say is absorbed is what photons leave behind, in smoke of a file as it lies in the scene.
#[test]
fn absorbed_power_is_that_of_the_photons() {
    let overrides = Overrides { photons: Some(50_000), ..Overrides::default() };
    let scene = Scene::load_with(&cloud(), &overrides).unwrap();
    let densities = Scene::load_densities(&cloud(), &overrides, 0).unwrap().unwrap();
    let baked = bake(&scene, &densities, &options(), &Unobserved).unwrap();
    let absorbed = baked.report.photons.power.absorbed;
    let ratio = baked.report.absorbed / absorbed;
    // Few photons have wide cells: 3 % too low, of a million 0.6 %.
    assert!((ratio - 1.0).abs().max_element() < 0.05, "{ratio}");
    assert_eq!(baked.fluence.index_to_world, densities.index_to_world);
    assert_eq!(
        (&baked.emission.leaves, &baked.emission.masks),
        (&densities.leaves, &densities.masks)
    );
    // 4 pi times the emission is what is scattered.
    let volume = densities.index_to_world.matrix3.determinant();
    let sum: f64 = active(&baked.emission).iter().map(|(_, light)| mean_channel(*light)).sum();
    let scattered = mean_channel(baked.report.scattered);
    assert!((4.0 * PI * sum * volume / scattered - 1.0).abs() < 1e-5);
}

/// Of two volumes in one place each scatters its own share of the same light.
#[test]
fn each_of_several_media_scatters_its_own_share() {
    let fog = |sigma_t: f64, albedo: f64| {
        format!(
            "[[medium]]\nkind = \"homogeneous\"\n{BOX}\nsigma_t = {sigma_t}\nalbedo = {albedo}\n"
        )
    };
    let scene =
        scene(&format!("{}{}{POINT}[photons]\ncount = 2000\n", fog(0.5, 0.8), fog(1.0, 0.2)));
    let [first, second] = [0, 1].map(|medium| {
        let densities = even_densities(scene.medium.volume(medium).unwrap(), 8, &Limits::default());
        let options = BakeOptions { medium, ..options() };
        bake(&scene, &densities.unwrap(), &options, &Unobserved).unwrap()
    });
    assert_eq!(first.fluence.values, second.fluence.values);
    let ratio = first.report.scattered / second.report.scattered;
    assert!((ratio - 2.0).abs().max_element() < 1e-6, "{ratio}");
    let missing = BakeOptions { medium: 2, ..options() };
    let densities = even_densities(&scene.medium, 8, &Limits::default()).unwrap();
    let refused = bake(&scene, &densities, &missing, &Unobserved).unwrap_err();
    assert!(matches!(refused, RenderError::NoSuchMedium { number: 2 }));
}

/// An active tile has as many voxels as before, each with its own light; more than memory allows are refused before they are made.
#[test]
fn tiles_become_voxels_within_limits() {
    let scene = fog(&format!("{BOX}\nsigma_t = 1.0\nalbedo = 0.5"), POINT, 1000);
    let grid = |dim: u32| SparseGrid {
        background: 0.0,
        index_to_world: DAffine3::from_scale_rotation_translation(
            DVec3::splat(0.1),
            glam::DQuat::IDENTITY,
            DVec3::splat(-0.4),
        ),
        leaves: Vec::new(),
        masks: Vec::new(),
        values: Vec::new(),
        tiles: vec![Tile { origin: [0; 3], dim, value: 1.0f32, active: true }],
    };
    let baked = bake(&scene, &grid(8), &options(), &Unobserved).unwrap();
    assert_eq!(baked.report.voxel_count, 512);
    assert!(active(&baked.fluence).iter().all(|(_, light)| light.min_element() > 0.0));
    let refused = bake(&scene, &grid(4096), &options(), &Unobserved).unwrap_err();
    assert!(matches!(refused, RenderError::TooManyVoxels { voxels, .. } if voxels == 1 << 36));
    assert!(even_densities(&scene.medium, 4096, &Limits::default()).is_err());
}
