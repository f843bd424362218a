//! `photonvdb render` through the binary: what it writes, what it says, and how it fails.

use std::fs;

use crate::run::Workspace;
use photonvdb::film::{describe_exr, read_rgb};
use serde_json::Value;

#[test]
fn a_render_writes_image_preview_and_report() {
    let work = Workspace::new();
    let arguments = "render fog.toml -o fog.exr --preview fog.png --report fog.json --photons 1_000 --passes 2 \
         --seed 7 --layers photon_count,kernel_radius";
    let run = work.run(arguments);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert_eq!(run.stdout, "");
    assert_eq!(work.names(), ["fog.exr", "fog.json", "fog.png", "fog.toml"]);

    let image = read_rgb(&work.path("fog.exr")).unwrap();
    assert_eq!([image.width, image.height], [24, 16]);
    let part = describe_exr(&work.path("fog.exr")).unwrap().parts.remove(0);
    let metadata = |name: &str| {
        let found = part.attributes.iter().find(|(existing, _)| existing == name);
        found.map(|(_, value)| value.as_str())
    };
    assert_eq!(metadata("photonvdb:photons.seed"), Some("7"));
    assert_eq!(metadata("photonvdb:photons.count"), Some("1000"));
    assert_eq!(metadata("photonvdb:photons_emitted"), Some("2000"));
    assert_eq!(metadata("photonvdb:passes"), Some("2"));
    assert_eq!(metadata("photonvdb:scene"), Some("fog.toml"));
    assert_eq!(metadata("photonvdb:estimate.divisor"), Some("k-1"));
    assert!(part.channels.iter().any(|(name, _)| name == "photon_count"));
    assert!(part.channels.iter().any(|(name, _)| name == "kernel_radius"));

    let report: Value = serde_json::from_slice(&fs::read(work.path("fog.json")).unwrap()).unwrap();
    assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(report["photons"]["emitted"], 2000);
    assert_eq!(report["settings"]["photons"]["seed"], 7);
    assert_eq!(report["plan"]["photons"], 1000);
    assert!(report["estimated_relative_error"].is_number(), "two passes tell");
    assert_eq!(report.get("comparison"), None);
    for step in ["load", "trace", "build", "gather", "write", "total"] {
        assert!(report["seconds"][step].is_number(), "{step}");
    }
    for flow in ["emitted", "absorbed", "escaped"] {
        assert_eq!(report["power"][flow].as_array().map(Vec::len), Some(3), "{flow}");
    }
    if cfg!(target_os = "linux") {
        assert!(report["cpu_seconds"].is_number() && report["peak_memory_bytes"].is_u64());
    }
}

/// The constant is measured, told to people and to programs, and part of what the seed alone decides.
#[test]
fn a_calibrated_divisor_is_reported() {
    let work = Workspace::new();
    let flags = "--photons 20_000 --k 20 --divisor calibrated --passes 2";
    let render = |name: &str, threads: u32| {
        let arguments = format!(
            "render fog.toml -o {name}.exr --report {name}.json {flags} --threads {threads}"
        );
        let run = work.run(&arguments);
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        assert!(run.stderr.contains("(divisor calibrated)"), "{}", run.stderr);
        assert!(run.stderr.contains("divisor calibrated: 20 photons count as 1"), "{}", run.stderr);
        let report = fs::read(work.path(&format!("{name}.json"))).unwrap();
        let report: Value = serde_json::from_slice(&report).unwrap();
        assert_eq!(report["settings"]["estimate"]["divisor"], "calibrated");
        let calibration = report["calibration"].clone();
        assert_eq!(calibration["k"], 20);
        let figure = |key: &str| calibration[key].as_f64().unwrap();
        // Scattered photons are nearly independent.
        assert!((figure("constant") - 19.0).abs() < 0.5, "{calibration}");
        assert!(figure("std_error") > 0.0 && figure("std_error") < 0.05, "{calibration}");
        assert!(figure("count_variance") > 0.0 && figure("count_exponent") > 0.0);
        (fs::read(work.path(&format!("{name}.exr"))).unwrap(), calibration)
    };
    assert_eq!(render("a", 1), render("b", 2));
    work.run("render fog.toml -o c.exr --k 1 --divisor calibrated").fails_with("at least 2");
}

