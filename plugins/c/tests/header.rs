//! The header is the one that the code makes. `PHOTONVDB_REMAKE=1` writes it.

use std::path::Path;

#[test]
fn the_header_is_up_to_date() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).unwrap();
    // And the modules that it names.
    let builder = cbindgen::Builder::new().with_config(config).with_src(root.join("src/lib.rs"));
    let mut made = Vec::new();
    builder.generate().unwrap().write(&mut made);
    let path = root.join("include/photonvdb.h");
    if std::env::var_os("PHOTONVDB_REMAKE").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let made = String::from_utf8(made).unwrap();
    let kept = std::fs::read_to_string(&path).unwrap();
    assert!(
        kept == made,
        "include/photonvdb.h is not what src/ makes; remake it with PHOTONVDB_REMAKE=1"
    );
}
