//! `photonvdb compare`: random against stratified emission, as a table, CSV, JSON or chart.

mod analytic_summary;
pub mod args;
mod chart;
mod scene;
mod scene_summary;

use indicatif::ProgressBar;
use photonvdb::emission::EmissionKind;
use photonvdb::lab::{AnalyticScene, CompareRequest, Saving};

use super::error::CliError;
use super::resources::cpu_seconds;
use super::thread_pool;
use args::CompareArguments;

const PREFIX: &str = "analytic:";

/// Photons of a run by default.
const PHOTONS: u64 = 1_000_000;

/// Measures what the arguments ask for.
pub fn run(arguments: &CompareArguments) -> Result<(), CliError> {
    if scene::is_file(&arguments.scene) { scene::run(arguments) } else { run_analytic(arguments) }
}

fn run_analytic(arguments: &CompareArguments) -> Result<(), CliError> {
    let request = CompareRequest {
        scene: analytic_scene(&arguments.scene)?,
        emissions: emissions(&arguments.emission),
        ks: arguments.k.0.clone(),
        n: arguments.n.unwrap_or(PHOTONS),
        runs: arguments.runs,
        queries: arguments.queries,
        seed: arguments.seed,
    };
    if let Some(flag) = arguments.scene_flag() {
        return Err(CliError::OnlyForSceneFiles { flag });
    }
    let pool = thread_pool(arguments.threads)?;
    arguments.outputs.check()?;

    // Draws nothing where stderr is no terminal.
    let bar = ProgressBar::new(request.emissions.len() as u64 * request.runs);
    let table = pool.install(|| request.tabulate(cpu_seconds, || bar.inc(1)))?;
    bar.finish_and_clear();
    let csv = if arguments.outputs.timing { table.to_csv_with_times() } else { table.to_csv() };
    let chart = chart::intrinsic_bias(&table);
    arguments.outputs.write(&csv, &table, &chart, &analytic_summary::of(&table))
}

/// Each way of emission once, in the order named.
fn emissions(names: &[String]) -> Vec<EmissionKind> {
    let mut emissions: Vec<EmissionKind> = Vec::new();
    for kind in names.iter().filter_map(|name| emission(name)) {
        if !emissions.contains(&kind) {
            emissions.push(kind);
        }
    }
    emissions
}

fn emission(name: &str) -> Option<EmissionKind> {
    match name {
        "random" => Some(EmissionKind::Random),
        "stratified" => Some(EmissionKind::Stratified),
        "sobol" => Some(EmissionKind::Sobol),
        _ => None,
    }
}

fn analytic_scene(name: &str) -> Result<AnalyticScene, CliError> {
    let scene = name.strip_prefix(PREFIX).and_then(AnalyticScene::from_name);
    scene.ok_or_else(|| {
        let known = AnalyticScene::ALL.map(|scene| format!("{PREFIX}{}", scene.name()));
        CliError::UnknownComparison { name: name.to_owned(), known: known.join(", ") }
    })
}

/// What a way of emission saves, as a sentence.
fn saving_line(saving: &Saving) -> String {
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

/// `1.25 +- 0.01`, or a dash where there is none.
fn ratio(value: Option<f64>, std_error: Option<f64>) -> String {
    let both = value.zip(std_error);
    both.map_or("-".into(), |(ratio, error)| format!("{ratio:.2} +- {error:.2}"))
}

/// A bias and its standard error, in per cent.
fn percent_with_error(value: f64, std_error: f64) -> String {
    format!("{:+.3} +- {:.3}", 100.0 * value, 100.0 * std_error)
}
