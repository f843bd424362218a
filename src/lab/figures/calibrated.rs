//! What the calibrated divisor leaves of the bias: in jittered cells, and among photons emitted as for a render.

use super::Figure;
use super::study::Studies;
use crate::lab::bias::BiasRow;
use crate::lab::compare::CompareRow;
use crate::lab::constant::Constant;
use crate::lab::plot::{Chart, Scale, Series};

/// The k of the report.
const SHOWN: [u64; 5] = [10, 20, 50, 100, 200];

/// Bias of the renderer's photons, and with each divisor; then of jittered cells with each divisor.
pub(super) fn figures(studies: &Studies) -> Vec<Figure> {
    vec![emission(studies), emission_divisors(studies), jittered_divisors(studies)]
}

/// Intrinsic bias of k by k, random and stratified, against the laws.
fn emission(studies: &Studies) -> Figure {
    let series = ["random", "stratified"].map(|emission| {
        let rows = || studies.emission.rows.iter().filter(move |row| row.emission == emission);
        Series {
            label: format!("{emission} emission"),
            line: rows().map(|row| (row.k as f64, row.law_bias)).collect(),
            points: rows().map(|row| (row.k as f64, row.intrinsic_bias, row.std_error)).collect(),
        }
    });
    let title =
        "Bias of k about a point light: the renderer's photons (line: 1/(k-1), law of cells)";
    figure("emission", title, Scale::Logarithmic, series.into())
}

/// Stratified emission with each divisor.
fn emission_divisors(studies: &Studies) -> Figure {
    let rows = || studies.emission.rows.iter().filter(|row| row.emission == "stratified");
    let of_divisor = |label: &str, bias: fn(&CompareRow) -> f64| Series {
        label: label.into(),
        line: Vec::new(),
        points: rows().map(|row| (row.k as f64, bias(row), row.std_error)).collect(),
    };
    let series = vec![
        of_divisor("k", |row| row.intrinsic_bias),
        of_divisor("k-1/2", |row| row.intrinsic_bias_k_minus_half),
        of_divisor("k-1", |row| row.intrinsic_bias_k_minus_1),
        of_divisor("calibrated, from other maps", |row| row.intrinsic_bias_calibrated),
    ];
    let title = "Stratified emission about a point light, by divisor";
    figure("emission-divisors", title, Scale::Linear, series)
}

/// Three-dimensional jittered cells with each divisor.
fn jittered_divisors(studies: &Studies) -> Figure {
    let divisors =
        [Constant::K, Constant::KMinusHalf, Constant::KMinus1, Constant::Calibrated].into_iter();
    let series = divisors.map(|constant| studies.jittered[2].bias(constant, constant.name()));
    figure("jittered-divisors", "3-D jittered cells, by divisor", Scale::Linear, series.collect())
}

fn figure(name: &str, title: &str, y_scale: Scale, series: Vec<Series>) -> Figure {
    let chart = Chart {
        title: title.into(),
        x_label: "k".into(),
        y_label: "relative error".into(),
        x_scale: Scale::Logarithmic,
        y_scale,
        series,
    };
    Figure { name: name.into(), chart }
}

/// The same as a part of the report.
pub(super) fn section(studies: &Studies) -> String {
    let mut text = String::from(
        "\n## Calibrated divisor\n\n\
         c from the variance of photon counts in balls. In jittered cells the variance is that of their surface; about \
         the point light it is measured in maps other than those tried. Bias in per cent, +- standard error.\n\n\
         | photons | k | c | bias of k | bias of c |\n|---|---|---|---|---|\n",
    );
    let percent = |bias: f64, error: f64| format!("{:+.3} +- {:.3}", 100.0 * bias, 100.0 * error);
    let grid = &studies.jittered[2];
    let measured = |row: &BiasRow| row.measured_bias.zip(row.std_error);
    for (of_k, calibrated) in grid.rows(Constant::K).zip(grid.rows(Constant::Calibrated)) {
        let k = of_k.k;
        let is_shown = SHOWN.contains(&k);
        let both = measured(of_k).zip(measured(calibrated)).zip(calibrated.c);
        if let Some((((bias, error), (left, left_error)), c)) = both.filter(|_| is_shown) {
            let (bias, left) = (percent(bias, error), percent(left, left_error));
            text += &format!("| 3-D jittered cells | {k} | {c:.3} | {bias} | {left} |\n");
        }
    }
    for row in studies.emission.rows.iter().filter(|row| SHOWN.contains(&row.k)) {
        let bias = percent(row.intrinsic_bias, row.std_error);
        let left = percent(row.intrinsic_bias_calibrated, row.std_error);
        let (emission, k, c) = (row.emission, row.k, row.calibrated_k);
        text += &format!("| {emission} emission | {k} | {c:.3} | {bias} | {left} |\n");
    }
    text
}
