//! `bias` and `compare`: the lab's tables.

use std::path::PathBuf;

use photonvdb::emission::EmissionKind;
use photonvdb::film::read_rgb;
use photonvdb::lab::{
    AnalyticScene, BiasRequest, BiasTable, CompareRequest, Constant, LabError, Method, Model,
    SceneComparison,
};
use photonvdb::render::Observer;
use photonvdb::scene::Overrides;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{IntoPyErr, refused};
use crate::input::{Count, Counts, SceneSource, Words, named, warn};
use crate::run::{run, thread_pool};
use crate::table::columns;

/// Bias and variance of k-nearest estimates in models, exact and measured: a dict of arrays, ready for pandas.DataFrame.
///
/// `models` is a name, several, or "all"; `k` a number or several, 2 to 200 by default; `divisors` of "k", "k-1/2", "k-1",
/// "unbiased", "calibrated", all by default. With `trials=0` there are exact values alone. NaN stands for what is not known.
#[pyfunction]
#[pyo3(signature = (models, n=None, k=None, trials=Count(10_000), divisors=None, seed=0, *, method="fast", threads=None,
    progress=None))]
#[allow(clippy::too_many_arguments)]
pub fn bias<'py>(
    py: Python<'py>,
    models: Words,
    n: Option<Count>,
    k: Option<Counts>,
    trials: Count,
    divisors: Option<Words>,
    seed: u64,
    method: &str,
    threads: Option<u64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let models = models_named(&models.0)?;
    let constants = match divisors {
        Some(Words(names)) if names != ["all"] => {
            let named = |name: &String| named("divisors", name, &Constant::ALL, Constant::name);
            names.iter().map(named).collect::<PyResult<_>>()?
        }
        _ => Constant::ALL.to_vec(),
    };
    let request = BiasRequest {
        models: Vec::new(),
        n: n.map(|count| count.0),
        ks: k.map_or_else(|| (2..=200).collect(), |counts| counts.0),
        constants,
        trials: trials.0,
        method: match method {
            "fast" => Method::Fast,
            "direct" => Method::Direct,
            _ => return Err(refused(format!("method: {method:?} is none of fast, direct"))),
        },
        seed,
    };
    let pool = thread_pool(threads)?;
    let table: Result<BiasTable, LabError> = run(py, &pool, progress, |watch| {
        let mut all = BiasTable { rows: Vec::new(), experiments: Vec::new() };
        watch.begin("model", models.len() as u64);
        // One model at a time, as a table of many cannot be left before its end.
        for model in models {
            let table = BiasRequest { models: vec![model], ..request.clone() }.tabulate(|_| ())?;
            all.rows.extend(table.rows);
            watch.advanced(1);
            if watch.cancelled() {
                break;
            }
        }
        Ok(all)
    })?;
    columns(py, &table.map_err(IntoPyErr::into_py_err)?.to_csv())
}

fn models_named(names: &[String]) -> PyResult<Vec<Model>> {
    let mut models = Vec::new();
    for name in names {
        match name.as_str() {
            "all" => models.extend(Model::ALL),
            _ => models.push(named("models", name, &Model::ALL, Model::name)?),
        }
    }
    Ok(models)
}

/// Names of scenes whose power density is known begin so.
const ANALYTIC: &str = "analytic:";

/// Random, stratified and Sobol photons against the truth: a dict of arrays, ready for pandas.DataFrame.
///
/// `scene` is "analytic:point-absorbing", "analytic:point-scattering", "analytic:uniform-ball", "analytic:uniform-box" or
/// "analytic:beam", whose power density is known, or a scene as `render` takes it: at points and in small images of `pixels`
/// (width, height), 32 wide by default, held against `reference` (an .exr) or renders with `reference_photons`. `n` photons a
/// run: 1e6, in a scene 1e5. Ctrl-C takes effect once the table is complete.
#[pyfunction]
#[pyo3(signature = (scene, *, k=None, n=None, runs=Count(32), queries=Count(1000), emission=None, seed=0, pixels=None,
    reference=None, reference_photons=None, photons_only=None, threads=None, progress=None, directory=None))]
