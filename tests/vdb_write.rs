//! The VDB writer: what it writes is read back bit for bit, in every way of storing; its bytes do not
//! depend on the number of threads; the files of `tests/vdb_written/`, which the OpenVDB library has
//! read, are what it writes; what cannot be written is an error.

#[path = "vdb/support/answer.rs"]
mod answer;
#[path = "vdb_written/compare.rs"]
mod compare;
#[path = "vdb_written/gallery.rs"]
mod gallery;
#[path = "vdb/support/hash.rs"]
mod hash;
#[path = "vdb_written/random.rs"]
mod random;
#[path = "vdb/support/sampler.rs"]
mod sampler;

use std::io::Cursor;
use std::path::{Path, PathBuf};

use compare::{EVERY_OPTION, Value, check_same, expected};
use photonvdb::math::{DAffine3, DVec3};
use photonvdb::medium::vdb::{
    GridClass, GridProblem, GridSummary, GridToWrite, Limits, MetadataValue, SparseGrid, Tile,
    ValuesToWrite, VdbFile, VdbWriteError, VdbWriter, VolumeSource, WriteCompression, WriteOptions,
    write_vdb,
};
use proptest::prelude::*;

fn directory(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// The bytes of a file of these grids.
fn file_of(grids: &[GridToWrite<'_>], options: &WriteOptions) -> Result<Vec<u8>, VdbWriteError> {
    let names: Vec<&str> = grids.iter().map(|grid| grid.name).collect();
    let mut writer = VdbWriter::new(Cursor::new(Vec::new()), Path::new("memory"), &names, options)?;
    for grid in grids {
        writer.write_grid(grid)?;
    }
    Ok(writer.finish()?.into_inner())
}

/// A grid as read from a file.
enum Read {
    Float(SparseGrid<f32>),
    Vec3(SparseGrid<[f32; 3]>),
}

impl Read {
    fn from(file: &VdbFile, index: usize) -> Self {
        let limits = Limits::default();
        if file.grids()[index].is_usable_scalar() {
            Self::Float(file.load_scalar(index, &limits).unwrap())
        } else {
            Self::Vec3(file.load_vector(index, &limits).unwrap())
        }
    }

    fn to_write<'a>(&'a self, summary: &'a GridSummary) -> GridToWrite<'a> {
        let values = match self {
            Self::Float(grid) => ValuesToWrite::from(grid),
            Self::Vec3(grid) => ValuesToWrite::from(grid),
        };
        GridToWrite {
            class: GridClass::from_word(&summary.class),
            metadata: summary.metadata.clone(),
            ..GridToWrite::new(&summary.name, values)
        }
    }

    fn check(&self, read: &Self, half: bool) {
        match (self, read) {
            (Self::Float(source), Self::Float(read)) => check_same(&expected(source, half), read),
            (Self::Vec3(source), Self::Vec3(read)) => check_same(&expected(source, half), read),
            _ => panic!("the type of grid has changed"),
        }
    }
}

fn vdb_files(directory: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(directory).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "vdb"));
    paths.sort();
    paths
}

#[test]
fn every_committed_file_comes_back_in_every_way_of_storing() {
    let mut grid_count = 0;
    for path in vdb_files(&directory("tests/vdb")) {
        let file = VdbFile::open(&path).unwrap();
        let usable = (0..file.grids().len()).filter(|&i| file.grids()[i].unusable.is_none());
        let indices: Vec<usize> = usable.collect();
        let sources: Vec<Read> = indices.iter().map(|&index| Read::from(&file, index)).collect();
        let summaries: Vec<_> = indices.iter().map(|&index| &file.grids()[index]).collect();
        let grids: Vec<_> =
            sources.iter().zip(&summaries).map(|(read, summary)| read.to_write(summary)).collect();
        for options in EVERY_OPTION {
            let written = VdbFile::from_bytes(file_of(&grids, &options).unwrap()).unwrap();
            assert_eq!(written.grids().len(), grids.len());
            for (index, source) in sources.iter().enumerate() {
                check_summary(&written.grids()[index], summaries[index], &options);
                source.check(&Read::from(&written, index), options.half);
                grid_count += 1;
            }
        }
    }
    assert!(grid_count >= 8 * 35, "only {grid_count} grids");
}

