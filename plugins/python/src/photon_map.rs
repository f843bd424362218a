//! `PhotonMap`: the light in a scene, asked at places and along rays.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use numpy::PyArrayDyn;
use numpy::ndarray::Zip;
use photonvdb::estimate::Divisor;
use photonvdb::math::{DVec3, Ray, Rgb, Stream};
use photonvdb::render::{LightReader, Observer, OwnedLitScene};
use photonvdb::scene::Overrides;
use pyo3::prelude::*;
use rayon::ThreadPool;
use rayon::prelude::*;

use crate::array::{Floats, Vectors, from_colors};
use crate::error::{IntoPyErr, refused};
use crate::input::{Count, SceneSource, divisor as divisor_named, warn};
use crate::json::to_python;
use crate::report::map_report;
use crate::run::{Watch, run, thread_pool};

/// A scene with its photon map, made by `PhotonMap.build`. Places are in metres, in arrays of shape (..., 3); results have the
/// same leading shape.
#[pyclass(module = "photonvdb", frozen)]
pub struct PhotonMap {
    lit: OwnedLitScene,
    pool: ThreadPool,
}

/// A value a channel along a ray, and the transmittance.
type RadianceAndTransmittance<'py> = (Bound<'py, PyArrayDyn<f64>>, Bound<'py, PyArrayDyn<f64>>);

#[pymethods]
impl PhotonMap {
    /// Emits and traces the photons of a scene and builds their map.
    ///
    /// The arguments are those of `render`. With `photons_only` the map holds light scattered once, too, as for fluence and power
    /// density in all; without, `radiance` samples it towards the lights.
    #[staticmethod]
    #[pyo3(signature = (scene, *, photons=None, k=None, divisor=None, emission=None, seed=None, photons_only=None,
        threads=None, progress=None, directory=None))]
    #[allow(clippy::too_many_arguments)]
    fn build(
        py: Python<'_>,
        scene: &Bound<'_, PyAny>,
        photons: Option<Count>,
        k: Option<Count>,
        divisor: Option<String>,
        emission: Option<String>,
        seed: Option<u64>,
        photons_only: Option<bool>,
        threads: Option<u64>,
        progress: Option<Py<PyAny>>,
        directory: Option<PathBuf>,
    ) -> PyResult<Self> {
        let pool = thread_pool(threads)?;
        let source = SceneSource::of(scene, directory)?;
        let overrides = Overrides {
            photons: photons.map(|count| count.0),
            k: k.map(|count| count.0),
            divisor,
            emission,
            seed,
            photons_only,
            ..Overrides::default()
        };
        let scene = run(py, &pool, None, |_| source.load(&overrides))?;
        let scene = scene.map_err(IntoPyErr::into_py_err)?;
        warn(py, &scene.warnings)?;
        let lit = run(py, &pool, progress, |watch| OwnedLitScene::prepare(scene, watch))?;
        Ok(Self { lit: lit.map_err(IntoPyErr::into_py_err)?, pool })
    }

    /// Fluence at places [W/m^2], of the photons in the map: (..., 3), red, green, blue. `k` and `divisor` stand in for the
    /// scene's.
    #[pyo3(signature = (points, k=None, divisor=None))]
    fn fluence<'py>(
        &self,
        py: Python<'py>,
        points: Floats<'py>,
        k: Option<Count>,
        divisor: Option<&str>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.at_points(py, &points, k, divisor, |reader, place| reader.fluence(place).value)
    }

    /// Power density at places [W/m^3], of the photons in the map: (..., 3), red, green, blue. `k` and `divisor` stand in for
    /// the scene's.
    #[pyo3(signature = (points, k=None, divisor=None))]
    fn power_density<'py>(
        &self,
        py: Python<'py>,
        points: Floats<'py>,
        k: Option<Count>,
        divisor: Option<&str>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.at_points(py, &points, k, divisor, |reader, place| reader.power_density(place).value)
    }

    /// Light that travels back along rays from up to `t_max` metres ahead [W/(m^2 sr)], and the transmittance of these segments:
    /// two arrays (..., 3). Directions need not have unit length; `t_max` is one number or one a ray. Equal seeds give equal
    /// arrays.
    #[pyo3(signature = (origins, directions, t_max=None, *, seed=0))]
    fn radiance<'py>(
        &self,
        py: Python<'py>,
        origins: Floats<'py>,
        directions: Floats<'py>,
        t_max: Option<Floats<'py>>,
        seed: u64,
    ) -> PyResult<RadianceAndTransmittance<'py>> {
        let origins = Vectors::of("origins", &origins)?;
        let directions = Vectors::of("directions", &directions)?;
        let shape = if origins.shape.is_empty() { &directions.shape } else { &origins.shape };
        let rays = rays(&origins, &directions)?;
        let distances = distances(t_max.as_ref(), shape, rays.len())?;
        let read = run(py, &self.pool, None, |watch| {
            let rays = rays.par_iter().zip(&distances).enumerate();
            let read = rays.map_init(
                || self.lit.reader(),
                |reader, (index, (ray, &t_max))| {
                    if watch.cancelled() {
                        return (Rgb::ZERO, Rgb::ZERO);
                    }
                    let mut random = Stream::Pixel.random(seed, index as u64);
                    let light = reader.radiance(ray, t_max, &mut random);
                    let radiance = light.single_scatter + light.multiple_scatter + light.emission;
                    (radiance, reader.transmittance(ray, t_max))
                },
            );
            read.collect::<Vec<_>>()
        })?;
        let radiance = from_colors(py, shape, read.iter().map(|(radiance, _)| *radiance))?;
        let transmittance = from_colors(py, shape, read.iter().map(|(_, share)| *share))?;
        Ok((radiance, transmittance))
    }

    /// How the map was made: photons, power, seconds.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &map_report(self.lit.report(), self.lit.scene().estimate.k))
    }

    fn __len__(&self) -> usize {
        self.lit.map().len()
    }

    fn __repr__(&self) -> String {
        format!("<photonvdb.PhotonMap of {} photons>", self.lit.map().len())
    }
}

