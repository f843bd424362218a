//! The built-in reader against `vdb-rs`, which knows nothing of it: every voxel, tile and transform of every
//! grid that `vdb-rs` reads right.
#![cfg(feature = "vdb-rs")]

#[path = "vdb/support/bytes.rs"]
mod bytes;

use std::path::Path;

use bytes::{committed, directory, files, larger_corpora};
use photonvdb::medium::vdb::{Limits, SparseGrid, VdbError, VdbFile, VdbRsFile, VolumeSource};

/// What came of the grids of some files.
#[derive(Debug, Default)]
struct Outcome {
    /// Grids that both readers read, leaves and tiles of these.
    compared: usize,
    leaves: usize,
    tiles: usize,
    /// What was said of the grids only the built-in reader reads.
    refusals: Vec<String>,
}

fn compare_directory(directory: &Path) -> Outcome {
    let mut outcome = Outcome::default();
    for path in files(directory) {
        // Files damaged by hand.
        let Ok(file) = VdbFile::open(&path) else { continue };
        let second = VdbRsFile::open(&path).unwrap();
        assert_eq!(second.grids().len(), file.grids().len());
        for (index, summary) in file.grids().iter().enumerate() {
            let Ok(grid) = file.load_scalar(index, &Limits::default()) else { continue };
            match second.load_scalar(index, &Limits::default()) {
                Ok(second) => {
                    assert_same(&grid, &second, &format!("{path:?}, {}", summary.unique_name));
                    outcome.compared += 1;
                    outcome.leaves += grid.leaves.len();
                    outcome.tiles += grid.tiles.len();
                }
                Err(VdbError::Unusable { reason, .. }) => outcome.refusals.push(reason),
                Err(error) => panic!("{error}"),
            }
        }
    }
    println!("{}: {} grids compared", directory.display(), outcome.compared);
    outcome
}

fn assert_same(grid: &SparseGrid<f32>, second: &SparseGrid<f32>, what: &str) {
    assert_eq!(grid.background.to_bits(), second.background.to_bits(), "{what}");
    assert_eq!(grid.index_to_world, second.index_to_world, "{what}");
    assert_eq!(grid.leaves, second.leaves, "{what}");
    assert_eq!(grid.masks, second.masks, "{what}");
    let bits = |grid: &SparseGrid<f32>| grid.values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert!(bits(grid) == bits(second), "values of {what}");
    let tiles = |grid: &SparseGrid<f32>| {
        let words = grid.tiles.iter().map(|t| (t.origin, t.dim, t.active, t.value.to_bits()));
        words.collect::<Vec<_>>()
    };
    assert_eq!(tiles(grid), tiles(second), "{what}");
}

#[test]
fn both_readers_read_the_committed_files_alike() {
    let outcome = compare_directory(&directory());
    assert!(outcome.compared >= 22 && outcome.leaves >= 657 && outcome.tiles >= 6, "{outcome:?}");
    for reason in [
        "holds double values",
        "saved as halves",
        "is a AffineMap",
        "background is not 0",
        "shares the tree",
        "written to a stream",
        "tiles at the root",
    ] {
        let count = outcome.refusals.iter().filter(|refusal| refusal.contains(reason)).count();
        assert!(count > 0, "none was refused for {reason:?}: {:?}", outcome.refusals);
    }
}

#[test]
fn both_readers_read_a_larger_corpus_alike() {
    for directory in larger_corpora() {
        assert!(compare_directory(&directory).compared > 0);
    }
}

#[test]
fn a_grid_that_would_be_misread_is_refused_by_name() {
    let file = VdbRsFile::from_bytes(committed("type_double")).unwrap();
    let reason =
        "it holds double values and vdb-rs reads only float and int32; read it with VdbFile";
    assert_eq!(file.grids()[0].unusable.as_deref(), Some(reason));
    let error = file.load_scalar(0, &Limits::default()).unwrap_err().to_string();
    assert_eq!(error, format!("grid \"density\" of the VDB in memory cannot be used: {reason}"));
    assert_eq!(file.load_vector(0, &Limits::default()).unwrap_err().to_string(), error);
    assert!(matches!(
        file.load_scalar(1, &Limits::default()),
        Err(VdbError::NoSuchIndex { index: 1, count: 1, .. })
    ));
    let float = VdbRsFile::from_bytes(committed("checkerboard")).unwrap();
    let error = float.load_vector(0, &Limits::default()).unwrap_err().to_string();
    assert!(error.contains("holds float values where vectors are wanted"), "{error}");
}

#[test]
fn the_memory_limit_holds_for_both() {
    let file = VdbRsFile::from_bytes(committed("checkerboard")).unwrap();
    let needed = file.grids()[0].memory_bytes;
    file.load_scalar(0, &Limits { max_bytes: needed }).unwrap();
    let error = file.load_scalar(0, &Limits { max_bytes: needed - 1 }).unwrap_err();
    assert!(matches!(error, VdbError::TooLarge { .. }), "{error}");
}
