//! From a file to bricks, stage by stage. `cargo bench --bench load`; `PHOTONVDB_BENCH_VDB=file` measures another
//! file than the cloud of `media/`.

use std::path::PathBuf;

use divan::{Bencher, counter::BytesCount};
use photonvdb::medium::{
    grid::{BrickPrecision, DensityGrid},
    vdb::{Limits, SparseGrid, VdbFile, VolumeSource, find_density, sanitize_density},
};

fn main() {
    divan::main();
}

fn path() -> PathBuf {
    let cloud = || concat!(env!("CARGO_MANIFEST_DIR"), "/media/cloud.vdb").into();
    std::env::var_os("PHOTONVDB_BENCH_VDB").map_or_else(cloud, PathBuf::from)
}

fn file() -> (VdbFile, usize) {
    let file = VdbFile::open(&path()).expect("a VDB file");
    let index = find_density(&file, "density", false).expect("a density grid");
    (file, index)
}

fn voxels() -> SparseGrid<f32> {
    let (file, index) = file();
    file.load_scalar(index, &Limits::default()).expect("a sound grid")
}

/// Reading, hashing and listing the file.
#[divan::bench]
fn open(bencher: Bencher) {
    let path = path();
    let bytes = std::fs::metadata(&path).map_or(0, |metadata| metadata.len());
    bencher.counter(BytesCount::new(bytes)).bench(|| VdbFile::open(&path));
}

/// Unpacking the voxels.
#[divan::bench]
fn load(bencher: Bencher) {
    let (file, index) = file();
    let bytes = file.grids()[index].memory_bytes;
    let limits = Limits::default();
    bencher.counter(BytesCount::new(bytes)).bench(|| file.load_scalar(index, &limits));
}

/// Finding that all values are densities.
#[divan::bench]
fn sanitize(bencher: Bencher) {
    let mut voxels = voxels();
    let bytes = voxels.memory_bytes();
    bencher.counter(BytesCount::new(bytes)).bench_local(|| sanitize_density(&mut voxels));
}

/// From voxels to bricks.
#[divan::bench(args = [BrickPrecision::Single, BrickPrecision::Half])]
fn build(bencher: Bencher, precision: BrickPrecision) {
    let voxels = voxels();
    let limits = Limits::default();
    bencher
        .counter(BytesCount::new(voxels.memory_bytes()))
        .bench(|| DensityGrid::build(&voxels, precision, &limits));
}

/// All of it, everything dropped as soon as it has served.
#[divan::bench]
fn file_to_bricks(bencher: Bencher) {
    let limits = Limits::default();
    bencher.bench(|| {
        let (file, index) = file();
        let mut voxels = file.load_scalar(index, &limits).expect("a sound grid");
        drop(file);
        sanitize_density(&mut voxels);
        DensityGrid::build(&voxels, BrickPrecision::Single, &limits)
    });
}
