//! A sweep for people.

use std::fmt::Write;

use photonvdb::lab::{SweepRow, SweepTable};

const EXPLANATION: &str = "\
*: on the Pareto front, which nothing beats in both error and processor time; bias: in brackets, the most that is credible to 95 %;
mean: all pixels together over the reference, less 1; error^2 = bias^2 + noise^2; efficiency: 1 / (error^2 x CPU s)
";

/// The table. Errors in per cent of the mean of the reference.
pub fn of(table: &SweepTable, scene: &str) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = lines(&mut text, table, scene);
    text + EXPLANATION
}

fn lines(text: &mut String, table: &SweepTable, scene: &str) -> std::fmt::Result {
    let reference = &table.reference;
    let runs = table.rows.first().map_or(0, |row| row.runs);
    write!(text, "{scene}: {} x {} pixels, {runs} runs; ", reference.width, reference.height)?;
    match (reference.paths, reference.noise) {
        (Some(paths), _) => write!(text, "against {paths} paths a pixel")?,
        (None, _) => write!(text, "against the reference given")?,
    }
    match reference.noise {
        Some(noise) => writeln!(text, ", whose noise of {:.2} % is taken off", 100.0 * noise)?,
        None => writeln!(text, ", whose own noise is not known and counts as bias")?,
    }
    writeln!(text, "errors in per cent of the mean")?;
    writeln!(
        text,
        "  {:<8}{:>9}  {:<34}{:>17}{:>17}{:>18}{:>9}{:>11}{:>9}{:>12}",
        "mode",
        "photons",
        "setting",
        "error",
        "bias",
        "mean",
        "noise",
        "estimated",
        "CPU s",
        "efficiency"
    )?;
    table.rows.iter().try_for_each(|row| writeln!(text, "{}", line(row)))
}

fn line(row: &SweepRow) -> String {
    let percent = |value: f64| format!("{:.2}", 100.0 * value);
    let dash = || "-".to_owned();
    let high = row.bias_high.map_or(String::new(), |high| format!(" (<{})", percent(high)));
    format!(
        "{} {:<8}{:>9}  {:<34}{:>17}{:>17}{:>18}{:>9}{:>11}{:>9}{:>12}",
        if row.is_on_front { '*' } else { ' ' },
        row.mode,
        row.photons.map_or_else(dash, |photons| photons.to_string()),
        setting(row),
        format!("{} +- {}", percent(row.error), percent(row.error_std_error)),
        percent(row.bias) + &high,
        format!("{:+.2} +- {:.2}", 100.0 * row.mean_bias, 100.0 * row.mean_bias_std_error),
        percent(row.noise),
        row.estimated_error.map_or_else(dash, percent),
        row.cpu_seconds.map_or_else(dash, |seconds| format!("{seconds:.3}")),
        row.efficiency.map_or_else(dash, |efficiency| format!("{efficiency:.3e}")),
    )
}

/// `stratified, k 50, k-1, 4 rays`
fn setting(row: &SweepRow) -> String {
    let unit = if row.mode == "paths" { "paths" } else { "rays" };
    let parts = [
        row.emission.map(str::to_owned),
        row.k.map(|k| format!("k {k}")),
        row.divisor.map(str::to_owned),
        row.cells.map(|cells| format!("{cells} cells")),
        row.samples.map(|samples| format!("{samples} {unit}")),
        row.target_error.map(|error| format!("to {} %", 100.0 * error)),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}
