//! Files written to a stream, where each grid must be walked over to find the next.

use photonvdb::medium::vdb::{Limits, SparseGrid, VdbFile, VolumeSource};

use crate::support::bytes::committed;
use crate::support::hash::{Bits, hashes};
use crate::support::stream::stream_of;

/// Every type of voxel and every way of packing.
const GRIDS: [&str; 18] = [
    "type_bool",
    "checkerboard",
    "type_mask",
    "type_double_half",
    "type_int64",
    "realzip",
    "realzip_half_mask",
    "smoke_blosc",
    "levelset_mask",
    "fog_sphere_half",
    "tiles_root_active",
    "type_vec3s_half",
    "type_vec3d",
    "half_grid_zip_mask",
    "half_grid_blosc_mask",
    "xf_frustum",
    "empty_bg",
    "xf_rotated",
];

#[test]
fn every_grid_of_a_stream_is_the_one_it_was_made_of() {
    let files = GRIDS.map(committed);
    let stream = VdbFile::from_bytes(stream_of(&files)).unwrap();
    assert_eq!(stream.damage(), None);
    assert_eq!(stream.grids().len(), GRIDS.len());
    for (index, (name, file)) in GRIDS.into_iter().zip(files).enumerate() {
        let alone = VdbFile::from_bytes(file).unwrap();
        assert_eq!(stream.grids()[index], alone.grids()[0], "{name}");
        match alone.grids()[0].value_type.as_str() {
            _ if alone.grids()[0].unusable.is_some() => {}
            "vec3s" | "vec3d" => {
                let read =
                    |file: &VdbFile, index| file.load_vector(index, &Limits::default()).unwrap();
                assert_same(&read(&stream, index), &read(&alone, 0));
            }
            _ => {
                let read =
                    |file: &VdbFile, index| file.load_scalar(index, &Limits::default()).unwrap();
                assert_same(&read(&stream, index), &read(&alone, 0));
            }
        }
    }
}

fn assert_same<V: Bits>(grid: &SparseGrid<V>, alone: &SparseGrid<V>) {
    assert_eq!(hashes(grid), hashes(alone));
    assert_eq!(grid.background.bits(), alone.background.bits());
    assert_eq!(grid.index_to_world, alone.index_to_world);
    assert_eq!(grid.tiles.len(), alone.tiles.len());
}

#[test]
fn a_stream_says_that_grids_are_hidden_behind_one_it_cannot_walk() {
    let files = ["checkerboard", "points", "tiles_root_active"].map(committed);
    let stream = VdbFile::from_bytes(stream_of(&files)).unwrap();
    let names: Vec<_> = stream.grids().iter().map(|grid| grid.name.as_str()).collect();
    assert_eq!(names, ["density", "points"]);
    assert!(stream.damage().is_some());
    stream.load_scalar(0, &Limits::default()).unwrap();
}

/// The text with its length before it, as files have it.
fn told(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
}

/// Whether values are halves stands in a grid's metadata; the library does not look at the entry.
#[test]
fn the_metadata_says_what_is_half() {
    const NAMES: [&str; 2] = ["Tree_float_5_4_3", "Tree_float_5_4_3_HalfFloat"];
    for (name, [before, after]) in
        [("checkerboard", NAMES), ("half_tiles_zip_mask", [NAMES[1], NAMES[0]])]
    {
        let stream = stream_of(&[committed(name)]);
        let (before, after) = (told(before), told(after));
        let at = stream.windows(before.len()).position(|window| window == before).unwrap();
        let renamed = [&stream[..at], &after, &stream[at + before.len()..]].concat();
        let [sound, renamed] = [stream, renamed].map(|bytes| VdbFile::from_bytes(bytes).unwrap());
        assert_eq!(renamed.grids(), sound.grids());
        let read = |file: &VdbFile| file.load_scalar(0, &Limits::default()).unwrap();
        assert_same(&read(&renamed), &read(&sound));
    }
}
