//! `photonvdb new`: scenes that are framed, dense as asked for, and render as they are.

use std::fs;
use std::path::{Path, PathBuf};

use crate::run::Workspace;
use photonvdb::math::{DAffine3, DVec3, Span, max_channel, mean_channel};
use photonvdb::medium::vdb::{
    GridToWrite, GridValue, SparseGrid, VdbFile, VolumeSource, WriteOptions, write_vdb,
};
use photonvdb::medium::{Extinction, MediumExtinction};
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::{Overrides, Scene};

fn media(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("media").join(name)
}

/// Makes a scene and loads it.
fn make(work: &Workspace, arguments: &str) -> Scene {
    let run = work.run(&format!("new made.toml --force {arguments}"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert_eq!(run.stdout, "");
    let scene = Scene::load(&work.path("made.toml")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.warnings, Vec::<String>::new());
    scene
}

/// Mean optical depth of the camera's rays that do more than graze the medium, at other places than the command takes.
fn mean_depth(scene: &Scene) -> f64 {
    let MediumExtinction::Grid(grid) = &scene.medium.extinction else { panic!("a grid") };
    let camera = &scene.camera;
    let (columns, rows) = (97, 73);
    let depth = |cell: usize| {
        let x = (cell % columns) as f64 / columns as f64 * camera.width as f64;
        let y = (cell / columns) as f64 / rows as f64 * camera.height as f64;
        max_channel(grid.optical_depth(&camera.ray(x, y), Span::new(0.0, f64::INFINITY)))
    };
    let depths: Vec<f64> = (0..columns * rows).map(depth).collect();
    let deepest = depths.iter().copied().fold(0.0, f64::max);
    let through: Vec<f64> = depths.into_iter().filter(|depth| *depth > 0.01 * deepest).collect();
    assert!(through.len() > 500, "{}", through.len());
    through.iter().sum::<f64>() / through.len() as f64
}

/// Share of the frame, along the fuller side, that the corners of the active voxels' box reach.
fn filled(scene: &Scene, file: &Path) -> f64 {
    let file = VdbFile::open(file).unwrap();
    let grid = file.grids().iter().find(|grid| grid.name == "density").unwrap();
    let (bbox, map) = (grid.active_bbox.unwrap(), grid.index_to_world.unwrap());
    let camera = &scene.camera;
    let reach = (0..8).map(|corner: usize| {
        let end = |axis: usize| f64::from([bbox.min, bbox.max][corner >> axis & 1][axis]);
        let world = map.transform_point3(DVec3::new(end(0), end(1), end(2)));
        let pixel = camera.project(world).expect("in front of the camera");
        let across = (2.0 * pixel.x / camera.width as f64 - 1.0).abs();
        across.max((2.0 * pixel.y / camera.height as f64 - 1.0).abs())
    });
    reach.fold(0.0, f64::max)
}

/// Mean radiance of scattered light and of the medium's own, and mean coverage, at low resolution.
fn light(work: &Workspace) -> [f64; 2] {
    let draft =
        Overrides { photons: Some(20_000), resolution: Some([32, 32]), ..Overrides::default() };
    let scene = Scene::load_with(&work.path("made.toml"), &draft).unwrap();
    let film = render(&scene, &RenderOptions::passes(1), &Unobserved).unwrap().film;
    let count = film.pixels.len() as f64;
    let scattered = film.pixels.iter().map(|pixel| {
        assert!(pixel.radiance().is_finite());
        mean_channel(pixel.single_scatter + pixel.multiple_scatter)
    });
    let covered: f64 = film.pixels.iter().map(|pixel| pixel.alpha()).sum();
    [scattered.sum::<f64>() / count, covered / count]
}

#[test]
fn smoke_is_framed_dense_as_asked_for_and_lit() {
    let work = Workspace::new();
    let file = media("smoke_plume.vdb");
    let from = format!("--from {}", file.display());
    let scene = make(&work, &from);
    let depth = mean_depth(&scene);
    assert!((3.8..4.2).contains(&depth), "{depth}");
    let filled = filled(&scene, &file);
    assert!((0.7..0.95).contains(&filled), "{filled}");
    assert!(scene.medium.emissivity.is_none());
    let [scattered, covered] = light(&work);
    assert!(scattered > 0.01, "{scattered}");
    assert!((0.05..0.9).contains(&covered), "{covered}");
    let text = fs::read_to_string(work.path("made.toml")).unwrap();
    assert!(text.contains("# temperature = \"temperature\""), "{text}");

    let dense = mean_depth(&make(&work, &format!("{from} --optical-depth 12")));
    assert!((11.4..12.6).contains(&dense), "{dense}");
    let upright = make(&work, &format!("{from} --up z"));
    assert!(upright.camera.position().y < 0.0 && upright.camera.position().z > 0.0);
    let steam = make(&work, &format!("{from} --preset steam"));
    assert!((3.8..4.2).contains(&mean_depth(&steam)));
    assert_eq!(steam.medium.albedo.x, 0.999999);
}

#[test]
fn fire_glows() {
    let work = Workspace::new();
    let file = media("fire.vdb");
    let scene = make(&work, &format!("--from {}", file.display()));
    let depth = mean_depth(&scene);
    assert!((3.8..4.2).contains(&depth), "{depth}");
    assert!((0.7..0.95).contains(&filled(&scene, &file)));
    assert!(scene.medium.emissivity.is_some());
    let grids: Vec<_> = scene.grids.iter().map(|grid| grid.name.as_str()).collect();
    assert_eq!(grids, ["density", "temperature"]);
    let [scattered, _] = light(&work);
    assert!(scattered > 0.01, "{scattered}");

    // Without kelvin, flames.
    let convert = format!("convert {} -o flames.vdb --grid density --grid flame", file.display());
    assert_eq!(work.run(&convert).code, Some(0));
    let scene = make(&work, "--from flames.vdb");
    assert_eq!(scene.grids[1].name, "flame");
    let text = fs::read_to_string(work.path("made.toml")).unwrap();
    assert!(text.contains("file = \"flames.vdb\""), "{text}");
}

#[test]
fn the_grid_that_looks_like_a_density_is_taken() {
    let work = Workspace::new();
    let fire = media("fire.vdb");
    let smoke = media("smoke_plume.vdb");
    let run = |arguments: String| assert_eq!(work.run(&arguments).code, Some(0), "{arguments}");
    run(format!("convert {} -o heat.vdb --grid temperature --grid flame", fire.display()));
    work.run("new made.toml --from heat.vdb").fails_with("name one it holds: \"temperature\"");
    let scene = make(&work, "--from heat.vdb --grid flame");
    assert_eq!(scene.grids[0].name, "flame");
    run(format!("convert {} -o soot.vdb --grid density --rename soot_mass", smoke.display()));
    assert_eq!(make(&work, "--from soot.vdb").grids[0].name, "soot_mass");

    let level_set = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vdb/levelset_mask.vdb");
    let scene = make(&work, &format!("--from {}", level_set.display()));
    assert!((3.8..4.2).contains(&mean_depth(&scene)));
    let text = fs::read_to_string(work.path("made.toml")).unwrap();
    assert!(text.contains("density = \"surface\"") && text.contains("sdf_to_fog = true"), "{text}");
}

#[test]
fn a_preset_alone_is_a_block_of_it() {
    let work = Workspace::new();
    for name in ["fog", "steam", "skim-milk", "regular-milk"] {
        let scene = make(&work, &format!("--preset {name}"));
        let text = fs::read_to_string(work.path("made.toml")).unwrap();
        assert_eq!(text.contains("gather = \"bounce\""), name != "skim-milk", "{text}");
        assert!(matches!(
            scene.medium.extinction,
            MediumExtinction::Uniform(_) | MediumExtinction::Chromatic(_)
        ));
        let [scattered, covered] = light(&work);
        assert!(scattered > 0.01 && covered > 0.2, "{name}: {scattered} {covered}");
    }
}

#[test]
fn what_is_there_stays() {
    let work = Workspace::new();
    let before = fs::read(work.path("fog.toml")).unwrap();
    let refused = work.run("new fog.toml --preset fog");
    refused.fails_with("fog.toml is there already; give another name, or --force to replace it");
    assert_eq!(fs::read(work.path("fog.toml")).unwrap(), before);
    assert_eq!(work.run("new fog.toml --preset fog --force").code, Some(0));
    assert_ne!(fs::read(work.path("fog.toml")).unwrap(), before);

    let shown = work.run("new - --preset fog");
    assert_eq!(shown.code, Some(0));
    assert_eq!(
        shown.stdout.replace("scene.", "fog."),
        fs::read_to_string(work.path("fog.toml")).unwrap()
    );
    work.run("new a.toml").fails_with("--from");
    work.run("new a.json --preset fog").fails_with(".toml");
    work.run("new a.toml --preset frog").fails_with("known are fog, ");
    work.run("new a.toml --from none.vdb").fails_with("none.vdb");
    assert_eq!(work.names(), ["fog.toml"]);
}

/// Leaves of 8^3 active voxels, each of one value.
fn leaves<V: GridValue + Default>(leaves: &[([i32; 3], V)]) -> SparseGrid<V> {
    SparseGrid {
        background: V::default(),
        index_to_world: DAffine3::from_scale(DVec3::splat(0.1)),
        leaves: leaves.iter().map(|(origin, _)| *origin).collect(),
        masks: vec![[u64::MAX; 8]; leaves.len()],
        values: leaves.iter().flat_map(|(_, value)| [*value; 512]).collect(),
        tiles: Vec::new(),
    }
}

/// Exporters leave active voxels of density 0: they are not what the picture is of.
#[test]
fn empty_voxels_are_not_framed() {
    let work = Workspace::new();
    let write = |name: &str, grid: &SparseGrid<f32>| {
        let grids = [GridToWrite::new("density", grid)];
        write_vdb(&work.path(name), &grids, &WriteOptions::default()).unwrap();
    };
    write("tight.vdb", &leaves(&[([80, 80, 80], 1.0)]));
    write("padded.vdb", &leaves(&[([0, 0, 0], 0.0), ([80, 80, 80], 1.0), ([160, 160, 160], 0.0)]));
    let [tight, padded] = ["tight", "padded"].map(|name| {
        let run = work.run(&format!("new {name}.toml --from {name}.vdb"));
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        (Scene::load(&work.path(&format!("{name}.toml"))).unwrap(), run.stderr)
    });
    assert_eq!(padded.0.camera.position(), tight.0.camera.position());
    let crop = "photonvdb convert padded.vdb -o small.vdb --crop 79,79,79,88,88,88";
    assert!(padded.1.contains(crop), "{}", padded.1);
    assert!(!tight.1.contains("--crop"), "{}", tight.1);
    assert_eq!(work.run(crop.trim_start_matches("photonvdb ")).code, Some(0));
    let small = VdbFile::open(&work.path("small.vdb")).unwrap();
    assert_eq!(small.grids()[0].active_voxel_count, 512);
}

#[test]
fn volumes_that_no_scene_can_show_are_refused() {
    let work = Workspace::new();
    let options = WriteOptions::default();
    for (name, value, said) in [
        ("zero.vdb", 0.0, "no density is above 0"),
        ("negative.vdb", -1.0, "no density is above 0"),
        ("nan.vdb", f32::NAN, "no density is above 0"),
        ("faint.vdb", 1e-38, "its densities are as good as 0"),
    ] {
        let grid = leaves(&[([0; 3], value)]);
        write_vdb(&work.path(name), &[GridToWrite::new("density", &grid)], &options).unwrap();
        let refused = work.run(&format!("new a.toml --from {name}"));
        refused.fails_with(&format!("grid \"density\" of {name} cannot be used: {said}"));
    }
    let colors = leaves(&[([0; 3], [1.0_f32; 3])]);
    write_vdb(&work.path("colors.vdb"), &[GridToWrite::new("Cd", &colors)], &options).unwrap();
    let refused = work.run("new a.toml --from colors.vdb");
    refused
        .fails_with("no grid of numbers that could be densities; `photonvdb inspect colors.vdb`");
    assert!(!work.path("a.toml").exists());
}
