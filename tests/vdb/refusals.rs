//! What cannot be read is refused in words that name the file, the grid and the way out.

use photonvdb::medium::vdb::{
    Limits, SparseGrid, VdbError, VdbFile, VolumeSource, find_density, sanitize_density,
};

use crate::support::bytes::{committed, directory};

/// Puts the bytes in the place of others as long, wherever they occur; there must be one at least.
fn replace(file: &mut [u8], from: &[u8], to: &[u8]) {
    assert_eq!(from.len(), to.len());
    let starts: Vec<usize> =
        (0..=file.len() - from.len()).filter(|&at| file[at..].starts_with(from)).collect();
    assert!(!starts.is_empty());
    for at in starts {
        file[at..at + to.len()].copy_from_slice(to);
    }
}

/// The file with another version of the format in its header.
fn with_version(mut file: Vec<u8>, version: u32) -> Vec<u8> {
    file[8..12].copy_from_slice(&version.to_le_bytes());
    file
}

fn open(name: &str) -> VdbFile {
    VdbFile::from_bytes(committed(name)).unwrap()
}

fn message(result: Result<impl Sized, VdbError>) -> String {
    match result {
        Ok(_) => panic!("it was read"),
        Err(error) => error.to_string(),
    }
}

fn load_first(file: Vec<u8>) -> Result<SparseGrid<f32>, VdbError> {
    VdbFile::from_bytes(file)?.load_scalar(0, &Limits::default())
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let error = message(VdbFile::open(&directory().join("absent.vdb")));
    assert!(error.starts_with("cannot read ") && error.contains("absent.vdb"), "{error}");
}

#[test]
fn a_directory_is_not_read() {
    assert!(VdbFile::open(&directory()).is_err());
}

#[test]
fn a_file_of_another_kind_is_named() {
    let error = message(VdbFile::open(&directory().join("README.md")));
    assert!(
        error.ends_with("README.md is not an OpenVDB file; give a file saved as .vdb"),
        "{error}"
    );
    for bytes in [&b""[..], b" BDV", b"PK\x03\x04 a zip archive"] {
        let error = message(VdbFile::from_bytes(bytes.to_vec()));
        assert!(error.contains("is not an OpenVDB file"), "{error}");
    }
}

#[test]
fn versions_222_to_225_are_read_and_others_named() {
    for version in 222..=225 {
        load_first(with_version(committed("checkerboard"), version)).unwrap();
    }
    for version in [0, 213, 221, 226, u32::MAX] {
        let error = message(load_first(with_version(committed("checkerboard"), version)));
        assert!(
            error.contains(&format!("file version {version} and versions 222 to 225")),
            "{error}"
        );
    }
}

#[test]
fn grids_that_are_not_of_numbers_are_refused_by_name() {
    let cases = [
        ("points", "grid \"points\"", "it holds points; rasterise"),
        ("type_bool", "grid \"density\"", "it holds bool values; convert"),
        ("type_mask", "grid \"density\"", "it holds mask values; convert"),
        ("tree_4_3_2", "grid \"density\"", "Tree_float_4_3_2 and only 5-4-3 trees"),
        ("tree_5_4", "grid \"density\"", "Tree_float_5_4 and only 5-4-3 trees"),
        ("tree_5_5_4_3", "grid \"density\"", "Tree_float_5_5_4_3 and only 5-4-3 trees"),
        ("xf_frustum", "grid \"density\"", "a camera's frustum"),
    ];
    for (file, grid, reason) in cases {
        let file = open(file);
        assert_eq!(file.grids().len(), 1);
        let error = message(file.load_scalar(0, &Limits::default()));
        assert!(error.starts_with(grid) && error.contains(reason), "{error}");
        let name = file.grids()[0].name.clone();
        assert_eq!(message(find_density(&file, &name, true)), error);
    }
}

#[test]
fn vectors_are_not_numbers_and_numbers_no_vectors() {
    let velocity = open("instanced_vec3s");
    let error = message(velocity.load_scalar(0, &Limits::default()));
    assert!(error.contains("holds vec3s values where numbers are wanted"), "{error}");
    assert_eq!(message(find_density(&velocity, "velocity", true)), error);
    let error = message(open("checkerboard").load_vector(0, &Limits::default()));
    assert!(error.contains("holds float values where vectors are wanted"), "{error}");
    let error = message(open("checkerboard").load_stored::<f64>(0, &Limits::default()));
    assert!(error.contains("holds float values where double are wanted"), "{error}");
    let error = message(open("checkerboard").load_scalar(1, &Limits::default()));
    assert!(error.contains("has no grid number 1; it has 1"), "{error}");
}

#[test]
fn a_level_set_is_listed_and_read_but_is_no_density() {
    let file = open("levelset_mask");
    assert!(file.grids()[0].is_level_set());
    file.load_scalar(0, &Limits::default()).unwrap();
    let error = message(find_density(&file, "surface", true));
    assert!(error.contains("is a level set") && error.contains("--sdf-to-fog"), "{error}");
    let error = message(find_density(&file, "density", false));
    assert!(error.contains("\"surface\" (float, level set)"), "{error}");
}

