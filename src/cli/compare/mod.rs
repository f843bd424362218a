//! `photonvdb compare`: random against stratified emission, as a table, CSV, JSON or chart.

pub mod args;
mod chart;
mod summary;

use indicatif::ProgressBar;
use photonvdb::emission::EmissionKind;
use photonvdb::lab::{AnalyticScene, CompareRequest};

use super::error::CliError;
use super::resources::cpu_seconds;
use super::thread_pool;
use args::CompareArguments;

const PREFIX: &str = "analytic:";

/// Measures what the arguments ask for.
pub fn run(arguments: &CompareArguments) -> Result<(), CliError> {
    let request = request(arguments)?;
    let pool = thread_pool(arguments.threads)?;
    arguments.outputs.check()?;

    // Draws nothing where stderr is no terminal.
    let bar = ProgressBar::new(request.emissions.len() as u64 * request.runs);
    let table = pool.install(|| request.tabulate(cpu_seconds, || bar.inc(1)))?;
    bar.finish_and_clear();
    let chart = chart::intrinsic_bias(&table);
    let csv = if arguments.outputs.timing { table.to_csv_with_times() } else { table.to_csv() };
    arguments.outputs.write(&csv, &table, &chart, &summary::of(&table))
}

fn request(arguments: &CompareArguments) -> Result<CompareRequest, CliError> {
    let mut emissions: Vec<EmissionKind> = Vec::new();
    for kind in arguments.emission.iter().filter_map(|name| emission(name)) {
        if !emissions.contains(&kind) {
            emissions.push(kind);
        }
    }
    Ok(CompareRequest {
        scene: scene(&arguments.scene)?,
        emissions,
        ks: arguments.k.0.clone(),
        n: arguments.n,
        runs: arguments.runs,
        queries: arguments.queries,
        seed: arguments.seed,
    })
}

fn emission(name: &str) -> Option<EmissionKind> {
    match name {
        "random" => Some(EmissionKind::Random),
        "stratified" => Some(EmissionKind::Stratified),
        "sobol" => Some(EmissionKind::Sobol),
        _ => None,
    }
}

fn scene(name: &str) -> Result<AnalyticScene, CliError> {
    let scene = name.strip_prefix(PREFIX).and_then(AnalyticScene::from_name);
    scene.ok_or_else(|| {
        let known = AnalyticScene::ALL.map(|scene| format!("{PREFIX}{}", scene.name()));
        CliError::UnknownComparison { name: name.to_owned(), known: known.join(", ") }
    })
}
