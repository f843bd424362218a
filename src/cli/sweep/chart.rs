//! Error by processor time: the modes as points or curves, the Pareto front as a line below them.

use photonvdb::lab::{Chart, Scale, Series, SweepRow, SweepTable};

/// The chart of a table.
pub fn of(table: &SweepTable, scene: &str) -> Chart {
    let mut front: Vec<&SweepRow> = table.rows.iter().filter(|row| row.is_on_front).collect();
    front.sort_by(|a, b| b.error.total_cmp(&a.error));
    let mut series = vec![Series {
        label: "Pareto front".into(),
        line: front.into_iter().map(place).collect(),
        points: Vec::new(),
    }];
    for rows in table.rows.chunk_by(|a, b| a.mode == b.mode) {
        let points = rows.iter().map(|row| {
            let (seconds, error) = place(row);
            (seconds, error, row.error_std_error)
        });
        // One number alone leads from row to row.
        let is_curve = matches!(rows[0].mode, "target" | "paths");
        let is_one = rows.iter().all(|row| row.emission == rows[0].emission);
        let line = if is_curve && is_one { rows.iter().map(place).collect() } else { Vec::new() };
        series.push(Series { label: label(&rows[0]).into(), line, points: points.collect() });
    }
    let (width, height) = (table.reference.width, table.reference.height);
    Chart {
        title: format!("Error against processor time: {scene}, {width} x {height} pixels"),
        x_label: "processor time of an image [s]".into(),
        y_label: "root mean squared error / mean".into(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series,
    }
}

fn place(row: &SweepRow) -> (f64, f64) {
    (row.cpu_seconds.unwrap_or(f64::NAN), row.error)
}

fn label(row: &SweepRow) -> &'static str {
    match row.mode {
        "target" => "rendered to a target error",
        "paths" => "reference path tracer",
        mode => mode,
    }
}
