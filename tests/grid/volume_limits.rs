//! Memory of volumes: counted before it is taken, from the file to the bricks.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::grid_support::{Voxels, cloud};
use photonvdb::medium::{
    grid::{BrickPrecision, DensityGrid, DensityGridError},
    vdb::{Limits, SparseGrid, VdbError, VdbFile, VolumeSource},
};

const PRECISIONS: [BrickPrecision; 2] = [BrickPrecision::Single, BrickPrecision::Half];

fn media(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("media").join(name)
}

/// The files the reader is tested on.
fn committed() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vdb")
}

fn within(max_bytes: u64) -> Limits {
    Limits { max_bytes }
}

#[test]
fn a_file_larger_than_the_limit_is_not_read() {
    let path = media("cloud.vdb");
    let size = std::fs::metadata(&path).unwrap().len();
    VdbFile::open_within(&path, &within(size)).unwrap();
    let error = VdbFile::open_within(&path, &within(size - 1)).unwrap_err();
    assert!(matches!(error, VdbError::FileTooLarge { .. }));
    let message = error.to_string();
    for part in ["cloud.vdb holds ", " and the limit on memory is ", "--max-volume-memory"] {
        assert!(message.contains(part), "{message}");
    }
    // A sparse file of 8 TiB, of which not a byte is stored but the first.
    let folder = tempfile::tempdir().unwrap();
    let huge = folder.path().join("huge.vdb");
    std::fs::copy(&path, &huge).unwrap();
    let file = std::fs::OpenOptions::new().write(true).open(&huge).unwrap();
    if file.set_len(8 << 40).is_ok() {
        let error = VdbFile::open(&huge).unwrap_err().to_string();
        assert!(error.contains("huge.vdb holds 8192.0 GiB"), "{error}");
    }
}

#[test]
fn the_bytes_of_the_file_count_while_a_grid_is_read() {
    let path = media("smoke_plume.vdb");
    let file = VdbFile::open(&path).unwrap();
    let needed = std::fs::metadata(&path).unwrap().len() + file.grids()[0].memory_bytes;
    file.load_scalar(0, &within(needed)).unwrap();
    let error = file.load_scalar(0, &within(needed - 1)).unwrap_err();
    match &error {
        VdbError::TooLarge { needed: told, limit, .. } => {
            assert_eq!((*told, *limit), (needed, needed - 1));
        }
        other => panic!("{other}"),
    }
    assert!(error.to_string().contains("--max-volume-memory"), "{error}");
}

/// What a summary says is what a grid takes, tiles of both kinds included.
#[test]
fn summaries_tell_the_memory_of_grids() {
    let mut inactive_count = 0;
    for entry in std::fs::read_dir(committed()).unwrap() {
        let path = entry.unwrap().path();
        let Ok(file) = VdbFile::open(&path) else { continue };
        for (index, summary) in file.grids().iter().enumerate() {
            let Ok(grid) = file.load_scalar(index, &Limits::default()) else { continue };
            inactive_count += grid.tiles.iter().filter(|tile| !tile.active).count();
            // A tile of a double has room for padding that one of a float has not.
            let slack = 4 * grid.tiles.len() as u64;
            let told = summary.memory_bytes;
            assert!(
                (grid.memory_bytes()..=grid.memory_bytes() + slack).contains(&told),
                "{}: {told} for {}",
                path.display(),
                grid.memory_bytes()
            );
        }
    }
    assert!(inactive_count > 0);
}

/// The smallest limit a grid can be built within.
fn threshold(sparse: &SparseGrid<f32>, precision: BrickPrecision) -> u64 {
    let fits = |max_bytes| match DensityGrid::build(sparse, precision, &within(max_bytes)) {
        Ok(grid) => {
            let held = sparse.memory_bytes() + grid.statistics().memory_bytes as u64;
            assert!(held <= max_bytes + 4096, "{held} of {max_bytes}");
            true
        }
        Err(DensityGridError::TooLarge { needed, limit }) => {
            assert!(needed > limit && limit == max_bytes);
            false
        }
        Err(other) => panic!("{other}"),
    };
    let (mut low, mut high) = (0, 1 << 32);
    assert!(!fits(low) && fits(high));
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if fits(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

#[test]
fn a_limit_just_enough_is_enough() {
    let sparse = cloud(20).sparse();
    let [single, half] = PRECISIONS.map(|precision| threshold(&sparse, precision));
    let grid = DensityGrid::build(&sparse, BrickPrecision::Single, &within(single)).unwrap();
    assert!(DensityGrid::build(&sparse, BrickPrecision::Single, &within(single - 1)).is_err());
    // Little is counted that is not kept.
    let statistics = grid.statistics();
    let kept = sparse.memory_bytes() + statistics.memory_bytes as u64;
    assert!(single as f64 <= 1.1 * kept as f64, "{single} for {kept}");
    assert_eq!(single - half, statistics.brick_count as u64 * 729 * 2);
}

/// Single voxels where eight regions meet, as far from one another as can be.
fn scattered(count: i32) -> SparseGrid<f32> {
    let mut voxels = Voxels::default();
    for n in 0..count {
        let along = |sign: bool| {
            let steps = (1 << 23) - n;
            128 * if sign { steps } else { -steps }
        };
        voxels.set([along(n & 1 == 0), along(n & 2 == 0), along(n & 4 == 0)], 1.0);
    }
    voxels.sparse()
}

#[test]
fn scattered_leaves_stay_within_the_limit() {
    let sparse = scattered(50);
    let grid = DensityGrid::from_sparse(&sparse);
    let statistics = grid.statistics();
    // Eight tables a leaf, and eight bricks.
    assert_eq!(statistics.brick_count, 8 * 50);
    assert!(statistics.memory_bytes > 400 * (16384 + 4 * 729), "{statistics:?}");
    for precision in PRECISIONS {
        let needed = threshold(&sparse, precision);
        assert!(needed < 2 * statistics.memory_bytes as u64, "{needed}");
    }

    // 600 MB of tables and bricks from 9 MB of leaves: refused before any of it is taken.
    let sparse = scattered(4000);
    let start = Instant::now();
    let error = DensityGrid::build(&sparse, BrickPrecision::Single, &within(64 << 20)).unwrap_err();
    assert!(start.elapsed() < Duration::from_secs(5));
    let message = error.to_string();
    for part in ["of memory", "the limit is 64.0 MiB", "--max-volume-memory"] {
        assert!(message.contains(part), "{message}");
    }
}
