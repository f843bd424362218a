//! Files written to a stream, where each grid must be walked over to find the next.

use photonvdb::medium::vdb::{Limits, SparseGrid, VdbFile, VolumeSource};

use crate::support::bytes::committed;
use crate::support::hash::{Bits, hashes};
use crate::support::stream::stream_of;

/// Every type of voxel and every way of packing.
const GRIDS: [&str; 15] = [
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
    "vec3s_only",
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
            "vec3s" => {
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
