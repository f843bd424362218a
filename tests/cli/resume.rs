//! `photonvdb render --checkpoint --resume` through the binary, killed while it works.

use std::fs;

use crate::run::Workspace;
use serde_json::Value;

/// The report without what depends on the day.
fn account(work: &Workspace, name: &str) -> Value {
    let mut report: Value = serde_json::from_slice(&fs::read(work.path(name)).unwrap()).unwrap();
    let fields = report.as_object_mut().unwrap();
    for timing in ["seconds", "cpu_seconds", "peak_memory_bytes"] {
        fields.remove(timing);
    }
    report
}

#[test]
fn a_render_goes_on_from_its_checkpoint() {
    let work = Workspace::new();
    for (gather, flags) in [("knn", "--gather knn --k 20"), ("lattice", "--lattice 10")] {
        let run = |arguments: &str| {
            let run = work.run(&format!("render fog.toml {flags} {arguments}"));
            assert_eq!(run.code, Some(0), "{}", run.stderr);
            run.stderr
        };
        run("-o whole.exr --passes 4 --report whole.json");
        run("-o part.exr --passes 2 --checkpoint a.ckpt");
        let said =
            run("-o part.exr --passes 4 --checkpoint b.ckpt --resume a.ckpt --report part.json");
        assert!(said.contains("going on after 2 passes"), "{said}");
        let bytes = |name: &str| fs::read(work.path(name)).unwrap();
        assert!(bytes("part.exr") == bytes("whole.exr"), "{gather}");
        assert_eq!(account(&work, "part.json"), account(&work, "whole.json"));
        // Finished already, with one file for both.
        fs::remove_file(work.path("part.exr")).unwrap();
        run("-o part.exr --passes 4 --checkpoint b.ckpt --resume b.ckpt --threads 1");
        assert!(bytes("part.exr") == bytes("whole.exr"), "{gather}");
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let work = Workspace::new();
    assert_eq!(work.run("render fog.toml -o a.exr --passes 2 --checkpoint a.ckpt").code, Some(0));
    fs::write(work.path("empty.ckpt"), "").unwrap();
    for (flags, said) in [
        ("--resume a.ckpt --seed 3", "photons.seed = 0 and this render has 3"),
        ("--resume a.ckpt --photons 2001", "photons.count = 2000 and this render has 2001"),
        ("--resume a.ckpt --resolution 8x8", "camera.resolution = 24x16 and this render has 8x8"),
        ("--resume a.ckpt", "holds 2 passes and 1 are asked for"),
        ("--resume a.ckpt --target-error 0.5", "--target-error"),
        ("--resume missing.ckpt", "missing.ckpt"),
        ("--resume empty.ckpt", "is not a checkpoint"),
        ("--resume fog.toml", "is not a checkpoint"),
        ("--resume .", "checkpoint"),
        ("--checkpoint absent/a.ckpt", "the directory absent does not exist"),
        ("--checkpoint .", "it is a directory"),
    ] {
        work.run(&format!("render fog.toml -o b.exr {flags}")).fails_with(said);
    }
    let text = fs::read_to_string(work.path("fog.toml")).unwrap();
    fs::write(work.path("fog.toml"), text.replace("sigma_t = 1.0", "sigma_t = 1.1")).unwrap();
    work.run("render fog.toml -o b.exr --passes 2 --resume a.ckpt").fails_with("another scene");
    assert_eq!(work.names(), ["a.ckpt", "a.exr", "empty.ckpt", "fog.toml"]);
}

/// Killed at many moments: the checkpoint is absent or whole, and the render goes on to the bytes of one that was left alone.
#[cfg(unix)]
#[test]
fn a_killed_render_goes_on() {
    use std::time::Duration;

    let work = Workspace::new();
    let arguments =
        "render fog.toml -o fog.exr --quiet --resolution 48x32 --lattice 12 --passes 40";
    assert_eq!(work.run(arguments).code, Some(0));
    let whole = fs::read(work.path("fog.exr")).unwrap();
    fs::remove_file(work.path("fog.exr")).unwrap();
    let mut kills = 0;
    for attempt in 0..60 {
        let resume = if work.path("a.ckpt").exists() { "--resume a.ckpt" } else { "" };
        let arguments = format!("{arguments} --checkpoint a.ckpt {resume}");
        let mut render = work.command(&arguments).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(10 + 7 * (attempt % 13)));
        if render.try_wait().unwrap().is_none() {
            render.kill().unwrap();
            kills += 1;
        }
        let status = render.wait().unwrap();
        // A checkpoint that could not be read would end it with 2.
        assert!(status.success() || status.code().is_none(), "{status}");
        if status.success() {
            break;
        }
    }
    if !work.path("fog.exr").exists() {
        let run = work.run(&format!("{arguments} --resume a.ckpt"));
        assert_eq!(run.code, Some(0), "{}", run.stderr);
    }
    assert!(kills > 2, "{kills}");
    assert!(fs::read(work.path("fog.exr")).unwrap() == whole);
}