#[test]
fn a_grid_that_is_not_there_gets_the_names_of_those_that_are() {
    let file = open("density_after_points");
    let error = message(find_density(&file, "desnity", true));
    assert!(error.contains("has no grid \"desnity\""), "{error}");
    assert!(
        error.contains("\"density\" (float)") && error.contains("\"points\" (points)"),
        "{error}"
    );
    let error = message(find_density(&open("no_grids"), "density", false));
    assert!(error.contains("no grids at all"), "{error}");
}

#[test]
fn the_only_float_grid_serves_when_none_was_named() {
    let utf8 = open("utf8_name");
    assert_eq!(find_density(&utf8, "density", false).unwrap(), 0);
    assert!(find_density(&utf8, "density", true).is_err());
    let two = open("instanced");
    let by_name = find_density(&two, "density_instance", true).unwrap();
    assert_eq!(two.grids()[by_name].name, "density_instance");
    assert!(find_density(&two, "absent", false).is_err());
}

#[test]
fn an_instance_without_its_parent_is_refused_and_the_parent_read() {
    let mut bytes = committed("instanced");
    // The parent's unique name, as a whole string: the entry of the instance has it last.
    let name = b"\x07\0\0\0density";
    let last = bytes.windows(name.len()).rposition(|window| window == name).unwrap();
    let entry = bytes.windows(16).position(|window| window == b"density_instance").unwrap();
    let parent =
        entry + bytes[entry..].windows(name.len()).position(|window| window == name).unwrap();
    assert!(parent <= last);
    bytes[parent + 4] = b'D';
    let file = VdbFile::from_bytes(bytes).unwrap();
    let index = |name| file.grids().iter().position(|grid| grid.name == name).unwrap();
    let error = message(file.load_scalar(index("density_instance"), &Limits::default()));
    assert!(
        error.contains("it shares the tree of a grid \"Density\" that is not there"),
        "{error}"
    );
    file.load_scalar(index("density"), &Limits::default()).unwrap();
}

#[test]
fn a_file_cut_short_still_gives_the_grids_before_the_cut() {
    let mut bytes = committed("density_after_points");
    bytes.truncate(bytes.len() - 100);
    let file = VdbFile::from_bytes(bytes).unwrap();
    let states: Vec<_> =
        file.grids().iter().map(|grid| (&*grid.name, grid.unusable.clone())).collect();
    let cut = states.iter().find(|(name, _)| *name == "density").unwrap();
    assert_eq!(cut.1.as_deref(), Some("it is damaged (it ends inside a grid); export it again"));

    let mut bytes = committed("stream_no_offsets");
    bytes.truncate(bytes.len() / 2);
    let error = message(load_first(bytes));
    assert!(error.contains("it ends inside"), "{error}");
}

#[test]
fn an_unknown_compression_or_transform_is_named() {
    let mut bytes = committed("checkerboard");
    replace(&mut bytes, b"UniformScaleMap", b"UniformSpaceMap");
    let error = message(load_first(bytes));
    assert!(error.contains("unknown kind \"UniformSpaceMap\""), "{error}");
}

#[test]
fn memory_is_compared_with_the_limit_before_it_is_taken() {
    let file = open("type_double");
    let needed = file.grids()[0].memory_bytes;
    let grid = file.load_scalar(0, &Limits { max_bytes: needed }).unwrap();
    assert_eq!(needed, 38 * (512 * 4 + 64 + 12));
    assert_eq!(grid.leaves.len(), 38);
    let error = message(file.load_scalar(0, &Limits { max_bytes: needed - 1 }));
    assert!(error.contains("needs 78.8 KiB of memory and the limit is 78.8 KiB; raise"), "{error}");
}

/// Two edits of a Blosc frame that make a reader trusting it write past its buffer.
#[test]
fn blosc_frames_that_lie_about_their_length_are_errors() {
    // A frame of 2048 bytes of values of 4, packed to 533 bytes with its bytes shuffled.
    let header = |flags: u8, unpacked: u32, packed: u32| {
        let mut header = vec![2, 1, flags, 4];
        [unpacked, 2048, packed].iter().for_each(|length| header.extend(length.to_le_bytes()));
        header
    };
    let sound = header(0x21, 2048, 533);
    for lie in [header(0x23, 0x10_0000, 0x10_0010), header(0x21, 0x3_0800, 533)] {
        let mut bytes = committed("smoke_blosc");
        replace(&mut bytes, &sound, &lie);
        let error = message(load_first(bytes));
        assert!(error.contains("a Blosc frame of the wrong length"), "{error}");
    }
}

#[test]
fn values_that_are_no_density_are_counted() {
    let file = open("nan_inf_neg");
    let mut grid = file.load_scalar(0, &Limits::default()).unwrap();
    assert!(grid.values.iter().any(|value| value.is_nan()));
    let count = sanitize_density(&mut grid);
    assert!(count.nan > 0 && count.infinite > 0 && count.negative > 0, "{count:?}");
    assert!(grid.values.iter().all(|&value| (0.0..f32::INFINITY).contains(&value)));
}
