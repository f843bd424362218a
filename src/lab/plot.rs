//! Charts as SVG: theory as lines, experiments as points with error bars.

use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;

use super::error::LabError;

/// What is drawn in one colour.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// In the legend.
    pub label: String,
    /// Joined by a line: x, y.
    pub line: Vec<(f64, f64)>,
    /// x, y, and the half length of the error bar.
    pub points: Vec<(f64, f64, f64)>,
}

/// Where values stand along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By their logarithm; values not above 0 are left out.
    Logarithmic,
}

/// A chart of several series over one pair of axes.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Above the chart.
    pub title: String,
    /// Below the x axis.
    pub x_label: String,
    /// Beside the y axis.
    pub y_label: String,
    /// Of the x axis.
    pub x_scale: Scale,
    /// Of the y axis.
    pub y_scale: Scale,
    /// What is drawn, the first below the others.
    pub series: Vec<Series>,
}

/// Least and greatest value of an axis.
type Range = (f64, f64);

const SIZE: (u32, u32) = (900, 560);
const MARGIN: u32 = 16;
const FONT: &str = "sans-serif";
const ERROR_BAR_WIDTH: u32 = 6;

/// Okabe and Ito's colours, which people with colour-blindness can tell apart.
const COLORS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
    RGBColor(150, 150, 60),
];

impl Chart {
    /// The chart as an SVG document.
    ///
    /// # Errors
    /// There is nothing to draw.
    pub fn to_svg(&self) -> Result<String, LabError> {
        let failed = |error: &dyn std::fmt::Display| LabError::Plot {
            title: self.title.clone(),
            reason: error.to_string(),
        };
        let (x, y) = self.ranges().ok_or_else(|| failed(&"it has no finite values"))?;
        let mut svg = String::new();
        let drawn = match (self.x_scale, self.y_scale) {
            (Scale::Linear, Scale::Linear) => self.draw(&mut svg, (x, y), x.0..x.1, y.0..y.1),
            (Scale::Linear, Scale::Logarithmic) => {
                self.draw(&mut svg, (x, y), x.0..x.1, (y.0..y.1).log_scale())
            }
            (Scale::Logarithmic, Scale::Linear) => {
                self.draw(&mut svg, (x, y), (x.0..x.1).log_scale(), y.0..y.1)
            }
            (Scale::Logarithmic, Scale::Logarithmic) => {
                self.draw(&mut svg, (x, y), (x.0..x.1).log_scale(), (y.0..y.1).log_scale())
            }
        };
        drawn.map_err(|error| failed(&error))?;
        Ok(svg)
    }

    fn draw<X, Y>(&self, svg: &mut String, ranges: (Range, Range), x: X, y: Y) -> Result<(), String>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: ValueFormatter<f64>,
        Y::CoordDescType: ValueFormatter<f64>,
    {
        let text = |error: &dyn std::fmt::Display| error.to_string();
        let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
        area.fill(&WHITE).map_err(|error| text(&error))?;
        let mut chart = ChartBuilder::on(&area)
            .caption(&self.title, (FONT, 20))
            .margin(MARGIN)
            .x_label_area_size(44)
            .y_label_area_size(64)
            .build_cartesian_2d(x, y)
            .map_err(|error| text(&error))?;
        chart
            .configure_mesh()
            .x_desc(&self.x_label)
            .y_desc(&self.y_label)
            .label_style((FONT, 14))
            .axis_desc_style((FONT, 16))
            .light_line_style(TRANSPARENT)
            .x_label_formatter(&|value| short(*value, ranges.0))
            .y_label_formatter(&|value| short(*value, ranges.1))
            .draw()
            .map_err(|error| text(&error))?;
        for (series, &color) in self.series.iter().zip(COLORS.iter().cycle()) {
            let line: Vec<(f64, f64)> =
                series.line.iter().copied().filter(|&(x, y)| self.shows(x, y)).collect();
            let has_line = !line.is_empty();
            chart
                .draw_series(LineSeries::new(line, color.stroke_width(2)))
                .map_err(|error| text(&error))?
                .label(&series.label)
                .legend(move |(x, y)| {
                    // A line for theory, a dot for what was only measured.
                    let end = if has_line { 18 } else { 0 };
                    EmptyElement::at((x, y))
                        + PathElement::new(vec![(0, 0), (end, 0)], color.stroke_width(2))
                        + Circle::new((9, 0), 3, color.filled())
                });
            let points = series.points.iter().filter(|&&(x, y, _)| self.shows(x, y));
            chart
                .draw_series(points.clone().map(|&(x, y, error)| {
                    let low = if self.shows(x, y - error) { y - error } else { y };
                    ErrorBar::new_vertical(x, low, y, y + error, color.filled(), ERROR_BAR_WIDTH)
                }))
                .map_err(|error| text(&error))?;
            chart
                .draw_series(points.map(|&(x, y, _)| Circle::new((x, y), 2, color.filled())))
                .map_err(|error| text(&error))?;
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .label_font((FONT, 14))
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .draw()
            .map_err(|error| text(&error))?;
        area.present().map_err(|error| text(&error))
    }

    /// Whether a point has a place on the axes.
    fn shows(&self, x: f64, y: f64) -> bool {
        let has_place =
            |scale, value: f64| value.is_finite() && (scale == Scale::Linear || value > 0.0);
        has_place(self.x_scale, x) && has_place(self.y_scale, y)
    }

    /// The least and greatest x and y, with some room.
    fn ranges(&self) -> Option<(Range, Range)> {
        let lines = self.series.iter().flat_map(|series| series.line.iter().copied());
        let points = self.series.iter().flat_map(|series| {
            series.points.iter().flat_map(|&(x, y, error)| [(x, y - error), (x, y), (x, y + error)])
        });
        let (xs, ys): (Vec<f64>, Vec<f64>) =
            lines.chain(points).filter(|&(x, y)| self.shows(x, y)).unzip();
        Some((range(&xs, self.x_scale)?, range(&ys, self.y_scale)?))
    }
}

/// Least and greatest of the values, with some room beyond.
fn range(values: &[f64], scale: Scale) -> Option<Range> {
    let least = values.iter().copied().reduce(f64::min)?;
    let greatest = values.iter().copied().reduce(f64::max)?;
    Some(match scale {
        Scale::Logarithmic => (least / 1.1, greatest * 1.1),
        Scale::Linear => {
            let room = 0.04 * (greatest - least).max(1e-12 * greatest.abs()).max(f64::MIN_POSITIVE);
            (least - room, greatest + room)
        }
    })
}

/// A number on an axis of this range as people write it, without trailing zeros.
fn short(value: f64, (least, greatest): (f64, f64)) -> String {
    // Rounding leaves a trace of the steps that lead to 0.
    let is_zero = least <= 0.0 && value.abs() < 1e-9 * (greatest - least);
    let value = if is_zero { 0.0 } else { value };
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    let is_plain = rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs());
    if is_plain { rounded.to_string() } else { format!("{rounded:e}") }
}
