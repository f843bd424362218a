//! Every graph of the thesis, drawn anew, with what follows from them beside: variance, jittered cells, photons emitted as
//! for a render, and the calibrated divisor.
//!
//! Theory is drawn as lines, experiments as points with error bars of one standard error. Each experiment repeats the
//! thesis's own with ten times its repetitions; figures 3.x, 4.1, 4.2 and 4.3 share the same seven.

mod beyond;
mod calibrated;
mod claims;
mod study;
mod thesis;

pub use claims::{Claim, claims, report};
pub use study::Studies;

use serde::Serialize;

use super::csv::number;
use super::error::LabError;
use super::plot::Chart;

/// A chart and its name.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Number in the thesis, or a word.
    pub name: String,
    /// What it shows.
    pub chart: Chart,
}

/// All figures of the thesis and those beyond it.
///
/// # Errors
/// An experiment cannot be made.
pub fn figures(studies: &Studies) -> Vec<Figure> {
    let mut figures = thesis::figures(studies);
    figures.extend(beyond::figures(studies));
    figures.extend(calibrated::figures(studies));
    figures
}

impl Figure {
    /// Name of its file.
    pub fn file_name(&self) -> String {
        format!("figure-{}.svg", self.name)
    }

    /// The figure as an SVG document.
    ///
    /// # Errors
    /// It has nothing to draw.
    pub fn to_svg(&self) -> Result<String, LabError> {
        self.chart.to_svg()
    }
}

/// One number of a figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlottedNumber {
    /// Name of the figure.
    pub figure: String,
    /// Label of the series.
    pub series: String,
    /// "theory" or "experiment".
    pub kind: &'static str,
    /// Along the x axis, mostly k.
    pub x: f64,
    /// Along the y axis.
    pub y: f64,
    /// Standard error, of experiments.
    pub std_error: Option<f64>,
}

/// Every number drawn, in order.
pub fn plotted_numbers(figures: &[Figure]) -> Vec<PlottedNumber> {
    let mut numbers = Vec::new();
    for Figure { name, chart } in figures {
        for series in &chart.series {
            let plotted = |kind, x, y, std_error| {
                let (figure, series) = (name.clone(), series.label.clone());
                PlottedNumber { figure, series, kind, x, y, std_error }
            };
            numbers.extend(series.line.iter().map(|&(x, y)| plotted("theory", x, y, None)));
            numbers.extend(
                series.points.iter().map(|&(x, y, error)| plotted("experiment", x, y, Some(error))),
            );
        }
    }
    numbers
}

/// The numbers as CSV, a header first.
pub fn plotted_csv(numbers: &[PlottedNumber]) -> String {
    let mut text = String::from("figure,series,kind,x,y,std_error\n");
    for plotted in numbers {
        let PlottedNumber { figure, series, kind, x, y, std_error } = plotted;
        let (x, y, std_error) = (number(Some(*x)), number(Some(*y)), number(*std_error));
        // Labels hold commas, but no quotes.
        text += &format!("{figure},\"{series}\",{kind},{x},{y},{std_error}\n");
    }
    text
}
