//! `photonvdb convert` through the binary.

use std::fs;

use crate::run::{Run, Workspace};
use photonvdb::medium::vdb::{GridSummary, IndexBox, Limits, SparseGrid, VdbFile, VolumeSource};

const FILES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/vdb/");

/// Runs `photonvdb convert` on a committed file.
fn convert(work: &Workspace, file: &str, arguments: &str) -> Run {
    work.run(&format!("convert {FILES}{file} {arguments}"))
}

fn grids(work: &Workspace, name: &str) -> Vec<GridSummary> {
    VdbFile::open(&work.path(name)).unwrap().grids().to_vec()
}

fn load(path: &std::path::Path) -> SparseGrid<f32> {
    VdbFile::open(path).unwrap().load_scalar(0, &Limits::default()).unwrap()
}

fn same_bits(one: &[f32], other: &[f32]) -> bool {
    one.iter().map(|value| value.to_bits()).eq(other.iter().map(|value| value.to_bits()))
}

#[test]
fn a_grid_keeps_everything_but_its_packing() {
    let work = Workspace::new();
    let source = load(format!("{FILES}smoke_blosc.vdb").as_ref());
    for compression in ["none", "mask", "zip", "blosc"] {
        let run = convert(
            &work,
            "smoke_blosc.vdb",
            &format!("-o out.vdb --grid density --compression {compression}"),
        );
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        assert_eq!(run.stdout, "");
        let size = fs::metadata(work.path("out.vdb")).unwrap().len();
        let said = format!("wrote out.vdb: 1 grid, 32032 active voxels, 280733 bytes -> {size}");
        assert!(run.stderr.contains(&said), "{}", run.stderr);
        let grid = load(&work.path("out.vdb"));
        assert_eq!((&grid.leaves, &grid.masks), (&source.leaves, &source.masks));
        assert!(same_bits(&grid.values, &source.values));
        assert_eq!(grid.index_to_world, source.index_to_world);
        assert_eq!(grids(&work, "out.vdb")[0].class, "fog volume");
    }
    assert_eq!(work.names(), ["fog.toml", "out.vdb"]);
}

#[test]
fn half_is_smaller_and_says_so() {
    let work = Workspace::new();
    convert(&work, "smoke_blosc.vdb", "-o full.vdb");
    convert(&work, "smoke_blosc.vdb", "-o half.vdb --half");
    let size = |name: &str| fs::metadata(work.path(name)).unwrap().len();
    assert!(size("half.vdb") < size("full.vdb") * 9 / 10);
    assert!(grids(&work, "half.vdb")[0].half && !grids(&work, "full.vdb")[0].half);
    // What is half stays half.
    work.run("convert half.vdb -o again.vdb --compression zip");
    assert!(grids(&work, "again.vdb")[0].half);
    work.run("convert again.vdb -o same.vdb");
    assert_eq!(fs::read(work.path("same.vdb")).unwrap(), fs::read(work.path("half.vdb")).unwrap());
}

#[test]
fn other_types_become_float() {
    let work = Workspace::new();
    for file in ["type_double.vdb", "type_int32.vdb", "type_int64.vdb", "type_vec3s_half.vdb"] {
        let run = convert(&work, file, "-o out.vdb");
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        let expected = if file.contains("vec") { "vec3s" } else { "float" };
        assert_eq!(grids(&work, "out.vdb")[0].value_type, expected);
    }
    assert_eq!(grids(&work, "out.vdb")[0].name, "velocity");
}

