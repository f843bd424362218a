//! Bias by k: a colour for each model and divisor.

use photonvdb::lab::{BiasTable, Chart, Scale, Series};

/// The chart of a table.
pub fn bias_chart(table: &BiasTable) -> Chart {
    let mut series: Vec<Series> = Vec::new();
    for row in &table.rows {
        let label = format!("{}, {}", row.model, row.divisor);
        if series.last().is_none_or(|last| last.label != label) {
            series.push(Series { label, ..Series::default() });
        }
        let Some(series) = series.last_mut() else { continue };
        let k = row.k as f64;
        series.line.extend(row.exact_bias.filter(|bias| bias.is_finite()).map(|bias| (k, bias)));
        let measured = row.measured_bias.zip(row.std_error);
        series.points.extend(measured.map(|(bias, error)| (k, bias, error)));
    }
    Chart {
        title: "Bias of k-nearest estimates".into(),
        x_label: "k".into(),
        y_label: "bias (mean - 1)".into(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Linear,
        series,
    }
}
