//! A table for people.

use std::fmt::Write;

use photonvdb::lab::{CompareRow, CompareTable};

use super::{percent_with_error, ratio, saving_line};

/// The table, and what it cost. Biases in per cent.
pub fn of(table: &CompareTable) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    if let Some(row) = table.rows.first() {
        let _ = writeln!(
            text,
            "{}: {} runs of {} photons, {} queries each; biases in per cent +- standard error",
            row.scene, row.runs, row.n, row.queries
        );
    }
    let _ = writeln!(
        text,
        "{:<11}{:>5}{:>19}{:>9}{:>9}{:>9}{:>9}{:>9}{:>14}{:>10}{:>19}{:>8}{:>14}{:>9}{:>12}",
        "emission",
        "k",
        "intrinsic bias",
        "k-1/2",
        "k-1",
        "calibr.",
        "law",
        "by count",
        "reduction",
        "smoothing",
        "total bias",
        "sd",
        "var. ratio",
        "photons",
        "efficiency"
    );
    for row in &table.rows {
        let _ = writeln!(text, "{}", line(row));
    }
    for cost in &table.costs {
        let seconds = cost.seconds_per_map.map_or("-".into(), |seconds| format!("{seconds:.3} s"));
        let _ = writeln!(text, "{}: {seconds} of processor time a run", cost.emission);
    }
    for saving in &table.savings {
        let _ = writeln!(text, "{}", saving_line(saving));
    }
    text + "calibr.: with the constant that photon counts of the other half of the maps say;\n\
            law: 1/(k-1), or of one photon a cubic cell; by count: from the variance of photon counts in these maps;\n\
            photons: what random emission needs for the same squared error of k/u in the same ball, over what this one needs;\n\
            efficiency: 1 / (squared error x processor time of a run [s])\n"
}

fn line(row: &CompareRow) -> String {
    let percent = |value: f64| format!("{:+.3}", 100.0 * value);
    format!(
        "{:<11}{:>5}{:>19}{:>9}{:>9}{:>9}{:>9}{:>9}{:>14}{:>10}{:>19}{:>8}{:>14}{:>9}{:>12}",
        row.emission,
        row.k,
        percent_with_error(row.intrinsic_bias, row.std_error),
        percent(row.intrinsic_bias_k_minus_half),
        percent(row.intrinsic_bias_k_minus_1),
        percent(row.intrinsic_bias_calibrated),
        percent(row.law_bias),
        percent(row.count_law_bias),
        format!("{:.1} +- {:.1}", 100.0 * row.reduction, 100.0 * row.reduction_std_error),
        percent(row.smoothing_bias),
        percent_with_error(row.total_bias, row.total_std_error),
        format!("{:.2}", 100.0 * row.variance.sqrt()),
        ratio(row.variance_ratio, row.variance_ratio_std_error),
        format!("{:.2}", row.photon_ratio),
        row.efficiency.map_or("-".into(), |efficiency| format!("{efficiency:.3e}")),
    )
}
