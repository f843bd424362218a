//! Level sets filled with fog, bit for bit as `tools::sdfToFogVolume` of the OpenVDB library fills them. Its answers,
//! and the program that asked for them, are in `tests/vdb_fog/`.

#[path = "vdb/support/hash.rs"]
mod hash;

use std::path::{Path, PathBuf};

use hash::hashes;
use photonvdb::medium::vdb::{
    Limits, SparseGrid, VdbFile, VolumeSource, find_density, find_density_or_level_set,
    fog_of_level_set, sanitize_density,
};
use serde_json::Value;

fn tests() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests")
}

fn level_set(name: &str) -> SparseGrid<f32> {
    let own = tests().join("vdb_fog").join(name);
    let path = if own.exists() { own } else { tests().join("vdb").join(name) };
    let file = VdbFile::open(&path).unwrap();
    assert!(find_density(&file, "surface", true).is_err());
    let index = find_density_or_level_set(&file, "density", false).unwrap();
    assert!(file.grids()[index].is_level_set());
    file.load_scalar(index, &Limits::default()).unwrap()
}

#[test]
fn fog_is_that_of_the_library() {
    let answers = std::fs::read_to_string(tests().join("vdb_fog/answers.json")).unwrap();
    let answers: Vec<Value> = serde_json::from_str(&answers).unwrap();
    assert_eq!(answers.len(), 2);
    for answer in answers {
        let name = answer["file"].as_str().unwrap();
        let mut fog = fog_of_level_set(level_set(name));
        let [active, all, tiles] = hashes(&fog).map(|hash| format!("{hash:x}"));
        assert_eq!(answer["leaf_count"], fog.leaves.len(), "{name}");
        assert_eq!(answer["active_tiles"], fog.tiles.len(), "{name}");
        assert_eq!(answer["leaf_on_hash"], active, "{name}");
        assert_eq!(answer["leaf_all_hash"], all, "{name}");
        assert_eq!(answer["tile_hash"], tiles, "{name}");
        assert_eq!(answer["background"], i64::from(fog.background != 0.0), "{name}");
        assert_eq!(sanitize_density(&mut fog).total(), 0, "{name}");
    }
}
