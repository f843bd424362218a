//! `photonvdb sweep` through the binary.

use crate::run::Workspace;
use serde_json::Value;

const SMALL: &str = "sweep fog.toml --resolution 16x12 --runs 2 --reference-spp 16 --photons 200,1000 --k 5,20 \
                     --target-error 0.5 --spp 2,4";

#[test]
fn a_sweep_is_shown_and_written() {
    let work = Workspace::new();
    let run = work.run(&format!("{SMALL} --plot a.svg --csv a.csv"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for part in [
        "fog.toml: 16 x 12 pixels, 2 runs; against 16 paths a pixel, whose noise of ",
        "stratified, k 20, k-1, 4 rays",
        "stratified, to 50 %",
        "efficiency",
        "* ",
    ] {
        assert!(run.stdout.contains(part), "{part} is not in\n{}", run.stdout);
    }
    assert_eq!(run.stderr, "");
    let svg = std::fs::read_to_string(work.path("a.svg")).unwrap();
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    assert_eq!(svg.matches("<text").count(), svg.matches("</text>").count());
    for label in ["Pareto front", "knn", "rendered to a target error", "reference path tracer"] {
        assert!(svg.contains(label), "{label}");
    }
    // knn: photons x k; lattice: photons; a target; two of paths.
    let csv = std::fs::read_to_string(work.path("a.csv")).unwrap();
    let modes: Vec<&str> = csv.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    assert_eq!(
        modes,
        ["knn", "knn", "knn", "knn", "lattice", "lattice", "target", "paths", "paths"]
    );
    let columns = |line: &str| line.split(',').count();
    assert!(csv.lines().all(|line| columns(line) == 18), "{csv}");

    // The same bytes again, with another number of threads; times come after them.
    let timed = work.run(&format!("{SMALL} --csv - --timing --threads 1 --quiet"));
    assert!(timed.stdout.lines().next().is_some_and(|line| line.ends_with(",efficiency,front")));
    for (plain, timed) in csv.lines().zip(timed.stdout.lines()) {
        assert!(timed.starts_with(plain) && columns(timed) == 21, "{plain}\n{timed}");
    }
}

#[test]
fn a_reference_given_sets_the_size_and_tells_its_noise() {
    let work = Workspace::new();
    let made = "reference fog.toml -o truth.exr --spp 16 --resolution 16x12 --quiet --seed 9";
    assert_eq!(work.run(made).code, Some(0));
    let lists = "--gather knn --photons 500 --k 2,8 --divisor k,calibrated --emission random,sobol --samples 1 --target-error \
                 none --spp none --runs 3";
    let run = work.run(&format!("sweep fog.toml --reference truth.exr {lists} --json -"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let json: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(
        (&json["reference"]["width"], &json["reference"]["height"]),
        (&16.into(), &12.into())
    );
    assert!(json["reference"]["paths"].is_null());
    assert!(json["reference"]["noise"].as_f64().is_some_and(|noise| noise > 0.0));
    let rows = json["rows"].as_array().unwrap();
    let named: Vec<_> = rows
        .iter()
        .map(|row| format!("{} {} {}", row["emission"], row["k"], row["divisor"]).replace('"', ""))
        .collect();
    let expected = ["random", "sobol"].map(|emission| {
        ["2 k", "8 k", "2 calibrated", "8 calibrated"].map(|rest| format!("{emission} {rest}"))
    });
    assert_eq!(named, expected.concat());
    for row in rows {
        let figure = |name: &str| row[name].as_f64().unwrap();
        assert!(figure("bias_high") >= figure("bias") && figure("efficiency") > 0.0, "{row}");
        assert_eq!((&row["samples"], &row["runs"]), (&1.into(), &3.into()));
    }
    assert!(rows.iter().any(|row| row["is_on_front"] == true));

    // An image of a render has no variance.
    assert_eq!(work.run("render fog.toml -o plain.exr --quiet").code, Some(0));
    let run = work.run(&format!("sweep fog.toml --reference plain.exr {lists}"));
    assert!(run.stdout.contains("fog.toml: 24 x 16 pixels") && run.stdout.contains("not known"));
}

#[test]
fn what_cannot_be_swept_is_named() {
    let work = Workspace::new();
    work.run("sweep missing.toml").fails_with("missing.toml");
    work.run("sweep fog.toml --reference missing.exr").fails_with("missing.exr");
    work.run("sweep fog.toml --gather none --target-error none --spp none")
        .fails_with("there is no setting to measure");
    work.run("sweep fog.toml --k 1").fails_with("must be at least 2 with divisor \"k-1\"");
    work.run("sweep fog.toml --lattice 1").fails_with("must lie in 2 to 512");
    work.run("sweep fog.toml --plot missing/a.svg").fails_with("missing");
    assert_eq!(work.run("render fog.toml -o a.exr --quiet").code, Some(0));
    work.run("sweep fog.toml --reference a.exr --resolution 8x8")
        .fails_with("the image is 8 x 8 pixels but its reference is 24 x 16");
    let many: Vec<String> = (2..10_003).map(|k| k.to_string()).collect();
    work.run(&format!("sweep fog.toml --k {}", many.join(","))).fails_with("10000 settings");
    for usage in [
        "--runs 1",
        "--spp 1",
        "--photons a",
        "--gather bounce",
        "--target-error 0",
        "--reference a.exr --reference-spp 4",
    ] {
        assert_eq!(work.run(&format!("sweep fog.toml {usage}")).code, Some(2), "{usage}");
    }
    assert_eq!(work.names(), ["a.exr", "fog.toml"]);
}