fn check_summary(written: &GridSummary, source: &GridSummary, options: &WriteOptions) {
    assert_eq!(written.name, source.name);
    assert_eq!(written.class, source.class);
    assert_eq!(written.metadata, source.metadata);
    assert_eq!(written.index_to_world, source.index_to_world);
    assert_eq!(written.active_bbox, source.active_bbox);
    assert_eq!(written.active_voxel_count, source.active_voxel_count);
    assert_eq!(written.active_tile_count, source.active_tile_count);
    assert_eq!(written.leaf_count, source.leaf_count);
    assert_eq!(written.half, options.half);
    let words = match options.compression {
        WriteCompression::None => "none",
        WriteCompression::ActiveMask => "active values",
        WriteCompression::Zip => "zip + active values",
        WriteCompression::Blosc => "blosc + active values",
    };
    assert_eq!(written.compression, words);
    let is_scaled =
        ["UniformScaleMap", "ScaleMap", "UniformScaleTranslateMap", "ScaleTranslateMap"]
            .contains(&source.map.as_str());
    assert!(!is_scaled || written.map == source.map, "{} became {}", source.map, written.map);
}

fn check_round_trip<V: Value>(grid: &SparseGrid<V>)
where
    for<'g> ValuesToWrite<'g>: From<&'g SparseGrid<V>>,
{
    for options in EVERY_OPTION {
        let bytes = file_of(&[GridToWrite::new("grid", grid)], &options).unwrap();
        let file = VdbFile::from_bytes(bytes).unwrap();
        assert_eq!(file.grids()[0].index_to_world, Some(grid.index_to_world));
        check_same(&expected(grid, options.half), &V::load(&file, 0));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn random_grids_of_numbers_come_back(grid in random::grids(random::numbers())) {
        check_round_trip(&grid);
    }

    #[test]
    fn random_grids_of_vectors_come_back(
        grid in random::grids(prop::array::uniform3(random::numbers()))
    ) {
        check_round_trip(&grid);
    }
}

#[test]
fn bytes_are_the_same_for_any_number_of_threads() {
    let file = VdbFile::open(&directory("media/smoke_plume.vdb")).unwrap();
    let source = Read::from(&file, 0);
    let grid = source.to_write(&file.grids()[0]);
    for options in EVERY_OPTION {
        let written: Vec<Vec<u8>> = [1, 2, 7]
            .into_iter()
            .map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| file_of(&[grid.clone(), grid.clone()], &options).unwrap())
            })
            .collect();
        assert!(written.windows(2).all(|pair| pair[0] == pair[1]), "{options:?}");
    }
}

/// The order in which leaves and tiles are given is of no account; their content changes the UUID.
#[test]
fn bytes_depend_on_the_grid_alone() {
    let [density, ..] = gallery::scalars();
    let mut reversed = density.clone();
    reversed.leaves.reverse();
    reversed.masks.reverse();
    reversed.tiles.reverse();
    reversed.values = density.values.chunks(512).rev().flatten().copied().collect();
    let options = WriteOptions::default();
    let write = |grid: &SparseGrid<f32>| file_of(&[GridToWrite::new("a", grid)], &options).unwrap();
    assert_eq!(write(&reversed), write(&density));

    let uuid = |bytes: &[u8]| bytes[21..57].to_vec();
    let mut changed = density.clone();
    changed.values[100] += 1.0;
    assert_ne!(uuid(&write(&changed)), uuid(&write(&density)));
}

/// The OpenVDB library's answers about the files, and that they are what is written today. LZ4's
/// matches depend on the size of a machine word.
#[test]
#[cfg(all(target_pointer_width = "64", target_endian = "little"))]
fn files_that_the_library_has_read_are_what_is_written() {
    let directory = directory("tests/vdb_written");
    let files = gallery::files();
    if let Some(target) = std::env::var_os("PHOTONVDB_WRITE_GALLERY") {
        for (name, bytes) in &files {
            std::fs::write(Path::new(&target).join(name), bytes).unwrap();
        }
    }
    assert_eq!(vdb_files(&directory).len(), files.len());
    for (name, bytes) in files {
        let path = directory.join(&name);
        assert!(
            std::fs::read(&path).unwrap() == bytes,
            "{name} is written otherwise; see tests/vdb_written/README.md"
        );
        let grids = answer::check_file(&path).unwrap_or_else(|difference| {
            panic!("{name} is not what the library has read: {difference}")
        });
        println!("{name}: {}", grids.join("; "));
    }
}

/// A sound grid of one leaf and one tile.
fn sound() -> SparseGrid<f32> {
    SparseGrid {
        background: 0.0,
        index_to_world: DAffine3::from_scale(DVec3::splat(0.1)),
        leaves: vec![[0, 0, 0]],
        masks: vec![[1; 8]],
        values: vec![1.0; 512],
        tiles: vec![Tile { origin: [8, 0, 0], dim: 8, value: 2.0, active: true }],
    }
}

