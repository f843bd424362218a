//! `photonvdb compare` through the binary.

use crate::run::Workspace;
use serde_json::Value;

const SMALL: &str = "compare analytic:point-absorbing --n 20000 --queries 40";

#[test]
fn a_comparison_is_shown_and_written() {
    let work = Workspace::new();
    let run = work.run(&format!("{SMALL} --runs 3"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for part in
        ["random", "stratified", "sobol", "intrinsic bias", "photons", "sobol needs", "seconds"]
    {
        assert!(run.stdout.contains(part), "{part} is not in\n{}", run.stdout);
    }
    let run = work.run(&format!(
        "{SMALL} --runs 3 --k 5,10 --csv a.csv --plot a.svg --json - --emission random,sobol"
    ));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let json: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(json["rows"].as_array().map(Vec::len), Some(4));
    assert_eq!(json["costs"][1]["emission"], "sobol");
    assert_eq!(work.names(), ["a.csv", "a.svg", "fog.toml"]);
    let csv = std::fs::read_to_string(work.path("a.csv")).unwrap();
    let timed =
        work.run(&format!("{SMALL} --runs 3 --k 5,10 --csv - --emission random,sobol --timing"));
    for (plain, timed) in csv.lines().zip(timed.stdout.lines()) {
        assert!(
            timed.starts_with(plain) && timed.split(',').count() == plain.split(',').count() + 3
        );
    }
    assert!(timed.stdout.starts_with("scene,") && timed.stdout.contains(",seconds_ratio\n"));
    let bias: f64 = csv.lines().nth(1).unwrap().split(',').nth(6).unwrap().parse().unwrap();
    assert_eq!(json["rows"][0]["intrinsic_bias"], bias);
}

#[test]
fn what_cannot_be_compared_is_named() {
    let work = Workspace::new();
    for scene in ["nonsense", "analytic:nonsense", "point-absorbing", "fog.exr"] {
        let run = work.run(&format!("compare {scene}"));
        run.fails_with("analytic:point-absorbing");
        assert!(run.stderr.contains(scene), "{}", run.stderr);
    }
    work.run("compare missing.toml").fails_with("missing.toml");
    work.run(&format!("{SMALL} --pixels 8x6")).fails_with("--pixels is for scene files");
    work.run("compare fog.toml --n 500 --k 400")
        .fails_with("fog.toml: of 500 photons the map holds");
    work.run("compare fog.toml --reference missing.exr").fails_with("missing.exr");
    work.run(&format!("{SMALL} --k 1,5")).fails_with("take k from 2 on");
    work.run(&format!("{SMALL} --k 5000")).fails_with("raise --n or lower --k");
    assert_eq!(work.run(&format!("{SMALL} --k 0")).code, Some(2));
    assert_eq!(work.run(&format!("{SMALL} --n 1e9")).code, Some(2));
    assert_eq!(work.names(), ["fog.toml"]);
}

#[test]
fn a_scene_is_compared_at_points_and_in_pixels() {
    let work = Workspace::new();
    let small = "compare fog.toml --n 3000 --runs 3 --queries 30 --k 5,10 --pixels 6x4";
    let run = work.run(small);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for part in [
        "points: 30 places",
        "pixels: 24 of an image, k = 50",
        "the mean of 2 renders of 24000 photons",
        "points, k = 10: stratified needs ",
        "pixels, k = 50: sobol needs ",
        "seconds that random needs for the same error",
    ] {
        assert!(run.stdout.contains(part), "{part} is not in\n{}", run.stdout);
    }
    let run = work.run(&format!("{small} --photons-only --emission sobol --csv - --plot a.svg"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert_eq!(run.stdout.lines().count(), 1 + 2 + 1);
    assert!(
        run.stdout.lines().last().is_some_and(|line| line.starts_with("pixels,sobol,50,3000,"))
    );
    assert_eq!(work.names(), ["a.svg", "fog.toml"]);

    // The scene's own image as reference, averaged to a size that divides it.
    assert_eq!(work.run("render fog.toml -o a.exr --quiet").code, Some(0));
    let given = "compare fog.toml --n 3000 --runs 2 --queries 10 --k 5 --emission random,sobol";
    let run =
        work.run(&format!("{given} --reference a.exr --pixels 12x8 --json - --csv b.csv --timing"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let json: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(json["pixels"][1]["pixels"], 96);
    assert_eq!(json["reference"]["image_runs"], 0);
    assert!(json["pixel_savings"][0]["photons"].is_f64());
    let csv = std::fs::read_to_string(work.path("b.csv")).unwrap();
    assert!(
        csv.lines().next().is_some_and(|line| line.ends_with(",seconds,efficiency,seconds_ratio"))
    );
    work.run(&format!("{given} --reference a.exr --pixels 7x5")).fails_with("--pixels");
}
