//! `photonvdb validate` through the binary.

use serde_json::Value;

use crate::cli_run::Workspace;

#[test]
fn hard_cases_are_shown_and_written() {
    let work = Workspace::new();
    let run = work.run("validate --hard --json hard.json");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for part in ["exact", "measured", "std error", "needle spots", "0 failed"] {
        assert!(run.stdout.contains(part), "{part} is not in\n{}", run.stdout);
    }
    let text = std::fs::read_to_string(work.path("hard.json")).unwrap();
    let json: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["failed"], 0);
    assert_eq!(json["passed"].as_u64(), json["rows"].as_array().map(|rows| rows.len() as u64));
    assert_eq!(json["rows"][0]["verdict"], "pass");
}

#[test]
fn bad_usage_is_told_apart_from_failure() {
    let work = Workspace::new();
    assert_eq!(work.run("validate --full --hard").code, Some(2));
    assert_eq!(work.run("validate --seed none").code, Some(2));
    assert_eq!(work.run("validate --hard --json missing/hard.json").code, Some(2));
}