#[test]
fn grids_are_chosen_by_name_and_the_rest_is_left() {
    let work = Workspace::new();
    convert(&work, "instanced.vdb", "-o all.vdb");
    let all: Vec<String> =
        grids(&work, "all.vdb").iter().map(|grid| grid.unique_name.clone()).collect();
    assert_eq!(all.len(), 2, "{all:?}");
    let last = &all[1];
    let run =
        work.run(&format!("convert all.vdb -o one.vdb --grid {last} --grid {last} --rename smoke"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert_eq!(grids(&work, "one.vdb").len(), 1);
    assert_eq!(grids(&work, "one.vdb")[0].unique_name, "smoke");
    work.run("convert all.vdb -o one.vdb --rename smoke").fails_with("--rename is for one grid");
    work.run("convert all.vdb -o one.vdb --grid wind").fails_with("has no grid \"wind\"");
}

#[test]
fn what_cannot_be_converted_is_skipped_or_refused() {
    let work = Workspace::new();
    let run = convert(&work, "density_after_points.vdb", "-o out.vdb");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(run.stderr.contains("skipping grid \"points\": it holds points"), "{}", run.stderr);
    assert_eq!(grids(&work, "out.vdb").len(), 1);
    convert(&work, "density_after_points.vdb", "-o new.vdb --grid points")
        .fails_with("it holds points");
    let nothing = convert(&work, "type_bool.vdb", "-o new.vdb");
    assert_eq!(nothing.code, Some(2));
    assert!(nothing.stderr.contains("has no grid that can be converted"), "{}", nothing.stderr);
    convert(&work, "smoke_blosc.vdb", "-o out.exr").fails_with("must end in .vdb");
    convert(&work, "smoke_blosc.vdb", "-o absent/out.vdb").fails_with("absent does not exist");
    work.run("convert fog.toml -o new.vdb").fails_with("fog.toml is not an OpenVDB file");
    assert_eq!(work.names(), ["fog.toml", "out.vdb"]);
}

#[test]
fn a_crop_keeps_the_voxels_of_the_box() {
    let work = Workspace::new();
    let run = convert(&work, "smoke_blosc.vdb", "-o out.vdb --crop -5,-24,3,6,9,1000000");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let bounds = IndexBox { min: [-5, -24, 3], max: [6, 9, 1_000_000] };
    let source = load(format!("{FILES}smoke_blosc.vdb").as_ref());
    let active = |grid: &SparseGrid<f32>| {
        let mut voxels = Vec::new();
        for (leaf, origin) in grid.leaves.iter().enumerate() {
            for offset in
                (0..512).filter(|offset| grid.masks[leaf][offset >> 6] >> (offset & 63) & 1 == 1)
            {
                let place = [offset >> 6, offset >> 3 & 7, offset & 7];
                let voxel: [i32; 3] = std::array::from_fn(|axis| origin[axis] + place[axis] as i32);
                voxels.push((voxel, grid.values[512 * leaf + offset].to_bits()));
            }
        }
        voxels.sort_unstable();
        voxels
    };
    let mut expected = active(&source);
    expected.retain(|(voxel, _)| {
        (0..3).all(|axis| bounds.min[axis] <= voxel[axis] && voxel[axis] <= bounds.max[axis])
    });
    assert!(expected.len() > 1000);
    assert_eq!(active(&load(&work.path("out.vdb"))), expected);
    let said = format!("{} of 32032 active voxels", expected.len());
    assert!(run.stderr.contains(&said), "{}", run.stderr);

    for (text, said) in [
        ("1,2,3", "is not a box"),
        ("a,0,0,1,1,1", "is not a box"),
        ("0,0,0,1,1,99999999999", "is not a box"),
        ("0,0,0,1,-1,1", "holds no voxel"),
    ] {
        convert(&work, "smoke_blosc.vdb", &format!("-o new.vdb --crop {text}")).fails_with(said);
    }
}

#[test]
fn a_large_tile_is_cropped_to_smaller_ones() {
    let work = Workspace::new();
    let run = convert(&work, "tiles_root_active.vdb", "-o out.vdb --crop 128,0,0,4095,4095,255");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert_eq!(grids(&work, "out.vdb")[0].active_voxel_count, (4096 - 128) * 4096 * 256);
}

#[test]
fn the_file_that_is_read_may_be_written() {
    let work = Workspace::new();
    fs::copy(format!("{FILES}smoke_blosc.vdb"), work.path("smoke.vdb")).unwrap();
    let run = work.run("convert smoke.vdb -o smoke.vdb --compression zip --rename smoke");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert_eq!(grids(&work, "smoke.vdb")[0].unique_name, "smoke");
    let before = fs::read(work.path("smoke.vdb")).unwrap();
    work.run("convert smoke.vdb -o smoke.vdb --grid fire").fails_with("no grid \"fire\"");
    assert_eq!(fs::read(work.path("smoke.vdb")).unwrap(), before);
}
