//! `photonvdb bias`: the models of the lab, exact and measured, as a table, CSV, JSON or chart.

pub mod args;
mod chart;
mod figures;
pub mod k_list;
mod summary;

use photonvdb::lab::{BiasRequest, Constant, Method, Model};
use strsim::damerau_levenshtein;

use super::error::CliError;
use super::thread_pool;
use args::BiasArguments;

/// Tabulates what the arguments ask for.
pub fn run(arguments: &BiasArguments) -> Result<(), CliError> {
    let pool = thread_pool(arguments.threads)?;
    if let Some(directory) = &arguments.figures {
        pool.install(|| figures::draw(directory, arguments.seed))?;
    }
    if arguments.models.is_empty() {
        return Ok(());
    }
    arguments.outputs.check()?;

    let request = request(arguments)?;
    let table = pool.install(|| request.tabulate(|_| ()))?;
    let chart = chart::bias_chart(&table);
    let csv = if arguments.outputs.timing { table.to_csv_with_times() } else { table.to_csv() };
    arguments.outputs.write(&csv, &table, &chart, &summary::of(&table))
}

fn request(arguments: &BiasArguments) -> Result<BiasRequest, CliError> {
    let constants: Vec<Constant> = if arguments.divisor.iter().any(|name| name == "all") {
        Constant::ALL.to_vec()
    } else {
        arguments.divisor.iter().filter_map(|name| Constant::from_name(name)).collect()
    };
    Ok(BiasRequest {
        models: models(&arguments.models)?,
        n: arguments.n,
        ks: arguments.k.0.clone(),
        constants,
        trials: if arguments.exact_only { 0 } else { arguments.trials },
        method: if arguments.method == "direct" { Method::Direct } else { Method::Fast },
        seed: arguments.seed,
    })
}

/// The models named; `all` are all of them.
fn models(names: &[String]) -> Result<Vec<Model>, CliError> {
    let mut models = Vec::new();
    for name in names {
        if name == "all" {
            models.extend(Model::ALL);
        } else {
            models.push(Model::from_name(name).ok_or_else(|| unknown_model(name))?);
        }
    }
    Ok(models)
}

fn unknown_model(name: &str) -> CliError {
    let nearest = Model::ALL
        .into_iter()
        .map(Model::name)
        .min_by_key(|known| damerau_levenshtein(known, name))
        .unwrap_or_default();
    CliError::UnknownModel { name: name.to_owned(), nearest }
}
