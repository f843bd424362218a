//! `photonvdb compare`: random against stratified emission, as a table, CSV, JSON or chart.

pub mod args;
mod chart;
mod summary;

use indicatif::ProgressBar;
use photonvdb::emission::EmissionKind;
use photonvdb::film::check_writable;
use photonvdb::lab::{AnalyticScene, CompareRequest};

use super::error::CliError;
use super::report::is_stdout;
use super::resources::cpu_seconds;
use super::text_file::{write_json, write_text};
use super::{print_to_stdout, thread_pool};
use args::CompareArguments;

const PREFIX: &str = "analytic:";

/// Measures what the arguments ask for.
pub fn run(arguments: &CompareArguments) -> Result<(), CliError> {
    let request = request(arguments)?;
    let pool = thread_pool(arguments.threads)?;
    let outputs = [&arguments.csv, &arguments.json, &arguments.plot];
    let files = outputs.into_iter().flatten().filter(|path| !is_stdout(path));
    files.into_iter().try_for_each(|path| check_writable(path))?;

    // Draws nothing where stderr is no terminal.
    let bar = ProgressBar::new(request.emissions.len() as u64 * request.runs);
    let table = pool.install(|| request.tabulate(cpu_seconds, || bar.inc(1)))?;
    bar.finish_and_clear();
    if let Some(path) = &arguments.csv {
        write_text(path, &table.to_csv())?;
    }
    if let Some(path) = &arguments.json {
        write_json(path, &table)?;
    }
    if let Some(path) = &arguments.plot {
        write_text(path, &chart::intrinsic_bias(&table).to_svg()?)?;
    }
    let is_stdout_taken = outputs.into_iter().flatten().any(|path| is_stdout(path));
    if is_stdout_taken { Ok(()) } else { print_to_stdout(&summary::of(&table)) }
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