#[allow(clippy::too_many_arguments)]
pub fn compare<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    k: Option<Counts>,
    n: Option<Count>,
    runs: Count,
    queries: Count,
    emission: Option<Words>,
    seed: u64,
    pixels: Option<[usize; 2]>,
    reference: Option<PathBuf>,
    reference_photons: Option<Count>,
    photons_only: Option<bool>,
    threads: Option<u64>,
    progress: Option<Py<PyAny>>,
    directory: Option<PathBuf>,
) -> PyResult<Bound<'py, PyDict>> {
    let ks = k.map_or_else(|| vec![5, 10, 20, 50, 100, 200], |counts| counts.0);
    let n = n.map(|count| count.0);
    let [runs, queries] = [runs.0, queries.0];
    let emissions = emissions_named(emission)?;
    check_size(n, runs, queries)?;
    let pool = thread_pool(threads)?;
    let name: Option<String> = scene.extract().ok();
    if let Some(name) = name.as_deref().and_then(|name| name.strip_prefix(ANALYTIC)) {
        let scene = named("scene", name, &AnalyticScene::ALL, AnalyticScene::name)?;
        let n = n.unwrap_or(1_000_000);
        let request = CompareRequest { scene, emissions, ks, n, runs, queries, seed };
        let table = run(py, &pool, progress, |watch| {
            watch.begin("map", request.emissions.len() as u64 * runs);
            request.tabulate(|| None, || watch.advanced(1))
        })?;
        return columns(py, &table.map_err(IntoPyErr::into_py_err)?.to_csv());
    }
    let source = SceneSource::of(scene, directory)?;
    let n = n.unwrap_or(100_000);
    let reference_photons = reference_photons.map_or(8 * n, |count| count.0);
    let request = SceneComparison { emissions, ks, n, runs, queries, reference_photons, seed };
    let overrides = Overrides { photons: Some(n), photons_only, ..Overrides::default() };
    let mut scene = source.load(&overrides).map_err(IntoPyErr::into_py_err)?;
    warn(py, &scene.warnings)?;
    let reference = reference.map(|path| read_rgb(&path)).transpose();
    let reference = reference.map_err(IntoPyErr::into_py_err)?;
    let shape = scene.camera.height as f64 / scene.camera.width as f64;
    let [width, height] = pixels.unwrap_or([32, ((32.0 * shape).round() as usize).max(1)]);
    (scene.camera.width, scene.camera.height) = (width, height);
    let table = run(py, &pool, progress, |watch| {
        watch.begin("map", request.step_count(reference.is_some()));
        request.tabulate(&mut scene, reference.as_ref(), || None, || watch.advanced(1))
    })?;
    columns(py, &table.map_err(IntoPyErr::into_py_err)?.to_csv())
}

/// All collisions of a map are held at once, 44 bytes each.
const MOST_PHOTONS: u64 = 20_000_000;

fn check_size(n: Option<u64>, runs: u64, queries: u64) -> PyResult<()> {
    if let Some(n) = n.filter(|n| !(1..=MOST_PHOTONS).contains(n)) {
        return Err(refused(format!(
            "n: {n} must lie in 1 to {MOST_PHOTONS}; take more runs instead"
        )));
    }
    if runs < 2 {
        return Err(refused("runs: standard errors come from several; take 2 or more, better 32"));
    }
    if queries == 0 {
        return Err(refused("queries: there must be at least one"));
    }
    Ok(())
}

/// Each way of emission once, in the order named.
fn emissions_named(names: Option<Words>) -> PyResult<Vec<EmissionKind>> {
    let all = [EmissionKind::Random, EmissionKind::Stratified, EmissionKind::Sobol];
    let Some(Words(names)) = names else { return Ok(all.to_vec()) };
    let word = |kind| match kind {
        EmissionKind::Random => "random",
        EmissionKind::Stratified => "stratified",
        EmissionKind::Sobol => "sobol",
    };
    let mut emissions = Vec::new();
    for name in &names {
        let kind = named("emission", name, &all, word)?;
        if !emissions.contains(&kind) {
            emissions.push(kind);
        }
    }
    Ok(emissions)
}
