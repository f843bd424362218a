//! The lab's exact values against 90-digit arithmetic and against every number printed in the thesis's appendix A.

use std::path::{Path, PathBuf};

use photonvdb::lab::{BiasRequest, Constant, LabError, Law, Method, Model, law};
use serde_json::Value;

/// As many photons as any k here needs, an even number.
const MANY: u64 = 1 << 58;

fn lab(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/lab").join(name)
}

/// The model of a row, and a number of photons of the right parity.
fn model(name: &str, n: &str, k: u64) -> Law {
    let law = |model, n| law(model, n, k).unwrap().unwrap();
    match name {
        "random" if n == "inf" => Law::Random { n: f64::INFINITY, k },
        "random" => law(Model::Random(3), n.parse().unwrap()),
        "strat1d_same" => law(Model::Stratified, MANY + k % 2),
        "strat1d_diff" => law(Model::Stratified, MANY + 1 - k % 2),
        "basic" => law(Model::Basic(2), MANY),
        "order_volume" => law(Model::OrderVolume(3), MANY),
        "order2d_radius" => law(Model::Order(2), MANY),
        "order3d_radius" => law(Model::Order(3), MANY),
        other => panic!("{other}"),
    }
}

/// Largest k * |bias - truth| allowed.
fn tolerance(name: &str, k: u64) -> f64 {
    match name {
        "order2d_radius" | "order3d_radius" if k > 1_000_000 => 1e-9,
        "order2d_radius" | "order3d_radius" => 1e-11,
        _ => 1e-14,
    }
}

fn number(text: &str) -> f64 {
    if text.is_empty() { f64::INFINITY } else { text.parse().unwrap() }
}

fn check(name: &str, k: u64, law: &Law, constant: Constant, bias: f64, variance: f64) {
    let place = format!("{name} {} k = {k}", constant.name());
    let computed = constant.bias(k, law, None).unwrap();
    let error = computed - bias;
    assert!(computed == bias || k as f64 * error.abs() <= tolerance(name, k), "{place}: {error:e}");
    let computed = constant.variance(k, law, None).unwrap();
    let is_same = computed == variance || (computed - variance).abs() <= 1e-12 * variance;
    assert!(is_same, "{place}: variance {computed:e} instead of {variance:e}");
    if name == "basic" && constant == Constant::KMinusHalf {
        assert!(error.abs() <= 1e-14 * bias, "{place}: relative {:e}", error / bias);
    }
}

#[test]
fn bias_and_variance_are_those_of_long_arithmetic() {
    let table = std::fs::read_to_string(lab("models_truth.csv")).unwrap();
    let mut count = 0;
    for line in table.lines().skip(1) {
        let [name, n, k, constant, bias, variance] = line.split(',').collect::<Vec<_>>()[..] else {
            panic!("{line}")
        };
        let k = k.parse().unwrap();
        let constant = Constant::from_name(constant).unwrap();
        check(name, k, &model(name, n, k), constant, number(bias), number(variance));
        count += 1;
    }
    assert_eq!(count, 7588);
}

#[test]
fn they_still_are_at_a_million_millions() {
    let table = std::fs::read_to_string(lab("truth_large.csv")).unwrap();
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert_eq!(rows.len(), 36);
    for line in rows {
        let [name, k, bias, variance] = line.split(',').collect::<Vec<_>>()[..] else {
            panic!("{line}")
        };
        let k = k.parse().unwrap();
        check(name, k, &model(name, "", k), Constant::K, number(bias), number(variance));
    }
}

/// Six tables of 99 numbers each, within half a unit of the last digit printed.
#[test]
fn every_number_printed_in_the_thesis_is_confirmed() {
    let tables: Value =
        serde_json::from_str(&std::fs::read_to_string(lab("thesis_tables.json")).unwrap()).unwrap();
    let mut count = 0;
    for (name, model) in [("order2d", Model::Order(2)), ("order3d", Model::Order(3))] {
        for constant in [Constant::K, Constant::KMinus1, Constant::KMinusHalf] {
            let printed = tables["tables"][name][constant.name()].as_array().unwrap();
            for (k, printed) in (2..).zip(printed) {
                let printed = printed.as_str().unwrap();
                let digits = printed.split_once('.').unwrap().1.len() as i32;
                let mean =
                    1.0 + constant.bias(k, &law(model, MANY, k).unwrap().unwrap(), None).unwrap();
                let error = (mean - printed.parse::<f64>().unwrap()).abs();
                assert!(
                    error <= 0.5 * 10_f64.powi(-digits) + 1e-12,
                    "{name} {k}: {mean} {printed}"
                );
                count += 1;
            }
        }
    }
    assert_eq!(count, 594);
}

#[test]
fn the_first_approximation_is_that_of_the_thesis() {
    let bias = |n, k: u64, c: f64| {
        law(Model::FirstApproximation, n, k).unwrap().unwrap().bias(k as f64 - c)
    };
    for k in 2..50 {
        let c = k as f64;
        let same = 3.0 * c / (3.0 * c - 2.0) - 1.0;
        let mixed = 3.0 * c / (3.0 * c - 1.0) - 1.0;
        assert!((bias(100 + k % 2, k, c) - same).abs() < 1e-15);
        assert!((bias(101 - k % 2, k, c) - mixed).abs() < 1e-15);
        // It is a lower bound.
        let exact = law(Model::Stratified, 100 + k % 2, k).unwrap().unwrap().bias(0.0);
        assert!(k == 2 || exact > same, "{k}");
    }
}

