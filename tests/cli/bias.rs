//! `photonvdb bias` through the binary, and the figures behind `--figures`.

use std::fs;

use crate::run::Workspace;
use photonvdb::lab::figures::{Studies, claims, figures, plotted_csv, plotted_numbers, report};
use serde_json::Value;

#[test]
fn tables_charts_and_json_are_written() {
    let work = Workspace::new();
    let run = work.run(
        "bias 3d-random 3d-basic --k 2..4,10 --trials 2000 --divisor k,k-1 \
         --csv a.csv --json a.json --plot a.svg",
    );
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for part in ["3d-basic", "5.361 %", "exact bias", "2000 trials", "processor time"] {
        assert!(run.stdout.contains(part), "{part} is not in\n{}", run.stdout);
    }
    let csv = fs::read_to_string(work.path("a.csv")).unwrap();
    assert!(csv.starts_with("model,divisor,n,k,exact_mean,exact_bias,exact_variance,trials,"));
    assert_eq!(csv.lines().count(), 1 + 2 * 2 * 4);
    let json: Value = serde_json::from_slice(&fs::read(work.path("a.json")).unwrap()).unwrap();
    assert_eq!(json["rows"].as_array().map(Vec::len), Some(16));
    assert!(json["rows"][3]["efficiency"].as_f64().unwrap() > 0.0);
    assert_eq!(json["experiments"][1]["model"], "3d-basic");
    let svg = fs::read_to_string(work.path("a.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("3d-random, k-1"));

    // Equal seeds give equal tables, on any number of threads; stdout is the table alone.
    let again = "bias 3d-random 3d-basic --k 2..4,10 --trials 2000 --divisor k,k-1 --csv -";
    assert_eq!(work.run(&format!("{again} --threads 1")).stdout, csv);
    assert_ne!(work.run(&format!("{again} --seed 1")).stdout, csv);
    let timed = work.run(&format!("{again} --timing")).stdout;
    let header = timed.lines().next().unwrap();
    assert!(header.ends_with(",seconds,efficiency"), "{header}");
    for (plain, timed) in csv.lines().zip(timed.lines()).skip(1) {
        let times = timed.strip_prefix(plain).unwrap().split(',').skip(1);
        let times: Vec<f64> = times.map(|time| time.parse().unwrap()).collect();
        assert!(times.len() == 2 && times.iter().all(|&time| time > 0.0), "{timed}");
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let work = Workspace::new();
    work.run("bias 3d-randm").fails_with("did you mean 3d-random?");
    work.run("bias 2d-order --k 991 --n 1000").fails_with("needs 1035 photons");
    work.run("bias 1d-random --k 5..2").fails_with("begins after its end");
    work.run("bias 1d-random --k 0").fails_with("whole number");
    work.run("bias 1d-random --csv missing/a.csv").fails_with("missing");
    work.run("bias").fails_with("MODEL");
    assert_eq!(work.names(), ["fog.toml"]);
    let exact = work.run("bias 3d-order --k 1e12 --exact-only");
    assert!(exact.stdout.contains("1.014e-11 %"), "{}", exact.stdout);
}

/// A hundredth of the experiments: every figure can be drawn, every claim decided.
#[test]
fn every_figure_of_the_thesis_is_drawn() {
    let studies = Studies::run(1, 0.01, |_| ()).unwrap();
    let figures = figures(&studies);
    let names: Vec<&str> = figures.iter().map(|figure| figure.name.as_str()).collect();
    for name in ["1.2", "2.6", "3.1", "3.6", "4.1a", "4.2f", "4.3c", "5.1", "variance", "jittered"]
    {
        assert!(names.contains(&name), "{name}");
    }
    assert_eq!(names.iter().filter(|name| name.starts_with("4.")).count(), 18);
    for name in ["emission", "emission-divisors", "jittered-divisors"] {
        assert!(names.contains(&name), "{name}");
    }
    for figure in &figures {
        let svg = figure.to_svg().unwrap();
        assert!(svg.len() > 2000 && !svg.contains("NaN"), "{}", figure.name);
    }
    let numbers = plotted_numbers(&figures);
    assert!(numbers.iter().all(|number| number.x.is_finite()));
    assert_eq!(plotted_csv(&numbers).lines().count(), 1 + numbers.len());

    // What theory alone decides does not depend on the experiments.
    let claims = claims(&studies);
    let verdict = |part: &str| claims.iter().find(|claim| claim.claim.contains(part)).unwrap();
    assert!(!verdict("1-D, even n: error below 8 %").holds);
    assert!(verdict("2-D order: error below 20 %").holds);
    assert!(verdict("3-D order: error below 20 %").finding.contains("+20.19 % at k = 3"));
    assert!(verdict("3-D basic: error below 4 %").holds);
    assert!(!verdict("smallest error").holds);
    let report = report(&studies);
    assert!(report.contains("| 3-D jittered cells | 10 | 9.2"), "{report}");
    assert!(report.contains("| random emission | 100 | 9"), "{report}");
    assert!(report.contains("| k-1/2 in 3-D basic: error below 4 % | yes |"));
}
