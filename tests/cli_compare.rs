//! `photonvdb compare` through the binary.

mod cli_run;

use cli_run::Workspace;
use serde_json::Value;

const SMALL: &str = "compare analytic:point-absorbing --n 20000 --queries 40";

#[test]
fn a_comparison_is_shown_and_written() {
    let work = Workspace::new();
    let run = work.run(&format!("{SMALL} --runs 3"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for part in ["random", "stratified", "sobol", "intrinsic bias", "photons"] {
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
    let bias: f64 = csv.lines().nth(1).unwrap().split(',').nth(6).unwrap().parse().unwrap();
    assert_eq!(json["rows"][0]["intrinsic_bias"], bias);
}

#[test]
fn what_cannot_be_compared_is_named() {
    let work = Workspace::new();
    for scene in ["nonsense", "analytic:nonsense", "point-absorbing", "fog.toml"] {
        let run = work.run(&format!("compare {scene}"));
        run.fails_with("analytic:point-absorbing");
        assert!(run.stderr.contains(scene), "{}", run.stderr);
    }
    work.run(&format!("{SMALL} --k 1,5")).fails_with("take k from 2 on");
    work.run(&format!("{SMALL} --k 5000")).fails_with("raise --n or lower --k");
    assert_eq!(work.run(&format!("{SMALL} --k 0")).code, Some(2));
    assert_eq!(work.run(&format!("{SMALL} --n 1e9")).code, Some(2));
    assert_eq!(work.names(), ["fog.toml"]);
}
