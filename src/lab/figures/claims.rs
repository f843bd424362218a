//! What the thesis says of its estimators, held against exact values.

use std::fmt::Write;

use super::calibrated;
use super::study::{Studies, Study};
use crate::lab::bias::BiasRow;
use crate::lab::constant::Constant;

/// A claim of the thesis and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// In the thesis's sense.
    pub claim: &'static str,
    /// Whether it holds for every k of its figures.
    pub holds: bool,
    /// The numbers that decide.
    pub finding: String,
}

/// Bias by k, exact where a law is known.
fn biases(study: &Study, constant: Constant) -> Vec<(u64, f64)> {
    let bias = |row: &BiasRow| row.exact_bias.or(row.measured_bias);
    study.rows(constant).filter_map(|row| Some((row.k, bias(row)?))).collect()
}

/// The k and the bias of the largest relative error.
fn worst(study: &Study, constant: Constant) -> (u64, f64) {
    let largest = |a: (u64, f64), b: (u64, f64)| if b.1.abs() > a.1.abs() { b } else { a };
    biases(study, constant).into_iter().fold((0, 0.0), largest)
}

/// All claims.
pub fn claims(studies: &Studies) -> Vec<Claim> {
    let Studies { line_even, line_odd, basic_2d, order_2d, basic_3d, order_3d, .. } = studies;
    let stratified = [line_even, line_odd, basic_2d, order_2d, basic_3d, order_3d];
    let mut claims = vec![fits(studies), sign(&stratified)];
    let half = |claim, study, limit: f64| {
        let (k, bias) = worst(study, Constant::KMinusHalf);
        let finding = format!("largest error {:+.2} % at k = {k}", 100.0 * bias);
        Claim { claim, holds: bias.abs() < limit, finding }
    };
    claims.extend([
        half("k-1/2 in 1-D, even n: error below 8 %", line_even, 0.08),
        half("k-1/2 in 2-D basic: error below 8 %", basic_2d, 0.08),
        half("k-1/2 in 2-D order: error below 20 %", order_2d, 0.20),
        half("k-1/2 in 3-D order: error below 20 %", order_3d, 0.20),
        half("k-1/2 in 3-D basic: error below 4 %", basic_3d, 0.04),
        smallest(&stratified),
    ]);
    claims.extend([
        reduction("Stratification reduces the bias by more than 50 %: 1-D, even n", line_even),
        reduction("The same: 2-D and 3-D basic", basic_3d),
        reduction("The same: 2-D order", order_2d),
        reduction("The same: 3-D order", order_3d),
        reduction("The same: real grids in 1-D, query at random", &studies.jittered[0]),
        reduction("The same: real grids in 2-D, query at random", &studies.jittered[1]),
        reduction("The same: real grids in 3-D, query at random", &studies.jittered[2]),
        no_constant(studies),
    ]);
    claims
}

/// Models and experiments match.
fn fits(studies: &Studies) -> Claim {
    let rows = [
        &studies.random,
        &studies.line_even,
        &studies.line_odd,
        &studies.basic_2d,
        &studies.order_2d,
        &studies.basic_3d,
        &studies.order_3d,
    ];
    let zs: Vec<f64> = rows
        .iter()
        .flat_map(|study| study.rows(Constant::K))
        .filter(|row| row.k >= 5)
        .filter_map(|row| row.z)
        .collect();
    let largest = zs.iter().fold(0.0_f64, |largest, z| largest.max(z.abs()));
    let finding = format!(
        "{} means at k >= 5 lie within {largest:.1} standard errors of the exact ones",
        zs.len()
    );
    Claim { claim: "Models and experiments match", holds: largest < 4.5, finding }
}

/// The three estimators lie in order of their constants: above, between, below.
fn sign(stratified: &[&Study]) -> Claim {
    let count = |constant: Constant, is: fn(f64) -> bool| {
        let all = stratified.iter().flat_map(|study| biases(study, constant));
        all.filter(|&(_, bias)| is(bias)).count()
    };
    let total = stratified.iter().map(|study| biases(study, Constant::K).len()).sum::<usize>();
    let above = count(Constant::K, |bias| bias > 0.0);
    let not_above = count(Constant::KMinus1, |bias| bias <= 0.0);
    let half_above = count(Constant::KMinusHalf, |bias| bias > 0.0);
    Claim {
        claim: "k overestimates, k-1 underestimates, k-1/2 is a mixture",
        holds: above == total && not_above == total,
        finding: format!(
            "of {total} means k is above in {above}, k-1 not above in {not_above}, k-1/2 above in {half_above}"
        ),
    }
}

/// k-1/2 has the smallest error of the three.
fn smallest(stratified: &[&Study]) -> Claim {
    let mut best_count = 0;
    let mut total = 0;
    for study in stratified {
        let [k, half, less] = [Constant::K, Constant::KMinusHalf, Constant::KMinus1]
            .map(|constant| biases(study, constant));
        total += k.len();
        best_count += (0..k.len())
            .filter(|&i| half[i].1.abs() <= k[i].1.abs() && half[i].1.abs() <= less[i].1.abs())
            .count();
    }
    Claim {
        claim: "k-1/2 has the smallest error of the three",
        holds: best_count == total,
        finding: format!("it has for {best_count} of {total} k; in order models often not"),
    }
}

fn reduction(claim: &'static str, study: &Study) -> Claim {
    // Up to k = 100 the errors of an experiment are small beside what is asked.
    let reductions: Vec<f64> = biases(study, Constant::K)
        .into_iter()
        .filter(|(k, _)| *k <= 100)
        .map(|(k, bias)| 1.0 - bias * (k - 1) as f64)
        .collect();
    let least = reductions.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = reductions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mean = reductions.iter().sum::<f64>() / reductions.len().max(1) as f64;
    let finding = format!(
        "reduction {:.1} to {:.1} %, {:.1} % on average (k = 2 to 100)",
        100.0 * least,
        100.0 * greatest,
        100.0 * mean
    );
    Claim { claim, holds: least > 0.5, finding }
}

fn no_constant(studies: &Studies) -> Claim {
    let constant = |study: &Study| {
        study.rows(Constant::Unbiased).find(|row| row.k == 10).and_then(|row| row.c)
    };
    let mut finding = String::from("there is one for each model, 1 / E[1/u]; at k = 10:");
    for (name, study) in [
        ("1-D even n", &studies.line_even),
        ("1-D odd n", &studies.line_odd),
        ("basic", &studies.basic_3d),
        ("3-D order", &studies.order_3d),
        ("1-D grid", &studies.jittered[0]),
    ] {
        if let Some(c) = constant(study) {
            // Writing to a string cannot fail.
            let _ = write!(finding, " {name} {c:.4},");
        }
    }
    finding.pop();
    Claim {
        claim: "No simple constant removes the bias of stratified photons",
        holds: false,
        finding,
    }
}

/// The claims as a Markdown document.
pub fn report(studies: &Studies) -> String {
    let mut text = String::from(
        "# The thesis's claims, tested\n\n\
         Theory is exact; experiments repeat those of the thesis with ten times its repetitions, at k = 2 to 200.\n\n\
         | claim | holds | found |\n|---|---|---|\n",
    );
    for Claim { claim, holds, finding } in claims(studies) {
        let holds = if holds { "yes" } else { "no" };
        text += &format!("| {claim} | {holds} | {finding} |\n");
    }
    text + &calibrated::section(studies)
}
