//! Checkpoints: a render in pieces gives the bytes of one that was not broken off, and no other file passes for a checkpoint.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use photonvdb::files::WriteFailure;
use photonvdb::film::Film;
use photonvdb::render::{
    CheckpointError, Checkpoints, CostlyLayers, ErrorEstimate, Observer, RenderOptions,
    RenderState, Rendering, Stage, render, render_from,
};
use photonvdb::scene::{Overrides, Scene};

/// Ends a render after so many passes, and counts the checkpoints that could not be written.
#[derive(Default)]
struct StopAfter {
    passes: u32,
    done: AtomicU32,
    failures: AtomicU32,
}

impl Observer for StopAfter {
    fn stage_started(&self, _: Stage, _: u64) {}

    fn advanced(&self, _: u64) {}

    fn stage_finished(&self, _: Stage) {}

    fn pass_finished(&self, _: u32, _: Option<ErrorEstimate>) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    fn checkpoint_failed(&self, _: &WriteFailure) {
        self.failures.fetch_add(1, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.done.load(Ordering::Relaxed) >= self.passes
    }
}

fn example(name: &str, overrides: Overrides) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes").join(name);
    let draft = Overrides { photons: Some(3000), resolution: Some([13, 9]), ..overrides };
    Scene::load_with(&path, &draft).unwrap()
}

fn with_gather(gather: &str) -> Overrides {
    Overrides { gather: Some(gather.into()), k: Some(20), ..Overrides::default() }
}

/// Renders until `stop` passes of this run are made, from and to `path`.
fn run(scene: &Scene, options: &RenderOptions, path: &Path, stop: u32) -> Rendering {
    let resume_from = path.exists().then(|| RenderState::load(path, scene, options).unwrap());
    let checkpoints = Checkpoints { resume_from, save_to: Some(path) };
    let observer = StopAfter { passes: stop, ..StopAfter::default() };
    let rendering = render_from(scene, options, &observer, checkpoints).unwrap();
    assert_eq!(observer.failures.load(Ordering::Relaxed), 0);
    rendering
}

fn bits(film: &Film) -> String {
    // Debug prints the shortest digits that give the same number back.
    format!("{film:?}")
}

fn assert_same(a: &Rendering, b: &Rendering) {
    assert!(bits(&a.film) == bits(&b.film));
    let account = |rendering: &Rendering| {
        let report = &rendering.report;
        (
            [report.emitted_count, report.stored_count, report.bytes_per_photon as u64],
            report.power,
            report.calibration,
            report.passes_done,
            report.error,
        )
    };
    assert_eq!(account(a), account(b));
}

/// Broken off after each pass, and after every pass, with a fixed number of passes and towards an error, from the photon map
/// (with a measured divisor), from a lattice, and in a grid.
#[test]
fn a_resumed_render_is_the_same_byte_for_byte() {
    let calibrated = Overrides { divisor: Some("calibrated".into()), ..with_gather("knn") };
    let photons_only = Overrides { photons_only: Some(true), ..with_gather("knn") };
    let target = RenderOptions { target_error: Some(0.02), ..RenderOptions::passes(14) };
    let five = RenderOptions::passes(5);
    let layers = CostlyLayers { depths: true, lights: true };
    let layered = RenderOptions { layers, ..RenderOptions::passes(3) };
    for (scene, options) in [
        (example("fog_point.toml", with_gather("knn")), five),
        (example("fog_spot.toml", calibrated), five),
        (example("smoke_sun.toml", photons_only), RenderOptions::passes(3)),
        (example("fog_point.toml", with_gather("lattice")), five),
        (example("cloud_sky.toml", with_gather("lattice")), layered),
        (example("fire.toml", with_gather("knn")), layered),
        (example("fire.toml", with_gather("bounce")), layered),
        (example("fog_point.toml", with_gather("bounce")), five),
        (example("cloud_sky.toml", with_gather("bounce")), target),
        (example("smoke_sun.toml", with_gather("lattice")), target),
        (example("fog_point.toml", with_gather("knn")), target),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("render.ckpt");
        let whole =
            render(&scene, &options, &StopAfter { passes: 99, ..StopAfter::default() }).unwrap();
        let passes = whole.report.passes_done;
        for stop in 1..passes {
            let _ = fs::remove_file(&path);
            let part = run(&scene, &options, &path, stop);
            assert!(part.report.passes_done <= stop);
            assert_same(&run(&scene, &options, &path, 99), &whole);
        }
        fs::remove_file(&path).unwrap();
        for _ in 1..80 {
            run(&scene, &options, &path, 1);
        }
        // It is finished: nothing is rendered any more.
        let observer = StopAfter { passes: 99, ..StopAfter::default() };
        let resume_from = Some(RenderState::load(&path, &scene, &options).unwrap());
        let elsewhere = folder.path().join("elsewhere.ckpt");
        let checkpoints = Checkpoints { resume_from, save_to: Some(&elsewhere) };
        assert_same(&render_from(&scene, &options, &observer, checkpoints).unwrap(), &whole);
        assert_eq!(observer.done.load(Ordering::Relaxed), 0);
        assert_eq!(fs::read(&path).unwrap(), fs::read(&elsewhere).unwrap());
    }
}

