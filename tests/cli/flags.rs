//! Flags that cannot be meant, or that memory has no room for: one clear error, or a warning.

use crate::run::Workspace;

#[test]
fn numbers_are_refused_by_what_is_wanted() {
    let work = Workspace::new();
    for (flags, said) in [
        ("--time-budget -1", "`-1` is not a number above 0"),
        ("--photons -5", "`-5` is not a whole number from 1 on"),
        ("--target-error nan", "`nan` is not a number above 0"),
        ("--photons 1e18", "must lie in 1 to 10^12, found 1000000000000000000"),
        ("--threads 0", "0 is not in 1..=1024"),
        ("--k 1", "must be at least 2"),
    ] {
        work.run(&format!("render fog.toml -o fog.exr {flags}")).fails_with(said);
    }
    assert_eq!(work.names(), ["fog.toml"]);
}

#[test]
fn flags_that_change_nothing_are_told() {
    let work = Workspace::new();
    for (flags, idle) in [
        ("--gather lattice --k 20 --divisor k", vec!["--k", "--divisor"]),
        ("--gather lattice --bounces 3", vec!["--bounces"]),
        ("--gather knn --lattice 8 --bounces 3", vec!["--lattice", "--bounces"]),
        ("--gather bounce --bounces 3 --lattice 8", vec![]),
        ("--layers variance", vec!["--layers variance"]),
        ("--layers variance --passes 2", vec![]),
        ("--k 20 --layers photon_count", vec![]),
    ] {
        let run = work.run(&format!("render fog.toml -o fog.exr --photons 100 {flags}"));
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        let told: Vec<&str> = run
            .stderr
            .lines()
            .filter_map(|line| line.strip_prefix("warning: ")?.split_once(" changes nothing here"))
            .map(|(flag, _)| flag)
            .collect();
        assert_eq!(told, idle, "{flags}");
    }
}

#[test]
fn darkness_is_told() {
    let work = Workspace::new();
    let text = std::fs::read_to_string(work.path("fog.toml")).unwrap();
    let dark = text.replace("intensity = 1.0", "intensity = 0.0");
    std::fs::write(work.path("dark.toml"), dark).unwrap();
    let said = |scene: &str| {
        let run = work.run(&format!("render {scene} -o fog.exr --photons 100"));
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        run.stderr.contains("warning: no light falls on the medium")
    };
    assert!(said("dark.toml") && !said("fog.toml"));
}

/// An allocation that fails would abort the process: what does not fit is refused before.
#[cfg(target_os = "linux")]
#[test]
fn what_memory_has_no_room_for_is_refused() {
    use std::process::Command;

    let work = Workspace::new();
    for (flags, said) in [
        ("--gather knn --photons 1e12", "a pass of 1000000000000 photons stores more than the"),
        ("--lattice 512 --photons 1e4", "a lattice of 134217728 cells takes"),
        ("--resolution 5000x5000", "an image of 25000000 pixels takes"),
    ] {
        let binary = env!("CARGO_BIN_EXE_photonvdb");
        let limited = format!(
            "ulimit -v 1000000; exec {binary} render fog.toml -o fog.exr --quiet --threads 2 {flags}"
        );
        let mut shell = Command::new("sh");
        let output = shell.args(["-c", &limited]).current_dir(work.path("")).output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{flags}: {stderr}");
        assert!(stderr.starts_with("error: ") && stderr.contains(said), "{stderr}");
        assert!(stderr.contains("; use fewer") || stderr.contains("; take "), "{stderr}");
    }
    assert_eq!(work.names(), ["fog.toml"]);
}
