//! The Python module's own tests and those of the plug-ins that stand on it, where a Python has what they need:
//! `pip install ./plugins/python numpy pytest`, and for a plug-in its host, such as `mitsuba`.

use std::path::Path;
use std::process::Command;

/// Folders of tests, with the modules that they need beside photonvdb, NumPy and pytest.
const SUITES: [(&str, &str); 2] = [("python", ""), ("mitsuba", ", mitsuba")];

/// Python to be asked, unless `PHOTONVDB_PYTHON` names one.
const PYTHON: &str = "python3";

#[test]
fn python_module_passes_its_tests() {
    for (folder, modules) in SUITES {
        run_suite(folder, modules);
    }
}

fn run_suite(folder: &str, modules: &str) {
    let python = std::env::var("PHOTONVDB_PYTHON").unwrap_or_else(|_| PYTHON.into());
    // Prints the module's version; fails where something is missing.
    let probe = format!("import numpy, pytest, photonvdb{modules}; print(photonvdb.__version__)");
    let probed = match Command::new(&python).args(["-c", &probe]).output() {
        Ok(probed) => probed,
        Err(error) => return println!("{folder} skipped: {python} cannot be run: {error}"),
    };
    if !probed.status.success() {
        let said = String::from_utf8_lossy(&probed.stderr);
        let reason = said.lines().last().unwrap_or_default();
        return println!("{folder} skipped: {python} cannot test it: {reason}");
    }
    let version = String::from_utf8_lossy(&probed.stdout);
    if version.trim() != env!("CARGO_PKG_VERSION") {
        return println!("{folder} skipped: {python} has photonvdb {}", version.trim());
    }
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("plugins").join(folder).join("tests");
    let status = Command::new(&python)
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider"])
        .arg(tests)
        .env("PHOTONVDB_CLI", env!("CARGO_BIN_EXE_photonvdb"))
        .status()
        .expect("pytest runs");
    assert!(status.success(), "pytest of {folder}: {status}");
}
