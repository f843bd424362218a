//! The example in C: compiled against the header and the library, and run.

use std::path::Path;
use std::process::Command;

/// Where cargo has put the library beside the test.
fn library() -> std::path::PathBuf {
    let test = std::env::current_exe().unwrap();
    test.parent().unwrap().join("libphotonvdb_c.a")
}

#[test]
fn the_example_compiles_and_runs() {
    if Command::new("cc").arg("--version").output().is_err() {
        eprintln!("skipped: there is no cc");
        return;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let library = library();
    if cfg!(not(unix)) || !library.exists() {
        eprintln!("skipped: no static library for cc at {}", library.display());
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    let program = directory.path().join("render");
    let compiled = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"])
        .arg(root.join("examples/render.c"))
        .arg("-I")
        .arg(root.join("include"))
        .arg(&library)
        .args(["-lpthread", "-ldl", "-lm", "-o"])
        .arg(&program)
        .output()
        .unwrap();
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let scene = directory.path().join("fog.toml");
    let text = "[camera]\nposition = [0.0, 0.0, 4.0]\nlook_at = [0.0, 0.0, 0.0]\nresolution = [16, 8]\n\
        [medium]\nkind = \"homogeneous\"\nbounds = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }\n\
        sigma_t = 1.0\nalbedo = 0.9\n[[light]]\nkind = \"point\"\nposition = [0.3, 0.4, 0.2]\nintensity = 1.0\n\
        [photons]\ncount = 2000\n";
    std::fs::write(&scene, text).unwrap();
    let image = directory.path().join("fog.pfm");
    let ran = Command::new(&program).arg(&scene).arg(&image).output().unwrap();
    let said = String::from_utf8_lossy(&ran.stdout);
    assert!(ran.status.success(), "{said}{}", String::from_utf8_lossy(&ran.stderr));
    assert!(said.contains("image 16 x 8, mean 0."), "{said}");
    assert!(said.contains("refused: map is a null pointer"), "{said}");
    let header = "PF\n16 8\n-1.0\n";
    let bytes = std::fs::read(&image).unwrap();
    assert!(bytes.starts_with(header.as_bytes()));
    assert_eq!(bytes.len(), header.len() + 16 * 8 * 12);
    let missing = Command::new(&program).arg("none.toml").arg(&image).output().unwrap();
    assert_eq!(missing.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&missing.stderr).contains("none.toml: cannot read the scene"));
}
