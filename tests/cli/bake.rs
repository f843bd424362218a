//! `photonvdb bake` through the binary.

use std::fs;

use crate::run::Workspace;
use photonvdb::math::DVec3;
use photonvdb::medium::vdb::{Limits, VdbFile, VolumeSource};

const SMOKE: &str = r#"
[camera]
position = [0.0, 0.0, 4.0]
look_at = [0.0, 0.0, 0.0]

[medium]
kind = "vdb"
file = "smoke.vdb"
density_scale = 30.0
albedo = [0.9, 0.8, 0.7]
transform = { translate = [0.5, -0.25, 1.0], rotate = [0.0, 90.0, 0.0], scale = 2.0 }

[[light]]
kind = "directional"
direction = [0.5, -1.0, -0.3]
irradiance = [3.0, 2.5, 2.0]

[photons]
count = 5000
"#;

fn smoke() -> Workspace {
    let work = Workspace::new();
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/vdb/smoke_blosc.vdb");
    fs::copy(file, work.path("smoke.vdb")).unwrap();
    fs::write(work.path("smoke.toml"), SMOKE).unwrap();
    work
}

#[test]
fn grids_lie_on_the_tree_of_the_density_in_the_scenes_world() {
    let work = smoke();
    let run = work.run("bake smoke.toml -o lit.vdb");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert_eq!(run.stdout, "");
    assert!(run.stderr.contains("wrote lit.vdb: density, fluence, emission, "), "{}", run.stderr);
    let limits = Limits::default();
    let source = VdbFile::open(&work.path("smoke.vdb")).unwrap().load_scalar(0, &limits).unwrap();
    let lit = VdbFile::open(&work.path("lit.vdb")).unwrap();
    let names: Vec<_> =
        lit.grids().iter().map(|g| (g.name.as_str(), g.value_type.as_str())).collect();
    assert_eq!(names, [("density", "float"), ("fluence", "vec3s"), ("emission", "vec3s")]);
    let density = lit.load_scalar(0, &limits).unwrap();
    assert_eq!((&density.leaves, &density.masks), (&source.leaves, &source.masks));
    assert_eq!(density.values, source.values);
    // A quarter turn about y, twice the size, then moved.
    let point = source.index_to_world.transform_point3(DVec3::new(3.0, -5.0, 7.0));
    let placed = DVec3::new(point.z, point.y, -point.x) * 2.0 + DVec3::new(0.5, -0.25, 1.0);
    for index in 0..3 {
        let (leaves, masks, map) = match index {
            0 => (density.leaves.clone(), density.masks.clone(), density.index_to_world),
            _ => {
                let grid = lit.load_vector(index, &limits).unwrap();
                (grid.leaves, grid.masks, grid.index_to_world)
            }
        };
        assert_eq!((&leaves, &masks), (&source.leaves, &source.masks));
        let found = map.transform_point3(DVec3::new(3.0, -5.0, 7.0));
        assert!(found.distance(placed) < 1e-9, "{found} {placed}");
    }
    // emission = sigma_s / (4 pi) fluence, with sigma_s = 30 density albedo.
    let (fluence, emission) =
        (lit.load_vector(1, &limits).unwrap(), lit.load_vector(2, &limits).unwrap());
    let mut compared = 0;
    for (voxel, density) in density.values.iter().enumerate() {
        for (channel, albedo) in [0.9, 0.8, 0.7].into_iter().enumerate() {
            let light = f64::from(fluence.values[voxel][channel]);
            let exact = 30.0 * f64::from(*density) * albedo / (4.0 * std::f64::consts::PI) * light;
            let found = f64::from(emission.values[voxel][channel]);
            if exact > 1e-12 {
                assert!((found / exact - 1.0).abs() < 1e-5, "{found} {exact}");
                compared += 1;
            }
        }
    }
    assert!(compared > 50_000, "{compared}");
}

#[test]
fn files_are_the_same_for_any_number_of_threads() {
    let work = smoke();
    for (scene, rest) in [
        ("smoke.toml", "--passes 2"),
        ("smoke.toml", "--gather knn --k 20"),
        ("fog.toml", "--voxels 12"),
    ] {
        let [one, three] = [1, 3].map(|threads| {
            let run =
                work.run(&format!("bake {scene} -o lit.vdb --threads {threads} --quiet {rest}"));
            assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
            fs::read(work.path("lit.vdb")).unwrap()
        });
        assert!(one == three, "{scene} {rest}");
    }
}

#[test]
fn what_is_wrong_is_said_in_a_sentence() {
    let work = smoke();
    fs::write(work.path("lit.vdb"), "old").unwrap();
    for (arguments, said) in [
        ("bake none.toml -o lit.vdb", "none.toml: cannot read the scene"),
        ("bake fog.toml -o lit.exr", "must end in .vdb"),
        ("bake fog.toml -o nowhere/lit.vdb", "cannot write nowhere/lit.vdb"),
        ("bake fog.toml -o lit.vdb --medium 1", "there is no medium 1"),
        ("bake smoke.toml -o lit.vdb --medium 3", "there is no medium 3"),
        ("bake fog.toml -o lit.vdb --voxels 4096", "needs more than 8192 MiB"),
        ("bake fog.toml -o lit.vdb --voxels 0", "0 is not in 1..=4096"),
    ] {
        let run = work.run(arguments);
        assert_eq!(run.code, Some(2), "{arguments}");
        assert!(run.stderr.contains(said), "{arguments}: {}", run.stderr);
    }
    assert_eq!(fs::read(work.path("lit.vdb")).unwrap(), b"old");
}