/// What a compositor asks for, through the binary: names of channels, their types, and lights by the names of the scene.
#[test]
fn layers_are_written_as_asked() {
    let work = Workspace::new();
    let text = fs::read_to_string(work.path("fog.toml")).unwrap();
    let sky = "[[light]]\nkind = \"environment\"\nradiance = 0.5\n";
    let named = text.replace("kind = \"point\"", "name = \"key\"\nkind = \"point\"");
    fs::write(work.path("lit.toml"), named + sky).unwrap();
    let run = work.run("render lit.toml -o lit.exr --half --holdout --layers depth,lights,alpha");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let part = describe_exr(&work.path("lit.exr")).unwrap().parts.remove(0);
    let kinds: Vec<(&str, &str)> =
        part.channels.iter().map(|(name, kind)| (name.as_str(), *kind)).collect();
    for channel in [
        ("A", "half"),
        ("AR", "half"),
        ("R", "half"),
        ("Z", "float"),
        ("scatter.Z", "float"),
        ("light.key.G", "half"),
        ("light.1.B", "half"),
        ("transmittance.R", "half"),
    ] {
        assert!(kinds.contains(&channel), "{channel:?} {kinds:?}");
    }
    // The corner sees nothing but the background, which is held out.
    assert_eq!(read_rgb(&work.path("lit.exr")).unwrap().pixels[0], [0.0; 3]);
    let background = |name: &str| {
        let part = describe_exr(&work.path(name)).unwrap().parts.remove(0);
        part.attributes.into_iter().find(|(name, _)| name == "photonvdb:render.background")
    };
    assert_eq!(background("lit.exr").unwrap().1, "holdout");
    work.run("render lit.toml -o lit.exr");
    assert_eq!(background("lit.exr"), None);
    assert_eq!(read_rgb(&work.path("lit.exr")).unwrap().pixels[0], [0.5; 3]);
    for name in ["medium", "1", "a.b", "", "no space"] {
        let text = fs::read_to_string(work.path("lit.toml")).unwrap();
        fs::write(work.path("bad.toml"), text.replace("\"key\"", &format!("{name:?}"))).unwrap();
        work.run("render bad.toml -o bad.exr").fails_with("light[0].name");
    }
}

#[test]
fn the_image_depends_on_the_seed_alone() {
    let work = Workspace::new();
    let render = |name: &str, flags: &str| {
        let run = work.run(&format!("render fog.toml -o {name} {flags}"));
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        fs::read(work.path(name)).unwrap()
    };
    let first = render("a.exr", "--threads 1");
    assert!(render("b.exr", "--threads 2") == first);
    assert!(render("c.exr", "--threads 7 --quiet") == first);
    assert!(render("d.exr", "--seed 1") != first);
}

#[test]
fn a_reference_is_compared_with() {
    let work = Workspace::new();
    work.run("render fog.toml -o truth.exr");
    let run = work.run("render fog.toml -o fog.exr --reference truth.exr --report - --quiet");
    assert_eq!(run.stderr, "");
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(report["comparison"]["reference"], "truth.exr");
    assert_eq!(report["comparison"]["mean_ratio"], 1.0);
    assert_eq!(report["comparison"]["rel_rmse"], 0.0);
    assert_eq!(report["comparison"]["block_rel_rms"], 0.0);
}

#[test]
fn plan_and_summary_are_told_on_stderr() {
    let work = Workspace::new();
    let run = work.run("render fog.toml -o fog.exr");
    assert_eq!(run.stdout, "");
    for part in ["2000 photons a pass", "trace", "gather", "wrote fog.exr"] {
        assert!(run.stderr.contains(part), "{part} is not in\n{}", run.stderr);
    }
    assert_eq!(work.run("render fog.toml -o fog.exr --quiet").stderr, "");
}

#[test]
fn outputs_are_checked_before_the_work() {
    let work = Workspace::new();
    for (arguments, said) in [
        ("-o absent/fog.exr", "the directory absent does not exist"),
        ("-o fog.exr --preview absent/fog.png", "the directory absent does not exist"),
        ("-o fog.exr --report .", "it is a directory"),
        ("-o fog.exr --reference missing.exr", "missing.exr"),
    ] {
        let run = work.run(&format!("render fog.toml {arguments}"));
        run.fails_with(said);
        assert_eq!(work.names(), ["fog.toml"]);
    }
}

#[test]
fn a_reference_of_another_size_is_refused_at_once() {
    let work = Workspace::new();
    work.run("render fog.toml -o small.exr --resolution 8x8");
    work.run("render fog.toml -o fog.exr --reference small.exr")
        .fails_with("the image is 24 x 16 pixels but its reference is 8 x 8");
    assert_eq!(work.names(), ["fog.toml", "small.exr"]);
}

#[test]
fn a_failed_render_keeps_the_old_image() {
    let work = Workspace::new();
    fs::write(work.path("fog.exr"), "old").unwrap();
    fs::write(work.path("broken.toml"), "[camera]\nposition = 3\n").unwrap();
    work.run("render broken.toml -o fog.exr").fails_with("broken.toml");
    assert_eq!(fs::read(work.path("fog.exr")).unwrap(), b"old");
    assert_eq!(work.names(), ["broken.toml", "fog.exr", "fog.toml"]);
}