/// u_(k) = k - 2 + U_1 + U_2 + U_3: means by 60-digit arithmetic.
#[test]
fn a_jittered_line_has_an_exact_law() {
    for (k, bias, half_bias, variance) in [
        (2, 0.5697444312936435, 0.17730832347023262, 0.9880872898439669),
        (3, 0.25391622589794793, 0.04493018824828993, 0.07874472999362246),
        (5, 0.12529048848553603, 0.012761439636982435, 0.01663140924441524),
        (10, 0.05556867790470618, 0.0027902440094708715, 0.0031282062323733113),
        (100, 0.005050506076026281, 2.525354564614984e-05, 2.551069352201733e-05),
        (1000, 0.000500500500600751, 2.5025035045063784e-07, 2.5050105190346564e-07),
    ] {
        let law = law(Model::Jittered(1), 10_000, k).unwrap().unwrap();
        for (computed, exact) in
            [(law.bias(0.0), bias), (law.bias(0.5), half_bias), (law.variance(), variance)]
        {
            assert!((computed - exact).abs() <= 1e-14 * exact, "{k}: {computed:e} {exact:e}");
        }
    }
}

#[test]
fn edge_cases_have_the_right_answer_or_a_clear_error() {
    for model in Model::ALL {
        let first = law(model, 100_000, 1).unwrap();
        let diverges = !matches!(model, Model::FirstApproximation | Model::FixedRadius);
        if let Some(first) = first {
            assert_eq!(first.bias(0.0).is_infinite(), diverges, "{}", model.name());
            assert_eq!(first.variance().is_infinite(), diverges, "{}", model.name());
            assert!(!Constant::KMinus1.variance(1, &first, None).unwrap().is_nan());
        }
        assert_eq!(law(model, 1000, 0), Err(LabError::KOutOfRange { k: 0 }));
        let error = law(model, 10, 11).unwrap_err().to_string();
        assert!(
            error.contains(model.name()) && error.contains("number 11 among n = 10"),
            "{error}"
        );
        for k in 1..200 {
            let Some(law) = law(model, 1_000_000, k).unwrap() else { continue };
            for constant in Constant::ALL {
                let counts = model.count_law(k);
                let bias = constant.bias(k, &law, counts);
                let variance = constant.variance(k, &law, counts);
                assert!(bias.is_none_or(|bias| !bias.is_nan()), "{} {k}", model.name());
                assert!(variance.is_none_or(|variance| !variance.is_nan()));
                let is_known = constant != Constant::Calibrated || counts.is_some();
                assert_eq!((bias.is_some(), variance.is_some()), (is_known, is_known));
            }
        }
    }
    // 0 * log 0 in every closed form: k = 2, n even.
    let second = law(Model::Stratified, 100, 2).unwrap().unwrap();
    assert_eq!((second.bias(0.0), second.bias(0.5), second.bias(1.0)), (1.0, 0.5, 0.0));
    assert!(second.variance().is_infinite());
    // All photons, and all but one.
    let mean = |n, k| 1.0 + law(Model::Stratified, n, k).unwrap().unwrap().bias(0.0);
    for (n, k, expected) in [(2, 2, 2.0), (3, 2, 1.295837), (4, 4, 1.227411), (5, 5, 1.168808)] {
        assert!((mean(n, k) - expected).abs() < 5e-7, "{n} {k}");
    }
    // The last shell is not complete.
    assert!(law(Model::Order(2), 1000, 990).is_ok());
    let error = law(Model::Order(2), 1000, 991).unwrap_err();
    assert_eq!(error, LabError::TooFewPhotons { model: "2d-order", n: 1000, k: 991, needed: 1035 });
}

/// What the calibrated constant leaves of the bias of k: nothing of random photons, less than a thousandth of photons in
/// shells and in the cells of a line.
#[test]
fn calibration_removes_the_bias_of_models_with_known_counts() {
    for k in [10, 11, 50, 200] {
        for (model, left) in [
            (Model::Random(3), 1e-12),
            (Model::Jittered(1), 0.001),
            (Model::Basic(2), 0.001),
            (Model::Basic(3), 0.001),
        ] {
            let law = law(model, 100_000, k).unwrap().unwrap();
            let bias = Constant::Calibrated.bias(k, &law, model.count_law(k)).unwrap();
            assert!(bias.abs() < left * law.bias(0.0), "{} k = {k}: {bias}", model.name());
        }
    }
}

#[test]
fn names_lead_back_to_models() {
    for model in Model::ALL {
        assert_eq!(Model::from_name(model.name()), Some(model));
        assert!(model.name().starts_with(&format!("{}d-", model.dimension())));
    }
    assert_eq!(Model::from_name("4d-random"), None);
}

#[test]
fn tables_hold_a_row_for_every_model_constant_and_k() {
    let request = BiasRequest {
        models: Model::ALL.to_vec(),
        n: None,
        ks: vec![50, 2, 50, 10],
        constants: Constant::ALL.to_vec(),
        trials: 0,
        method: Method::Fast,
        seed: 0,
    };
    let table = request.tabulate(|_| ()).unwrap();
    assert_eq!(table.rows.len(), 14 * 5 * 3 + 3);
    let json = serde_json::to_value(&table).unwrap();
    let second = json["rows"].as_array().unwrap().iter().find(|row| row["k"] == 2).unwrap();
    assert_eq!((&second["exact_bias"], &second["exact_variance"]), (&1.0.into(), &"inf".into()));
    let csv = table.to_csv();
    let row = csv.lines().find(|line| line.starts_with("3d-basic,k-1/2,1000,10,")).unwrap();
    assert!(row.contains(",9.2489874934986") && row.contains(",9.5000000000000000e0,"), "{row}");
    let row = csv.lines().find(|line| line.starts_with("3d-random,k,1000,2,")).unwrap();
    assert!(row.starts_with("3d-random,k,1000,2,2.0000000000000000e0,1.0000000000000000e0,inf,,,"));
}
