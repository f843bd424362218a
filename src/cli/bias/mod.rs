//! `photonvdb bias`: the models of the lab, exact and measured, as a table, CSV, JSON or chart.

pub mod args;
mod chart;
mod figures;
pub mod k_list;
mod summary;

use photonvdb::film::check_writable;
use photonvdb::lab::{BiasRequest, Constant, Method, Model};
use strsim::damerau_levenshtein;

use super::error::CliError;
use super::report::is_stdout;
use super::text_file::{write_json, write_text};
use super::{print_to_stdout, thread_pool};
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
    let outputs = [&arguments.csv, &arguments.json, &arguments.plot];
    let files = outputs.into_iter().flatten().filter(|path| !is_stdout(path));
    files.into_iter().try_for_each(|path| check_writable(path))?;

    let request = request(arguments)?;
    let table = pool.install(|| request.tabulate(|_| ()))?;
    if let Some(path) = &arguments.csv {
        write_text(path, &table.to_csv())?;
    }
    if let Some(path) = &arguments.json {
        write_json(path, &table)?;
    }
    if let Some(path) = &arguments.plot {
        write_text(path, &chart::bias_chart(&table).to_svg()?)?;
    }
    let is_stdout_taken = outputs.into_iter().flatten().any(|path| is_stdout(path));
    if is_stdout_taken { Ok(()) } else { print_to_stdout(&summary::of(&table)) }
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