/// Two passes and one more are three, where nothing else depends on their number.
#[test]
fn passes_can_be_added() {
    let overrides = Overrides { lattice: Some(12), ..with_gather("lattice") };
    let bounced = Overrides { gather: Some("bounce".into()), ..overrides.clone() };
    for scene in [
        example("fog_point.toml", overrides),
        example("fog_quad.json", with_gather("knn")),
        example("fog_point.toml", bounced),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("render.ckpt");
        run(&scene, &RenderOptions::passes(2), &path, 99);
        let more = run(&scene, &RenderOptions::passes(3), &path, 99);
        let whole = render(
            &scene,
            &RenderOptions::passes(3),
            &StopAfter { passes: 99, ..StopAfter::default() },
        );
        assert_same(&more, &whole.unwrap());
        let error = RenderState::load(&path, &scene, &RenderOptions::passes(2)).unwrap_err();
        assert!(matches!(error, CheckpointError::TooManyPasses { found: 3, asked: 2, .. }));
    }
}

/// A budget that was spent before leaves no time for a pass.
#[test]
fn a_time_budget_counts_what_was_spent() {
    let scene = example("fog_point.toml", with_gather("lattice"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("render.ckpt");
    let hour = RenderOptions { seconds: Some(3600.0), ..RenderOptions::passes(u32::MAX) };
    run(&scene, &hour, &path, 3);
    let spent = RenderState::load(&path, &scene, &hour).unwrap();
    assert!(spent.seconds() > 0.0 && spent.seconds() < 600.0);
    assert_eq!(spent.passes_done(), 3);
    let options = RenderOptions { seconds: Some(spent.seconds()), ..hour };
    assert_eq!(run(&scene, &options, &path, 99).report.passes_done, 3);
    assert_eq!(run(&scene, &hour, &path, 1).report.passes_done, 4);
}

#[test]
fn another_render_is_refused_by_what_differs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("render.ckpt");
    let base = with_gather("knn");
    let options = RenderOptions::passes(1);
    let name = "fog_point.toml";
    run(&example(name, base.clone()), &options, &path, 1);
    let said = |scene: &Scene, options: &RenderOptions| {
        RenderState::load(&path, scene, options).unwrap_err().to_string()
    };
    for (overrides, words) in [
        (Overrides { seed: Some(7), ..base.clone() }, "photons.seed = 0 and this render has 7"),
        (Overrides { k: Some(21), ..base.clone() }, "estimate.k = 20 and this render has 21"),
        (Overrides { gather: Some("lattice".into()), ..base.clone() }, "render.gather = knn"),
        (Overrides { samples_per_pixel: Some(9), ..base.clone() }, "render.samples_per_pixel"),
        (Overrides { divisor: Some("k".into()), ..base.clone() }, "estimate.divisor = k-1"),
        (Overrides { emission: Some("random".into()), ..base.clone() }, "photons.emission"),
    ] {
        let said = said(&example(name, overrides), &options);
        assert!(said.contains(words) && said.contains("without --resume"), "{said}");
    }
    let limited = RenderOptions { target_error: Some(0.1), ..options };
    assert!(said(&example(name, base.clone()), &limited).contains("--target-error"));
    assert!(said(&example("fog_spot.toml", base.clone()), &options).contains("another scene"));
    let holdout = Overrides { background: Some("holdout".into()), ..base.clone() };
    let held_out = said(&example(name, holdout), &options);
    assert!(held_out.contains("render.background = its default"), "{held_out}");
    for (layers, word) in [
        (CostlyLayers { depths: true, lights: false }, "--layers depth = false"),
        (CostlyLayers { depths: false, lights: true }, "--layers lights = false"),
    ] {
        let layered = RenderOptions { layers, ..options };
        assert!(said(&example(name, base.clone()), &layered).contains(word));
    }
    assert!(RenderState::load(&path, &example(name, base), &options).is_ok());
}

/// Cut off anywhere, longer, with any byte changed, or something else altogether: an error, never a state.
#[test]
fn a_damaged_checkpoint_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("render.ckpt");
    let overrides = Overrides { lattice: Some(4), ..with_gather("lattice") };
    let scene = Overrides { resolution: Some([6, 3]), photons: Some(100), ..overrides };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes/fog_point.toml");
    let scene = Scene::load_with(&file, &scene).unwrap();
    let options = RenderOptions::passes(2);
    run(&scene, &options, &path, 2);
    let sound = fs::read(&path).unwrap();
    let refused = |bytes: &[u8]| -> CheckpointError {
        fs::write(&path, bytes).unwrap();
        RenderState::load(&path, &scene, &options).unwrap_err()
    };
    for len in 0..sound.len() {
        let error = refused(&sound[..len]);
        match len {
            0..8 => assert!(matches!(error, CheckpointError::Foreign { .. }), "{len}: {error}"),
            _ => assert!(matches!(error, CheckpointError::Damaged { .. }), "{len}: {error}"),
        }
    }
    for at in 0..sound.len() {
        for change in [1, 0x80, 0xff] {
            let mut bytes = sound.clone();
            bytes[at] ^= change;
            refused(&bytes);
        }
    }
    refused(&[&sound[..], &[0]].concat());
    refused(&[&sound[..], &sound[..]].concat());
    let mut newer = sound.clone();
    newer[8] = 2;
    assert!(matches!(refused(&newer), CheckpointError::OtherVersion { .. }));
    // Lengths that no memory would hold.
    for at in [12..16, 16..24] {
        let mut bytes = sound.clone();
        bytes[at].fill(0xff);
        refused(&bytes);
    }
    fs::write(&path, &sound).unwrap();
    assert!(RenderState::load(&path, &scene, &options).is_ok());
    let read = |path: PathBuf| RenderState::load(&path, &scene, &options).unwrap_err();
    assert!(matches!(read(folder.path().join("absent")), CheckpointError::Read { .. }));
    assert!(matches!(read(file), CheckpointError::Foreign { .. }));
    let directory = read(folder.path().to_path_buf()).to_string();
    assert!(directory.contains(&folder.path().display().to_string()), "{directory}");
}

/// A checkpoint that cannot be written ends no render.
#[test]
fn a_render_outlives_its_checkpoints() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("absent/render.ckpt");
    let scene = example("fog_point.toml", with_gather("lattice"));
    let observer = StopAfter { passes: 99, ..StopAfter::default() };
    let checkpoints = Checkpoints { resume_from: None, save_to: Some(&path) };
    let rendering = render_from(&scene, &RenderOptions::passes(3), &observer, checkpoints).unwrap();
    assert_eq!(rendering.report.passes_done, 3);
    assert_eq!(observer.failures.load(Ordering::Relaxed), 3);
}