impl PhotonMap {
    fn at_points<'py>(
        &self,
        py: Python<'py>,
        points: &Floats<'py>,
        k: Option<Count>,
        divisor: Option<&str>,
        estimate: impl Fn(&mut dyn LightReader, DVec3) -> Rgb + Sync + Send,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let Vectors { vectors: places, shape } = Vectors::of("points", points)?;
        let (k, divisor) = self.estimate_as(k, divisor)?;
        // What is refused is refused before the work.
        self.lit.reader_with(k, divisor).map_err(IntoPyErr::into_py_err)?;
        let values = run(py, &self.pool, None, |watch: &Watch| {
            let values = places.par_iter().map_init(
                || self.lit.reader_with(k, divisor).unwrap_or_else(|_| self.lit.reader()),
                |reader, &place| {
                    if watch.cancelled() { Rgb::ZERO } else { estimate(&mut **reader, place) }
                },
            );
            values.collect::<Vec<_>>()
        })?;
        from_colors(py, &shape, values.into_iter())
    }

    fn estimate_as(
        &self,
        k: Option<Count>,
        name: Option<&str>,
    ) -> PyResult<(NonZeroUsize, Divisor)> {
        let settings = self.lit.scene().estimate;
        let k = k.map_or(settings.k, |count| usize::try_from(count.0).unwrap_or(usize::MAX));
        let stored = self.lit.map().len().max(1);
        let k = NonZeroUsize::new(k).filter(|k| k.get() <= stored).ok_or_else(|| {
            refused(format!("k: {k} must lie in 1 to {stored}, the photons stored"))
        })?;
        Ok((k, name.map_or(Ok(settings.divisor), divisor_named)?))
    }
}

/// As many rays as there are origins, or directions; one of either goes with all of the others.
fn rays(origins: &Vectors, directions: &Vectors) -> PyResult<Vec<Ray>> {
    let (from, towards) = (&origins.vectors, &directions.vectors);
    let is_one = |vectors: &Vectors| vectors.shape.is_empty();
    if origins.shape != directions.shape && !is_one(origins) && !is_one(directions) {
        let [origins, directions] = [&origins.shape, &directions.shape];
        return Err(refused(format!(
            "origins and directions differ in shape: {origins:?}, {directions:?}"
        )));
    }
    let count = if is_one(origins) { towards.len() } else { from.len() };
    let ray = |index: usize| {
        let of = |vectors: &Vectors| vectors.vectors[if is_one(vectors) { 0 } else { index }];
        let direction = of(directions).try_normalize();
        let direction = direction
            .ok_or_else(|| refused(format!("directions: number {index} has no length")))?;
        Ok(Ray::new(of(origins), direction))
    };
    (0..count).map(ray).collect()
}

/// One distance a ray, infinite where none is given.
fn distances(t_max: Option<&Floats<'_>>, shape: &[usize], count: usize) -> PyResult<Vec<f64>> {
    let Some(t_max) = t_max else { return Ok(vec![f64::INFINITY; count]) };
    let given = t_max.as_array();
    let Some(all) = given.broadcast(shape) else {
        return Err(refused(format!(
            "t_max: of shape {:?}, where {shape:?} is wanted",
            given.shape()
        )));
    };
    match Zip::from(&all).all(|&distance| distance >= 0.0) {
        true => Ok(all.iter().copied().collect()),
        false => Err(refused("t_max: a distance is not a number from 0 on")),
    }
}
