//! A table for people: a few k of each model and divisor.

use std::fmt::Write;

use photonvdb::lab::{BiasRow, BiasTable};

/// Rows shown of each model and divisor.
const SHOWN: usize = 8;

/// The table, and what was left out of it.
pub fn of(table: &BiasTable) -> String {
    let mut text = format!(
        "{:<23}{:<11}{:>13}{:>13}{:>13}{:>21}{:>8}{:>12}\n",
        "model", "divisor", "k", "exact bias", "sd", "measured bias", "z", "efficiency"
    );
    let mut left_out = 0;
    for rows in table.rows.chunk_by(|a, b| (a.model, a.divisor) == (b.model, b.divisor)) {
        for (index, row) in rows.iter().enumerate() {
            if is_shown(index, rows) {
                // Writing to a string cannot fail.
                let _ = writeln!(text, "{}", line(row));
            } else {
                left_out += 1;
            }
        }
    }
    if left_out > 0 {
        let _ = writeln!(text, "{left_out} rows are not shown; --csv - shows them all");
    }
    for cost in &table.experiments {
        let _ = writeln!(
            text,
            "{}: n = {}, {} trials, all k together, in {:.3} s of processor time",
            cost.model, cost.n, cost.trials, cost.seconds
        );
    }
    if !table.experiments.is_empty() {
        text += "efficiency: 1 / (mean squared error of a trial x processor time of a trial [s])\n";
    }
    text
}

/// Of many rows those whose k leads with 1, 2 or 5, and the last.
fn is_shown(index: usize, rows: &[BiasRow]) -> bool {
    let is_round = |k: u64| {
        let leading = k / 10_u64.pow(k.ilog10());
        matches!(leading, 1 | 2 | 5) && k.is_multiple_of(10_u64.pow(k.ilog10()))
    };
    rows.len() <= SHOWN || index + 1 == rows.len() || is_round(rows[index].k)
}

fn line(row: &BiasRow) -> String {
    let percent =
        |value: Option<f64>| value.map_or("-".into(), |value| short(100.0 * value) + " %");
    let measured = match (row.measured_bias, row.std_error) {
        (Some(bias), Some(error)) => {
            format!("{:+.3} +- {:.3} %", 100.0 * bias, 100.0 * error)
        }
        _ => "-".into(),
    };
    let deviation = row.exact_variance.or(row.measured_variance).map(f64::sqrt);
    let z = row.z.map_or("-".into(), |z| format!("{z:+.1}"));
    format!(
        "{:<23}{:<11}{:>13}{:>13}{:>13}{:>21}{:>8}{:>12}",
        row.model,
        row.divisor,
        row.k,
        percent(row.exact_bias),
        percent(deviation),
        measured,
        z,
        row.efficiency.map_or("-".into(), |efficiency| format!("{efficiency:.2e}"))
    )
}

/// Four digits, with an exponent where a number is small.
fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.abs().to_string();
    }
    if (1e-3..1e5).contains(&value.abs()) {
        let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
        return format!("{value:.digits$}");
    }
    format!("{value:.3e}")
}
