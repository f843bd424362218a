//! Figures the thesis leaves open: variance, and photons stratified as a renderer stratifies them.

use super::Figure;
use super::study::Studies;
use crate::lab::constant::Constant;
use crate::lab::jitter::JitterLaw;
use crate::lab::plot::{Chart, Scale, Series};

/// All of them.
pub(super) fn figures(studies: &Studies) -> Vec<Figure> {
    vec![variance(studies), variance_ratio(studies), jittered(studies), reduction(studies)]
}

/// Variance of k/u by model.
fn variance(studies: &Studies) -> Figure {
    let series = vec![
        studies.random.variance(Constant::K, "random"),
        studies.order_3d.variance(Constant::K, "3-D order"),
        studies.jittered[2].variance(Constant::K, "3-D jittered"),
        studies.jittered[1].variance(Constant::K, "2-D jittered"),
        studies.jittered[0].variance(Constant::K, "1-D jittered"),
        studies.line_even.variance(Constant::K, "1-D stratified"),
        studies.basic_3d.variance(Constant::K, "basic"),
    ];
    logarithmic("variance", "Variance of the k estimator", "variance", series)
}

/// How many times as many random photons would have the same variance.
fn variance_ratio(studies: &Studies) -> Figure {
    let random: Vec<(f64, f64)> = studies.random.variance(Constant::K, "").line;
    let series = (1..).zip(&studies.jittered).map(|(dimension, study)| {
        let stratified = study.variance(Constant::K, "");
        let ratios = stratified.points.iter().zip(&random).filter(|(_, (_, v))| v.is_finite());
        let law = JitterLaw::new(dimension);
        Series {
            label: format!("{dimension}-D jittered"),
            line: random
                .iter()
                .filter(|(k, v)| v.is_finite() && *k >= 5.0)
                .map(|&(k, v)| (k, v / law.variance(k)))
                .collect(),
            points: ratios
                .map(|(&(k, v, error), &(_, random))| (k, random / v, random * error / (v * v)))
                .collect(),
        }
    });
    let title = "Variance of random photons over that of jittered ones (line: law of the surface)";
    logarithmic("variance-ratio", title, "ratio", series.collect())
}

/// Bias of jittered grids against the law of their surface and the random model.
fn jittered(studies: &Studies) -> Figure {
    let mut series = vec![studies.random.exact_bias(Constant::K, "random")];
    for (dimension, study) in (1..).zip(&studies.jittered) {
        let law = JitterLaw::new(dimension);
        let measured = study.bias(Constant::K, "");
        series.push(Series {
            label: format!("{dimension}-D jittered"),
            line: (2..=200).map(f64::from).map(|k| (k, law.bias(k))).collect(),
            points: measured.points,
        });
    }
    let title = "Bias of the k estimator, one photon a cell, query at random (line: k / (k - 1/2 - g/2) - 1)";
    logarithmic("jittered", title, "relative error", series)
}

/// The share of the random model's bias that stratification takes away.
fn reduction(studies: &Studies) -> Figure {
    let mut series = vec![
        studies.basic_3d.exact_bias(Constant::K, "basic"),
        studies.order_3d.exact_bias(Constant::K, "3-D order"),
    ];
    for (dimension, study) in (1..).zip(&studies.jittered) {
        let mut measured = study.bias(Constant::K, format!("{dimension}-D jittered"));
        measured.line.clear();
        series.push(measured);
    }
    for series in &mut series {
        // The random model's bias is 1 / (k - 1).
        for (k, y) in &mut series.line {
            *y = 1.0 - *y * (*k - 1.0);
        }
        for (k, y, error) in &mut series.points {
            (*y, *error) = (1.0 - *y * (*k - 1.0), *error * (*k - 1.0));
        }
        series.points.retain(|&(_, _, error)| error < 0.05);
    }
    let chart = Chart {
        title: "Share of the random model's bias that stratification takes away".into(),
        x_label: "k".into(),
        y_label: "reduction".into(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Linear,
        series,
    };
    Figure { name: "reduction".into(), chart }
}

fn logarithmic(name: &str, title: &str, y_label: &str, series: Vec<Series>) -> Figure {
    let chart = Chart {
        title: title.into(),
        x_label: "k".into(),
        y_label: y_label.into(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series,
    };
    Figure { name: name.into(), chart }
}