#[test]
fn grids_that_cannot_be_written_are_errors() {
    let problem = |change: &dyn Fn(&mut SparseGrid<f32>)| {
        let mut grid = sound();
        change(&mut grid);
        let result = file_of(&[GridToWrite::new("smoke", &grid)], &WriteOptions::default());
        match result.unwrap_err() {
            error @ VdbWriteError::Grid { .. } => {
                assert!(error.to_string().contains("\"smoke\" cannot be written to memory: "));
                let VdbWriteError::Grid { problem, .. } = error else { unreachable!() };
                problem
            }
            other => panic!("{other}"),
        }
    };
    let lengths = |masks, values| GridProblem::Lengths { leaves: 1, masks, values };
    assert_eq!(problem(&|grid| grid.values.truncate(511)), lengths(1, 511));
    assert_eq!(problem(&|grid| grid.masks.clear()), lengths(0, 512));
    let misaligned = GridProblem::Misaligned { origin: [0, 4, 0], dim: 8 };
    assert_eq!(problem(&|grid| grid.leaves[0] = [0, 4, 0]), misaligned);
    let misaligned = GridProblem::Misaligned { origin: [8, 0, 0], dim: 128 };
    assert_eq!(problem(&|grid| grid.tiles[0].dim = 128), misaligned);
    for dim in [0, 1, 16, 4097, u32::MAX] {
        let size = GridProblem::TileSize { origin: [8, 0, 0], dim };
        assert_eq!(problem(&|grid| grid.tiles[0].dim = dim), size);
    }
    let overlap = GridProblem::Overlap { voxel: [0; 3] };
    assert_eq!(problem(&|grid| grid.tiles[0].origin = [0; 3]), overlap);
    for value in [0.0, f64::NAN, f64::INFINITY] {
        let transform = problem(&|grid| grid.index_to_world.matrix3.x_axis.x = value);
        assert_eq!(transform, GridProblem::Transform);
    }
}

#[test]
fn names_and_metadata_of_the_writer_are_refused() {
    let grid = sound();
    let options = WriteOptions::default();
    for name in ["a\u{1e}0", &"long".repeat(20_000)] {
        let error = file_of(&[GridToWrite::new(name, &grid)], &options).unwrap_err();
        assert!(error.to_string().contains("its name"), "{error}");
    }
    for name in ["name", "class", "file_bbox_min", "is_saved_as_half_float"] {
        let mut grid = GridToWrite::new("smoke", &grid);
        grid.metadata.insert(name.into(), MetadataValue::float(1.0));
        let error = file_of(&[grid], &options).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
}

#[test]
fn other_grids_than_announced_are_an_error() {
    let grid = sound();
    let new = || {
        let output = Cursor::new(Vec::new());
        let options = WriteOptions::default();
        VdbWriter::new(output, Path::new("two.vdb"), &["smoke", "fire"], &options).unwrap()
    };
    let error = new().write_grid(&GridToWrite::new("fire", &grid)).unwrap_err();
    assert!(error.to_string().starts_with("two.vdb was to hold [\"smoke\", \"fire\"]"), "{error}");
    let mut writer = new();
    writer.write_grid(&GridToWrite::new("smoke", &grid)).unwrap();
    assert!(matches!(writer.finish(), Err(VdbWriteError::Order { got: None, .. })));
    let mut writer = new();
    for name in ["smoke", "fire"] {
        writer.write_grid(&GridToWrite::new(name, &grid)).unwrap();
    }
    assert!(writer.write_grid(&GridToWrite::new("", &grid)).is_err());
}

#[test]
fn a_file_that_cannot_be_written_leaves_the_old_one() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("smoke.vdb");
    let grid = sound();
    let options = WriteOptions::default();
    let written = write_vdb(&path, &[GridToWrite::new("a", &grid)], &options).unwrap();
    assert_eq!(written[0].unique_name, "a");
    assert_eq!(written[0].active_voxel_count, 8 + 512);
    let bytes = std::fs::read(&path).unwrap();

    let mut broken = sound();
    broken.leaves.clear();
    let grids = [GridToWrite::new("a", &grid), GridToWrite::new("a", &broken)];
    let error = write_vdb(&path, &grids, &options).unwrap_err();
    assert!(error.to_string().starts_with("grid \"a[1]\" cannot be written to "), "{error}");
    assert!(error.to_string().contains("smoke.vdb"), "{error}");
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);

    let absent = directory.path().join("absent/smoke.vdb");
    let error = write_vdb(&absent, &[], &options).unwrap_err();
    assert!(matches!(error, VdbWriteError::Write(_)));
    assert!(error.to_string().contains("cannot write"), "{error}");
}
