//! `render`

use std::path::PathBuf;
use std::time::Instant;

use photonvdb::film::ExrOptions;
use photonvdb::render::{
    CostlyLayers, RenderOptions, UsedSettings, photons_per_pass, render as render_scene,
};
use photonvdb::scene::{Overrides, Plan};
use pyo3::prelude::*;

use crate::error::{IntoPyErr, refused};
use crate::input::{Count, SceneSource, Words, warn};
use crate::json::to_python;
use crate::rendering::Rendering;
use crate::report::{Report, Seconds};
use crate::run::{run, thread_pool};

/// Renders a scene: a dict with the keys of a scene file, or the path of one.
///
/// Arguments other than None replace what the scene says. Without `passes`, as many as `target_error` (of the image, root mean
/// square over its mean) or `time_budget` (seconds) take. `layers` adds "depth", "lights", "alpha", "photon_count",
/// "kernel_radius" or "variance". `directory` is what files of a dict are relative to. Equal seeds give equal arrays, for any
/// number of `threads`.
///
/// `progress(stage, fraction, passes, error)` is called some twenty times a second and after every pass (stage "pass"), `error`
/// being the estimated one or None; if it returns False, or Ctrl-C is pressed, the render ends after the pass in flight.
#[pyfunction]
#[pyo3(signature = (scene, *, photons=None, passes=None, target_error=None, time_budget=None, gather=None, k=None,
    divisor=None, emission=None, seed=None, resolution=None, threads=None, progress=None, layers=None, directory=None))]
#[allow(clippy::too_many_arguments)]
pub fn render(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    photons: Option<Count>,
    passes: Option<Count>,
    target_error: Option<f64>,
    time_budget: Option<f64>,
    gather: Option<String>,
    k: Option<Count>,
    divisor: Option<String>,
    emission: Option<String>,
    seed: Option<u64>,
    resolution: Option<[Count; 2]>,
    threads: Option<u64>,
    progress: Option<Py<PyAny>>,
    layers: Option<Words>,
    directory: Option<PathBuf>,
) -> PyResult<Rendering> {
    let started = Instant::now();
    let passes = passes.map(|passes| whole_passes(passes.0)).transpose()?;
    positive("target_error", target_error)?;
    positive("time_budget", time_budget)?;
    let wanted = Wanted::of(&layers.map_or(Vec::new(), |words| words.0))?;
    let pool = thread_pool(threads)?;
    let source = SceneSource::of(scene, directory)?;
    let overrides = Overrides {
        photons: photons.map(|count| count.0),
        gather,
        k: k.map(|count| count.0),
        divisor,
        emission,
        seed,
        resolution: resolution.map(|sides| sides.map(|side| side.0)),
        ..Overrides::default()
    };
    let scene = run(py, &pool, None, |_| source.load(&overrides))?;
    let scene = scene.map_err(IntoPyErr::into_py_err)?;
    warn(py, &scene.warnings)?;
    let options = RenderOptions {
        layers: wanted.costly,
        ..RenderOptions::for_scene(&scene, passes, target_error, time_budget)
    };
    let plan = Plan { photons: photons_per_pass(&scene, &options), ..Plan::of(&scene) };
    let load = started.elapsed().as_secs_f64();
    let rendered = run(py, &pool, progress, |watch| render_scene(&scene, &options, watch))?;
    let rendering = rendered.map_err(IntoPyErr::into_py_err)?;
    let made = &rendering.report;
    let settings = UsedSettings::of(source.name(), &scene, &options, pool.current_num_threads());
    let metadata = settings.metadata(&scene, made);
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        plan,
        settings,
        figures: made.figures(scene.estimate.k),
        seconds: Seconds { load, stages: made.seconds, total: started.elapsed().as_secs_f64() },
    };
    let report = to_python(py, &report)?.unbind();
    Rendering::new(py, rendering.film, wanted.exr, metadata, report)
}

fn whole_passes(passes: u64) -> PyResult<u32> {
    match u32::try_from(passes) {
        Ok(passes) if passes > 0 => Ok(passes),
        _ => Err(refused(format!("passes: {passes} must lie in 1 to {}", u32::MAX))),
    }
}

fn positive(what: &str, value: Option<f64>) -> PyResult<()> {
    match value {
        Some(value) if !(value > 0.0 && value.is_finite()) => {
            Err(refused(format!("{what}: {value} is not a number above 0")))
        }
        _ => Ok(()),
    }
}

/// Layers asked for beside the usual ones.
#[derive(Default)]
struct Wanted {
    costly: CostlyLayers,
    exr: ExrOptions,
}

impl Wanted {
    fn of(names: &[String]) -> PyResult<Self> {
        let mut wanted = Self::default();
        for name in names {
            let Self { costly, exr } = &mut wanted;
            let flag = match name.as_str() {
                "depth" => &mut costly.depths,
                "lights" => &mut costly.lights,
                "alpha" => &mut exr.alpha,
                "photon_count" => &mut exr.photon_count,
                "kernel_radius" => &mut exr.kernel_radius,
                "variance" => &mut exr.variance,
                _ => {
                    let known = "depth, lights, alpha, photon_count, kernel_radius, variance";
                    return Err(refused(format!("layers: {name:?} is none of {known}")));
                }
            };
            *flag = true;
        }
        Ok(wanted)
    }
}
