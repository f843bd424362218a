//! `photonvdb reference` through the binary: what it writes, what it says, and how it fails.

use std::fs;

use crate::run::Workspace;
use photonvdb::film::{describe_exr, read_rgb};

#[test]
fn an_image_with_its_noise_is_written() {
    let work = Workspace::new();
    let run = work.run("reference fog.toml -o truth.exr --preview truth.png --spp 8 --seed 3");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert_eq!(run.stdout, "");
    for part in ["8 spp, mean ", "estimated relative error ", " s\n", "wrote truth.exr, truth.png"]
    {
        assert!(run.stderr.contains(part), "{part} is not in\n{}", run.stderr);
    }
    assert_eq!(work.names(), ["fog.toml", "truth.exr", "truth.png"]);
    let image = read_rgb(&work.path("truth.exr")).unwrap();
    assert_eq!([image.width, image.height], [24, 16]);
    let part = describe_exr(&work.path("truth.exr")).unwrap().parts.remove(0);
    for channel in ["variance.R", "variance.G", "variance.B", "sample_count", "single_scatter.G"] {
        assert!(part.channels.iter().any(|(name, _)| name == channel), "{channel}");
    }
    let metadata = |name: &str| {
        let found = part.attributes.iter().find(|(existing, _)| existing == name);
        found.map(|(_, value)| value.as_str())
    };
    assert_eq!(metadata("photonvdb:photons.seed"), Some("3"));
    assert_eq!(metadata("photonvdb:samples_per_pixel"), Some("8"));
    assert_eq!(metadata("photonvdb:method"), Some("reference path tracer"));

    let run = work.run("render fog.toml -o fog.exr --photons 2e4 --reference truth.exr");
    assert!(run.stderr.contains("against truth.exr: mean "), "{}", run.stderr);
}

#[test]
fn the_file_depends_on_seed_and_samples_alone() {
    let work = Workspace::new();
    let reference = |name: &str, flags: &str| {
        let run = work.run(&format!("reference fog.toml -o {name} {flags} --quiet"));
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
        fs::read(work.path(name)).unwrap()
    };
    let first = reference("a.exr", "--spp 12 --threads 1");
    assert!(reference("b.exr", "--spp 12 --threads 2") == first);
    assert!(reference("c.exr", "--spp 12 --threads 7 --time-budget 1e9") == first);
    assert!(reference("d.exr", "--spp 12 --seed 1") != first);
    assert!(reference("e.exr", "--spp 13") != first);
}

#[test]
fn budgets_and_targets_end_it() {
    let work = Workspace::new();
    let samples = |flags: &str| {
        let run = work.run(&format!("reference fog.toml -o a.exr --resolution 8x6 {flags}"));
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        let summary = run.stderr.lines().find(|line| line.contains(" spp, mean ")).unwrap();
        summary.split(' ').next().unwrap().parse::<u64>().unwrap()
    };
    assert!(samples("--time-budget 0.2") > 2);
    assert_eq!(samples("--time-budget 1e-9"), 2);
    let loose = samples("--target-error 0.3");
    assert!((16..samples("--target-error 0.1")).contains(&loose));
    assert_eq!(samples("--target-error 1e-9 --spp 3"), 3);
}

#[test]
fn bad_input_is_refused_and_leaves_nothing() {
    let work = Workspace::new();
    let endless = fs::read_to_string(work.path("fog.toml")).unwrap();
    let endless = endless
        .replace("{ min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }", "\"infinite\"")
        .replace("albedo = 0.9", "albedo = 1.0");
    fs::write(work.path("endless.toml"), endless).unwrap();
    fs::write(work.path("old.exr"), "old").unwrap();
    for (arguments, said) in [
        ("fog.toml -o a.exr", "--spp"),
        ("fog.toml --spp 4", "--output"),
        ("-o a.exr --spp 4", "<SCENE>"),
        ("fog.toml -o a.exr --spp 0", "whole number"),
        ("fog.toml -o a.exr --spp 1", "2 or more"),
        ("fog.toml -o a.exr --time-budget -3", "--time-budget"),
        ("fog.toml -o a.exr --time-budget soon", "above 0"),
        ("fog.toml -o a.exr --target-error 0", "above 0"),
        ("fog.toml -o a.exr --target-error nan", "above 0"),
        ("fog.toml -o a.png --spp 4", "--preview"),
        ("fog.toml -o absent/a.exr --spp 4", "the directory absent does not exist"),
        ("fog.toml -o a.exr --preview absent/a.png --spp 4", "the directory absent does not exist"),
        ("missing.toml -o a.exr --spp 4", "missing.toml"),
        ("fog.toml -o a.exr --spp 4 --threads 0", "1..=1024"),
        ("fog.toml -o a.exr --spp 4 --resolution 640", "WIDTHxHEIGHT"),
        ("endless.toml -o old.exr --spp 4", "medium.albedo"),
    ] {
        work.run(&format!("reference {arguments}")).fails_with(said);
    }
    assert_eq!(work.names(), ["endless.toml", "fog.toml", "old.exr"]);
    assert_eq!(fs::read(work.path("old.exr")).unwrap(), b"old");
}

/// A medium that goes on for ever, as the lab uses it.
#[test]
fn an_infinite_medium_that_absorbs_is_rendered() {
    let work = Workspace::new();
    let infinite = fs::read_to_string(work.path("fog.toml")).unwrap();
    let infinite =
        infinite.replace("{ min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }", "\"infinite\"");
    fs::write(work.path("infinite.toml"), infinite).unwrap();
    let run = work.run("reference infinite.toml -o a.exr --spp 4");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
}

/// Asks for far more than there is time for, and interrupts.
#[cfg(unix)]
#[test]
fn ctrl_c_ends_after_the_pass_in_flight() {
    use std::process::{Command, Stdio};

    let work = Workspace::new();
    let mut reference = work.command("reference fog.toml -o fog.exr --spp 1e12");
    let reference = reference.stderr(Stdio::piped()).spawn().unwrap();
    // There is nothing to read before the end.
    std::thread::sleep(std::time::Duration::from_millis(1500));
    let interrupt =
        Command::new("kill").args(["-INT", &reference.id().to_string()]).status().unwrap();
    assert!(interrupt.success());
    let output = reference.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("ended before a limit was reached"), "{said}");
    assert_eq!(work.names(), ["fog.exr", "fog.toml"]);
    read_rgb(&work.path("fog.exr")).unwrap();
}
