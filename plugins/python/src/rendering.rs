//! What a render gives: layers, report, files.

use std::path::PathBuf;

use numpy::ndarray::ArrayD;
use photonvdb::film::{
    ExrOptions, Film, RenderMetadata, layer_arrays, write_exr, write_preview_png,
};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyIterator, PyList};

use crate::array::to_array;
use crate::error::IntoPyErr;

/// An image: its layers by name, and how it was made.
///
/// `rendering["rgba"]` is the float32 array of a layer, (height, width, channels) or (height, width), row 0 at the top, linear
/// Rec.709 in W/(m^2 sr), premultiplied.
#[pyclass(module = "photonvdb", frozen, mapping)]
pub struct Rendering {
    film: Film,
    options: ExrOptions,
    metadata: RenderMetadata,
    layers: Py<PyDict>,
    report: Py<PyAny>,
}

impl Rendering {
    /// The rendering of a film.
    pub fn new(
        py: Python<'_>,
        film: Film,
        options: ExrOptions,
        metadata: RenderMetadata,
        report: Py<PyAny>,
    ) -> PyResult<Self> {
        let layers = PyDict::new(py);
        for layer in py.detach(|| layer_arrays(&film, &options)) {
            let mut shape = vec![film.height, film.width];
            if layer.channel_count > 1 {
                shape.push(layer.channel_count);
            }
            let array: ArrayD<f32> = to_array(shape, layer.values)?;
            layers.set_item(layer.name, numpy::PyArray::from_owned_array(py, array))?;
        }
        Ok(Self { film, options, metadata, layers: layers.unbind(), report })
    }
}

#[pymethods]
impl Rendering {
    /// The layers by name.
    #[getter]
    fn layers(&self, py: Python<'_>) -> Py<PyDict> {
        self.layers.clone_ref(py)
    }

    /// How the image was made: the keys of `photonvdb render --report`.
    #[getter]
    fn report(&self, py: Python<'_>) -> Py<PyAny> {
        self.report.clone_ref(py)
    }

    /// Writes the image with all its layers and settings as OpenEXR, in place of what was there; with `half` colours in 16 bits.
    #[pyo3(signature = (path, *, half=false))]
    fn write_exr(&self, py: Python<'_>, path: PathBuf, half: bool) -> PyResult<()> {
        let options = ExrOptions { half, ..self.options };
        let written = py.detach(|| write_exr(&path, &self.film, &options, &self.metadata));
        written.map_err(IntoPyErr::into_py_err)
    }

    /// Writes a tone-mapped PNG for a quick look.
    fn write_png(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| write_preview_png(&path, &self.film, None)).map_err(IntoPyErr::into_py_err)
    }

    /// The names of the layers.
    fn keys<'py>(&self, py: Python<'py>) -> Bound<'py, PyList> {
        self.layers.bind(py).keys()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let layers = self.layers.bind(py);
        layers.get_item(name)?.ok_or_else(|| {
            PyKeyError::new_err(format!("no layer {name:?}; there are {}", layers.keys()))
        })
    }

    fn __contains__(&self, py: Python<'_>, name: &Bound<'_, PyAny>) -> PyResult<bool> {
        self.layers.bind(py).contains(name)
    }

    fn __len__(&self, py: Python<'_>) -> usize {
        self.layers.bind(py).len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        self.layers.bind(py).try_iter()
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let Film { width, height, .. } = self.film;
        format!("<photonvdb.Rendering {width} x {height}: {}>", self.layers.bind(py).keys())
    }
}
