//! A table for people.

use std::fmt::Write;

use photonvdb::lab::{CompareRow, CompareTable, Saving};

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
        "{:<11}{:>5}{:>19}{:>9}{:>9}{:>9}{:>9}{:>14}{:>10}{:>19}{:>8}{:>14}{:>9}{:>12}",
        "emission",
        "k",
        "intrinsic bias",
        "k-1/2",
        "k-1",
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
    text + "law: 1/(k-1), or of one photon a cubic cell; by count: from the variance of photon counts in these maps;\n\
            photons: what random emission needs for the same squared error of k/u in the same ball, over what this one needs;\n\
            efficiency: 1 / (squared error x processor time of a run [s])\n"
}

/// What a way of emission saves, as a sentence.
pub(super) fn saving_line(saving: &Saving) -> String {
    let share = |ratio: f64, what: &str| match ratio {
        ratio if ratio >= 1.0 => format!("1/{ratio:.2} of the {what}"),
        ratio => format!("{:.2} times the {what}", 1.0 / ratio),
    };
    let photons = share(saving.photons, "photons");
    let seconds = saving.seconds.map(|ratio| " and ".to_owned() + &share(ratio, "seconds"));
    let (emission, k) = (saving.emission, saving.k);
    let seconds = seconds.unwrap_or_default();
    format!("k = {k}: {emission} needs {photons}{seconds} that random needs for the same error")
}

fn line(row: &CompareRow) -> String {
    let percent = |value: f64| format!("{:+.3}", 100.0 * value);
    let with_error =
        |value: f64, error: f64| format!("{:+.3} +- {:.3}", 100.0 * value, 100.0 * error);
    let ratio = row.variance_ratio.zip(row.variance_ratio_std_error);
    format!(
        "{:<11}{:>5}{:>19}{:>9}{:>9}{:>9}{:>9}{:>14}{:>10}{:>19}{:>8}{:>14}{:>9}{:>12}",
        row.emission,
        row.k,
        with_error(row.intrinsic_bias, row.std_error),
        percent(row.intrinsic_bias_k_minus_half),
        percent(row.intrinsic_bias_k_minus_1),
        percent(row.law_bias),
        percent(row.count_law_bias),
        format!("{:.1} +- {:.1}", 100.0 * row.reduction, 100.0 * row.reduction_std_error),
        percent(row.smoothing_bias),
        with_error(row.total_bias, row.total_std_error),
        format!("{:.2}", 100.0 * row.variance.sqrt()),
        ratio.map_or("-".into(), |(ratio, error)| format!("{ratio:.2} +- {error:.2}")),
        format!("{:.2}", row.photon_ratio),
        row.efficiency.map_or("-".into(), |efficiency| format!("{efficiency:.3e}")),
    )
}
