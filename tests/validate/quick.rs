//! The quick form of `validate`, and that wrong answers are found out.

use photonvdb::validate::{Extent, Truth, Verdict, validate};

#[test]
fn quick_quantities_pass() {
    let report = validate(Extent::Quick, &Truth::embedded().unwrap(), 0, |_, _| ()).unwrap();
    for row in report.rows.iter().filter(|row| row.verdict != Verdict::Pass) {
        println!("{row:?}");
    }
    assert!(report.passes());
    let groups =
        ["infinite medium", "ball", "slab", "glow", "airlight", "heterogeneous", "identities"];
    for group in groups.into_iter().chain(["furnace", "neighbours"]) {
        assert!(report.rows.iter().any(|row| row.group == group), "{group}");
    }
    assert!(report.rows.len() > 200, "{}", report.rows.len());
    let knows = |exact: f64| report.rows.iter().any(|row| (row.exact - exact).abs() < 5e-9);
    assert!(knows(0.09739464) && knows(0.66095770), "van de Hulst's slab");
    assert!(report.rows.iter().all(|row| row.measured.is_finite()));
}

/// Truths that are off by a tenth or less are found out, and nothing else is.
#[test]
fn wrong_truths_fail() {
    let mut truth = Truth::embedded().unwrap();
    let van_de_hulst = |row: &&mut photonvdb::validate::SlabTruth| {
        (row.albedo, row.g, row.tau) == (0.9, 0.75, Some(2.0))
    };
    truth.slab.iter_mut().find(van_de_hulst).unwrap().reflected_normal *= 1.1;
    truth.hetero.tracking[0].ratio_variance *= 1.1;
    truth.hetero.depths[0].tau *= 1.00001;
    truth.airlight[0].radiance *= 1.01;
    let report = validate(Extent::Quick, &truth, 1, |_, _| ()).unwrap();
    assert!(!report.passes());
    let failed: Vec<&str> = report
        .rows
        .iter()
        .filter(|row| row.verdict == Verdict::Fail)
        .map(|row| row.quantity.as_str())
        .collect();
    assert_eq!(
        failed,
        [
            "ramp_axis: depth",
            "albedo 0.9, g 0.75, tau 2, normal: reflected",
            "albedo 0.9, g 0.75, tau 2, normal: escaped",
            "inf_iso_easy",
            "ramp_axis: ratio tracking, variance",
        ]
    );
}
