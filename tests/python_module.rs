//! The Python module's own tests, where a Python has it: `pip install ./plugins/python numpy pytest`.

use std::path::Path;
use std::process::Command;

/// Prints the module's version; fails where the module, NumPy or pytest is missing.
const PROBE: &str = "import numpy, pytest, photonvdb; print(photonvdb.__version__)";

/// Python to be asked, unless `PHOTONVDB_PYTHON` names one.
const PYTHON: &str = "python3";

#[test]
fn python_module_passes_its_tests() {
    let python = std::env::var("PHOTONVDB_PYTHON").unwrap_or_else(|_| PYTHON.into());
    let probed = match Command::new(&python).args(["-c", PROBE]).output() {
        Ok(probed) => probed,
        Err(error) => return println!("skipped: {python} cannot be run: {error}"),
    };
    if !probed.status.success() {
        let said = String::from_utf8_lossy(&probed.stderr);
        let reason = said.lines().last().unwrap_or_default();
        return println!("skipped: {python} cannot test the module: {reason}");
    }
    let version = String::from_utf8_lossy(&probed.stdout);
    if version.trim() != env!("CARGO_PKG_VERSION") {
        return println!("skipped: {python} has photonvdb {}", version.trim());
    }
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("plugins/python/tests");
    let status = Command::new(&python)
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider"])
        .arg(tests)
        .env("PHOTONVDB_CLI", env!("CARGO_BIN_EXE_photonvdb"))
        .status()
        .expect("pytest runs");
    assert!(status.success(), "pytest: {status}");
}
