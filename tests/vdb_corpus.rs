//! Every file of `tests/vdb/` against the OpenVDB library's own answer: every voxel and tile by
//! hash, counts, bounds, transform, samples, lookups between voxels. The larger corpus is checked
//! too where it is present.

#[path = "vdb/refusals.rs"]
mod refusals;
#[path = "vdb/streams.rs"]
mod streams;
#[path = "vdb/support/mod.rs"]
mod support;

use std::path::Path;

use photonvdb::medium::vdb::{Limits, VdbFile, VolumeSource, find_density, sanitize_density};
use support::answer::check_file;
use support::bytes::{directory, files, larger_corpora};

/// Checks all files that have an answer beside them.
fn check_directory(directory: &Path) -> usize {
    let files: Vec<_> =
        files(directory).into_iter().filter(|path| path.with_extension("json").exists()).collect();
    let mut differences = Vec::new();
    for path in &files {
        let name = path.file_name().unwrap().display().to_string();
        match check_file(path) {
            Ok(grids) => println!("{name}: {}", grids.join("; ")),
            Err(difference) => differences.push(format!("{name}: {difference}")),
        }
    }
    assert!(differences.is_empty(), "{}", differences.join("\n"));
    files.len()
}

#[test]
fn committed_files_are_read_as_the_library_reads_them() {
    let count = check_directory(&directory());
    assert!(count >= 75, "only {count} files");
}

#[test]
fn a_larger_corpus_is_read_as_the_library_reads_it() {
    for directory in larger_corpora() {
        let count = check_directory(&directory);
        println!("{count} files in {}", directory.display());
        assert!(count > 0);
    }
}

/// The volumes scenes start from: sound, usable, and as many voxels as `media/README.md` says.
#[test]
fn media_can_be_used_as_they_are() {
    for (name, active_count) in [("smoke_plume", 119_778), ("fire", 193_759), ("cloud", 235_542)] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("media").join(name);
        let file = VdbFile::open(&path.with_extension("vdb")).unwrap();
        let index = find_density(&file, "density", false).unwrap();
        assert_eq!(file.grids()[index].active_voxel_count, active_count, "{name}");
        let mut grid = file.load_scalar(index, &Limits::default()).unwrap();
        assert_eq!(sanitize_density(&mut grid).total(), 0, "{name}");
    }
}