#[test]
fn wrong_flags_say_what_would_be_right() {
    let work = Workspace::new();
    for (arguments, said) in [
        ("render fog.toml", "--output"),
        ("render -o fog.exr", "<SCENE>"),
        ("render fog.toml -o fog.png", "--preview"),
        ("render fog.toml -o fog.exr --photons many", "1_000_000 or 1e6"),
        ("render fog.toml -o fog.exr --photons 0", "from 1 on"),
        ("render fog.toml -o fog.exr --passes 1.5", "whole number"),
        ("render fog.toml -o fog.exr --divisor k-2", "k-1/2"),
        ("render fog.toml -o fog.exr --emission chaotic", "stratified"),
        ("render fog.toml -o fog.exr --resolution 640", "WIDTHxHEIGHT"),
        ("render fog.toml -o fog.exr --layers normals", "kernel_radius"),
        ("render fog.toml -o fog.exr --threads 0", "1..=1024"),
        ("render fog.toml -o fog.exr --k 1", "estimate.k"),
        ("render fog.toml -o fog.exr --foton 3", "--photons"),
        ("render missing.toml -o fog.exr", "missing.toml"),
        ("rendre fog.toml", "render"),
    ] {
        work.run(arguments).fails_with(said);
    }
    assert_eq!(work.names(), ["fog.toml"]);
}

#[test]
fn help_teaches_by_example() {
    let work = Workspace::new();
    let run = work.run("--help");
    assert_eq!(run.code, Some(0));
    for part in ["render", "inspect", "Examples:", "Exit codes"] {
        assert!(run.stdout.contains(part), "{part}");
    }
    let run = work.run("render --help");
    assert_eq!(run.code, Some(0));
    for flag in ["--photons", "--passes", "--divisor", "--reference", "--report", "--preview"] {
        assert!(run.stdout.contains(flag), "{flag}");
    }
    assert!(run.stdout.contains("Ctrl-C"));
    assert!(
        run.stdout
            .lines()
            .all(|line| line.chars().count() <= 100 || line.contains("photonvdb render"))
    );
    assert_eq!(work.run("--version").stdout, format!("photonvdb {}\n", env!("CARGO_PKG_VERSION")));
}

/// Asks for far more passes than there is time for, and interrupts as soon as the plan is told.
#[cfg(unix)]
#[test]
fn ctrl_c_ends_after_the_pass_in_flight() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::{Command, Stdio};

    let work = Workspace::new();
    let mut render = work.command("render fog.toml -o fog.exr --report fog.json --passes 1e9");
    let mut render = render.stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(render.stderr.take().unwrap());
    stderr.read_line(&mut String::new()).unwrap();
    let interrupt = Command::new("kill").args(["-INT", &render.id().to_string()]).status().unwrap();
    assert!(interrupt.success());
    let mut said = String::new();
    stderr.read_to_string(&mut said).unwrap();
    assert_eq!(render.wait().unwrap().code(), Some(0), "{said}");
    assert!(said.contains("ended after pass"), "{said}");
    assert_eq!(work.names(), ["fog.exr", "fog.json", "fog.toml"]);
    let report: Value = serde_json::from_slice(&fs::read(work.path("fog.json")).unwrap()).unwrap();
    let passes = report["passes_done"].as_u64().unwrap();
    assert!((1..1_000_000_000).contains(&passes));
    assert_eq!(report["photons"]["emitted"], 2000 * passes);
    read_rgb(&work.path("fog.exr")).unwrap();
}

/// A scene with a level set: refused, then filled with fog on request; strict where asked for.
#[test]
fn volumes_are_read_as_the_flags_say() {
    let work = Workspace::new();
    let scene = |volume: &str| {
        let volume = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/").to_owned() + volume;
        let text = std::fs::read_to_string(work.path("fog.toml")).unwrap();
        let (camera, rest) = text.split_once("[medium]").unwrap();
        let (_, lights) = rest.split_once("[[light]]").unwrap();
        let medium = format!("[medium]\nkind = \"vdb\"\nfile = {volume:?}\nalbedo = 0.9\n\n");
        let text = format!("{camera}{medium}[[light]]{lights}");
        std::fs::write(work.path("volume.toml"), text).unwrap();
    };
    scene("vdb/levelset_mask.vdb");
    work.run("render volume.toml -o a.exr").fails_with("--sdf-to-fog");
    let run = work.run("render volume.toml -o a.exr --sdf-to-fog");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    work.run("render volume.toml -o b.exr --sdf-to-fog --max-volume-memory 100KiB")
        .fails_with("the limit on memory is 100.0 KiB");

    scene("scene_volumes/nan_inf_neg.vdb");
    let run = work.run("render volume.toml -o c.exr");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert_eq!(run.stderr.matches("are no densities").count(), 1, "{}", run.stderr);
    work.run("render volume.toml -o d.exr --strict").fails_with("leave out --strict");
    work.run("render fog.toml -o e.exr --sdf-to-fog").fails_with("medium.sdf_to_fog");
    assert_eq!(work.names(), ["a.exr", "c.exr", "fog.toml", "volume.toml"]);
}
