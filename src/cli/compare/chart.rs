//! Intrinsic bias by k: measured points, and the laws of random and of stratified emission.

use photonvdb::lab::{Chart, CompareTable, Scale, SceneTable, Series};

/// The chart of a table.
pub fn intrinsic_bias(table: &CompareTable) -> Chart {
    let mut series: Vec<Series> = Vec::new();
    for rows in table.rows.chunk_by(|a, b| a.emission == b.emission) {
        let emission = rows[0].emission;
        let by_k = |figure: fn(&photonvdb::lab::CompareRow) -> f64| {
            rows.iter().map(move |row| (row.k as f64, figure(row)))
        };
        let points = rows.iter().map(|row| (row.k as f64, row.intrinsic_bias, row.std_error));
        // Of Sobol points no law is known.
        let line =
            if emission == "sobol" { Vec::new() } else { by_k(|row| row.law_bias).collect() };
        let label = match emission {
            "random" => "random, line 1/(k-1)".into(),
            "stratified" => "stratified, line k/(k-1/2-0.533 k^(-1/3)) - 1".into(),
            other => other.to_owned(),
        };
        series.push(Series { label, line, points: points.collect() });
    }
    Chart {
        title: "Intrinsic bias of k-nearest estimates".into(),
        x_label: "k".into(),
        y_label: "bias of k / u".into(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series,
    }
}

/// The chart of a scene: measured points, and the law of independent photons, which scattered ones come close to.
pub fn scene_bias(table: &SceneTable) -> Chart {
    let of_emissions = table.points.chunk_by(|a, b| a.emission == b.emission).map(|rows| {
        let points = rows.iter().map(|row| {
            let error = row.std_error.hypot(row.reference_std_error);
            (row.k as f64, row.intrinsic_bias, error)
        });
        let is_random = rows[0].emission == "random";
        let law = rows.iter().map(|row| (row.k as f64, 1.0 / (row.k as f64 - 1.0)));
        let label = if is_random { "random, line 1/(k-1)" } else { rows[0].emission };
        let line = if is_random { law.collect() } else { Vec::new() };
        Series { label: label.into(), line, points: points.collect() }
    });
    Chart {
        title: "Intrinsic bias of k-nearest estimates in the scene".into(),
        x_label: "k".into(),
        y_label: "bias against the mean of all maps".into(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series: of_emissions.collect(),
    }
}
