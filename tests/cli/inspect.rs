//! `photonvdb inspect` through the binary.

use std::fs;

use crate::run::Workspace;
use serde_json::Value;

#[test]
fn a_scene_shows_its_plan() {
    let work = Workspace::new();
    let run = work.run("inspect fog.toml");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for part in ["24 x 16", "homogeneous", "1 point light", "lattice"] {
        assert!(run.stdout.contains(part), "{part} is not in\n{}", run.stdout);
    }
    let plan: Value = serde_json::from_str(&work.run("inspect fog.toml --json").stdout).unwrap();
    assert_eq!(plan["plan"]["medium"], "homogeneous");
    assert_eq!(plan["plan"]["lights"]["point"], 1);
    assert_eq!(work.names(), ["fog.toml"]);
}

#[test]
fn an_image_names_the_scene_it_shows() {
    let work = Workspace::new();
    work.run("render fog.toml -o fog.exr");
    let json = |name: &str| -> Value {
        serde_json::from_str(&work.run(&format!("inspect {name} --json")).stdout).unwrap()
    };
    let hash = &json("fog.toml")["scene_hash"];
    assert_eq!(hash.as_str().map(str::len), Some(16));
    assert_eq!(json("fog.exr")["parts"][0]["metadata"]["photonvdb:scene_hash"], *hash);
}

#[test]
fn an_exr_shows_layers_and_metadata() {
    let work = Workspace::new();
    work.run("render fog.toml -o fog.exr --seed 5");
    // The content tells the kind, not the name.
    fs::rename(work.path("fog.exr"), work.path("image")).unwrap();
    let run = work.run("inspect image");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for part in ["24 x 16", "single_scatter", "B G R", "photonvdb:photons.seed", "fog.toml"] {
        assert!(run.stdout.contains(part), "{part} is not in\n{}", run.stdout);
    }
    let description: Value =
        serde_json::from_str(&work.run("inspect image --json").stdout).unwrap();
    let part = &description["parts"][0];
    assert_eq!(part["metadata"]["photonvdb:photons.seed"], "5");
    assert_eq!(part["layers"][0]["channels"][0], "A");
    assert_eq!(part["channels"].as_array().map(Vec::len), Some(16));
}

#[test]
fn unknown_and_damaged_files_are_errors() {
    let work = Workspace::new();
    work.run("inspect missing.exr").fails_with("cannot read missing.exr");
    fs::write(work.path("short.exr"), [0x76, 0x2f, 0x31, 0x01, 2]).unwrap();
    work.run("inspect short.exr").fails_with("short.exr is not an intact EXR image");
    fs::write(work.path("notes.txt"), "hello").unwrap();
    work.run("inspect notes.txt").fails_with("notes.txt");
    work.run("inspect .").fails_with("cannot read .");
    work.run("inspect").fails_with("<FILE>");
}

#[test]
fn no_command_shows_the_way() {
    let work = Workspace::new();
    let run = work.run("");
    assert_eq!(run.code, Some(2));
    assert!(run.stderr.contains("Usage: photonvdb"), "{}", run.stderr);
}

/// The figures are those of the OpenVDB library, in the answers beside the files.
#[test]
fn a_vdb_shows_its_grids() {
    let work = Workspace::new();
    let show = |file: &str, flags: &str| {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/vdb/");
        let run = work.run(&format!("inspect {path}{file} {flags}"));
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        run.stdout
    };
    let listing: Value = serde_json::from_str(&show("smoke_blosc.vdb", "--json")).unwrap();
    let grid = &listing["grids"][0];
    assert_eq!(grid["name"], "density");
    assert_eq!(grid["type"], "float");
    assert_eq!(grid["class"], "fog volume");
    assert_eq!(grid["active_voxels"], 32032);
    assert_eq!(grid["leaf_count"], 179);
    assert_eq!(grid["active_tiles"], 0);
    assert_eq!(grid["bbox_index"], serde_json::json!([[-24, -24, -24], [23, 23, 23]]));
    assert_eq!(grid["min"], 1.4543533325195312e-05);
    assert_eq!(grid["max"], 1.565636157989502);
    assert_eq!(grid["sum"], 10126.243448972702);
    assert_eq!(grid["index_to_world"][2][2], 0.10000000149011612);
    assert_eq!(grid["index_to_world"][3], serde_json::json!([0.0, 0.0, 0.0, 1.0]));
    assert_eq!(grid["usable"], true);
    assert_eq!(grid["reason"], Value::Null);

    // Two tiles of 128^3 and 8^3 voxels.
    let listing: Value = serde_json::from_str(&show("tiles_only.vdb", "--json")).unwrap();
    assert_eq!(listing["grids"][0]["active_voxels"], 128_u64.pow(3) + 8_u64.pow(3));
    assert_eq!(listing["grids"][0]["active_tiles"], 2);
    assert!(show("smoke_blosc.vdb", "").contains("32032 active voxels in 179 leaves"));
    assert!(show("levelset_mask.vdb", "").contains("cannot be rendered: it is a level set"));
    let text = show("nan_inf_neg.vdb", "");
    assert!(text.contains("3 voxels are NaN or infinite"), "{text}");
    assert!(text.contains("3 voxels are negative"), "{text}");
}

#[test]
fn a_damaged_vdb_is_an_error() {
    let work = Workspace::new();
    fs::write(work.path("short.vdb"), b" BDV\0\0\0\0\xe0\0").unwrap();
    work.run("inspect short.vdb").fails_with("short.vdb cannot be read");
    fs::write(work.path("text.vdb"), "hello").unwrap();
    work.run("inspect text.vdb").fails_with("text.vdb is not an OpenVDB file");
}

/// The figures are those of the OpenVDB library.
#[test]
fn a_grid_of_vectors_shows_its_components() {
    let work = Workspace::new();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/vdb/type_vec3s_half.vdb");
    let run = work.run(&format!("inspect {path} --json"));
    let listing: Value = serde_json::from_str(&run.stdout).unwrap();
    let grid = &listing["grids"][0];
    for (key, expected) in [
        ("min", [0.25439453125, -4.1015625, -1.7451171875]),
        ("max", [1.7451171875, 4.1015625, -0.25439453125]),
        ("mean", [1.413443521908783, 0.9000274301514046, -1.715220732494841]),
    ] {
        for (axis, expected) in expected.into_iter().enumerate() {
            let shown = grid[key][axis].as_f64().unwrap();
            assert!((shown - expected).abs() < 1e-12, "{key} {axis}: {shown}");
        }
    }
    assert_eq!(grid["usable"], false);
    assert_eq!(grid["usable_as"], serde_json::json!(["color"]));
    let run = work.run(&format!("inspect {path}"));
    assert!(run.stdout.contains("can be rendered as color"), "{}", run.stdout);
}

#[test]
fn a_limit_of_memory_is_kept_and_named() {
    let work = Workspace::new();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/vdb/smoke_blosc.vdb");
    let run = work.run(&format!("inspect {path} --json --max-volume-memory 300KiB"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let listing: Value = serde_json::from_str(&run.stdout).unwrap();
    let reason = listing["grids"][0]["reason"].as_str().unwrap();
    assert!(reason.contains("the limit is 300.0 KiB"), "{reason}");
    work.run("inspect fog.toml --max-volume-memory lots").fails_with("512MiB");
}
