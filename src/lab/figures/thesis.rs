//! The figures of the thesis: relative error by k.

use super::Figure;
use super::study::{Studies, Study};
use crate::lab::constant::Constant;
use crate::lab::plot::{Chart, Scale, Series};

/// All of them, in order.
pub(super) fn figures(studies: &Studies) -> Vec<Figure> {
    let Studies { random, first_even, first_odd, line_even, line_odd, basic_2d, order_2d, .. } =
        studies;
    let Studies { basic_3d, order_3d, .. } = studies;
    let mut figures = vec![
        figure("1.2", "1-D random photons", vec![random.bias(Constant::K, "k")]),
        figure(
            "2.6",
            "1-D first approximation",
            vec![
                first_even.exact_bias(Constant::K, "even n (2.2 for even k, 2.3 for odd k)"),
                first_odd.exact_bias(Constant::K, "odd n"),
            ],
        ),
    ];
    let setups: [(&str, &str, &Study); 6] = [
        ("a", "1-D stratified, even n", line_even),
        ("b", "1-D stratified, odd n", line_odd),
        ("c", "2-D basic", basic_2d),
        ("d", "2-D order statistics", order_2d),
        ("e", "3-D basic", basic_3d),
        ("f", "3-D order statistics", order_3d),
    ];
    for (number, (_, title, study)) in (1..).zip(setups) {
        let series = vec![study.bias(Constant::K, "k")];
        figures.push(figure(&format!("3.{number}"), title, series));
    }
    for (chapter, constant) in [("4.1", Constant::KMinus1), ("4.2", Constant::KMinusHalf)] {
        for (letter, title, study) in setups {
            let title = format!("{title}, divisor {}", constant.name());
            let series = vec![study.bias(constant, constant.name())];
            figures.push(figure(&format!("{chapter}{letter}"), &title, series));
        }
    }
    for (letter, title, study) in setups {
        let series = [Constant::K, Constant::KMinusHalf, Constant::KMinus1]
            .map(|constant| study.exact_bias(constant, constant.name()));
        let title = format!("{title}, three estimators");
        figures.push(figure(&format!("4.3{letter}"), &title, series.into()));
    }
    figures.push(figure(
        "5.1",
        "Random and stratified photons in one dimension",
        vec![random.bias(Constant::K, "random"), line_even.bias(Constant::K, "stratified, even n")],
    ));
    figures
}

fn figure(name: &str, title: &str, series: Vec<Series>) -> Figure {
    let chart = Chart {
        title: format!("{name}  {title}"),
        x_label: "k".into(),
        y_label: "relative error".into(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        series,
    };
    Figure { name: name.into(), chart }
}
