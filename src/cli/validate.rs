//! `photonvdb validate`: what the renderer measures against exact answers, as one table.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use indicatif::ProgressBar;
use photonvdb::film::check_writable;
use photonvdb::validate::{Extent, Report, Row, Truth, Verdict, hard_cases, validate};
use serde::Serialize;

use super::error::CliError;
use super::report::is_stdout;
use super::resources::cpu_seconds;
use super::text_file::write_json;
use super::{print_to_stdout, thread_pool};

const EXAMPLES: &str = "\
Every quantity is measured in 32 independent batches by the renderer's own emission, tracing, map and estimators.
z = (measured - exact) / standard error, what lies within the bias allowed (kernels blur) not counted. It passes
with |z| < 4; from 4 to 6 it is measured again, with other seeds and four times the photons; otherwise it fails.
Quantities without noise have no z. `rare`: too few photons come there to tell; neither passed nor failed.

Examples:
  photonvdb validate
      Some quantities of every kind, in seconds.
  photonvdb validate --full --json validate.json
      Every exact answer there is, in minutes.
  photonvdb validate --hard
      Numerically hard cases: vanishing extinction, coincident photons, rays along faces, and so on.

Exit codes: 0 all hold, 1 something failed, 2 bad usage.";

/// `photonvdb validate`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct ValidateArguments {
    /// Every exact answer there is
    #[arg(long, conflicts_with = "hard")]
    pub full: bool,

    /// Numerically hard cases instead
    #[arg(long)]
    pub hard: bool,

    /// The table as JSON; `-` is stdout
    #[arg(long, value_name = "OUT.json")]
    pub json: Option<PathBuf>,

    /// Seed of every random number: equal seeds give equal tables
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u64,

    /// Threads to use [default: one a core]; results do not depend on it
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
}

/// The table, and what it comes to.
#[derive(Serialize)]
struct Output<'a> {
    version: &'static str,
    seed: u64,
    passed: usize,
    failed: usize,
    rare: usize,
    cpu_seconds: Option<f64>,
    rows: &'a [Row],
}

/// Measures, tells, and fails where something failed.
pub fn run(arguments: &ValidateArguments) -> Result<(), CliError> {
    let file = arguments.json.as_deref().filter(|path| !is_stdout(path));
    file.map_or(Ok(()), check_writable)?;
    let pool = thread_pool(arguments.threads)?;
    let report = pool.install(|| measure(arguments))?;
    let output = Output {
        version: env!("CARGO_PKG_VERSION"),
        seed: arguments.seed,
        passed: report.count(Verdict::Pass),
        failed: report.count(Verdict::Fail),
        rare: report.count(Verdict::Rare),
        cpu_seconds: cpu_seconds(),
        rows: &report.rows,
    };
    if let Some(path) = &arguments.json {
        write_json(path, &output)?;
    }
    if !arguments.json.as_deref().is_some_and(is_stdout) {
        print_to_stdout(&table(&report))?;
    }
    match output.failed {
        0 => Ok(()),
        failed => Err(CliError::ValidationFailed { failed, count: report.rows.len() }),
    }
}

fn measure(arguments: &ValidateArguments) -> Result<Report, CliError> {
    if arguments.hard {
        return Ok(hard_cases()?);
    }
    let extent = if arguments.full { Extent::Full } else { Extent::Quick };
    // Draws nothing where stderr is no terminal.
    let bar = ProgressBar::new(0);
    let report = validate(extent, &Truth::embedded()?, arguments.seed, |done, count| {
        bar.set_length(count as u64);
        bar.set_position(done as u64);
    })?;
    bar.finish_and_clear();
    Ok(report)
}

fn table(report: &Report) -> String {
    let widest = report.rows.iter().map(|row| row.quantity.chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for rows in report.rows.chunk_by(|a, b| a.group == b.group) {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<widest$}  {:>15}  {:>15}  {:>9}  {:>9}  {:>6}",
            rows[0].group, "exact", "measured", "std error", "allowed", "z"
        );
        for row in rows {
            let _ = writeln!(text, "{}", line(row, widest));
        }
        text.push('\n');
    }
    let [passed, failed, rare] =
        [Verdict::Pass, Verdict::Fail, Verdict::Rare].map(|verdict| report.count(verdict));
    let _ = writeln!(text, "{passed} passed, {failed} failed, {rare} too rare to tell");
    text
}

fn line(row: &Row, widest: usize) -> String {
    let verdict = match (row.verdict, row.again) {
        (Verdict::Pass, false) => "pass",
        (Verdict::Pass, true) => "pass, measured again",
        (Verdict::Fail, _) => "FAIL",
        (Verdict::Rare, _) => "rare",
    };
    let or_nothing = |value: f64| if value > 0.0 { format!("{value:.1e}") } else { "-".into() };
    format!(
        "{:<widest$}  {:>15}  {:>15}  {:>9}  {:>9}  {:>6}  {verdict}",
        row.quantity,
        number(row.exact),
        number(row.measured),
        or_nothing(row.std_error),
        or_nothing(row.bias_allowed),
        row.z.map_or("-".into(), |z| format!("{z:+.2}")),
    )
}

/// Eight digits, with a power of ten where it would be long.
fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-4..1e6).contains(&size) {
        format!("{value:.8}")
    } else {
        format!("{value:.7e}")
    }
}
