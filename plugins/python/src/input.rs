//! Arguments from Python: scenes, counts, lists of k.

use std::ffi::CString;
use std::path::{Path, PathBuf};

use photonvdb::estimate::Divisor;
use photonvdb::scene::{Overrides, Scene, SceneError};
use pyo3::Borrowed;
use pyo3::exceptions::{PyTypeError, PyUserWarning};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::error::refused;
use crate::json;

/// Where a scene comes from.
pub enum SceneSource {
    File(PathBuf),
    Text { text: String, directory: PathBuf },
}

impl SceneSource {
    /// A dict with the keys of a scene file, whose files are relative to `directory`, or the path of one.
    pub fn of(scene: &Bound<'_, PyAny>, directory: Option<PathBuf>) -> PyResult<Self> {
        if scene.is_instance_of::<PyDict>() {
            let directory = directory.unwrap_or_default();
            return Ok(Self::Text { text: json::to_text(scene)?, directory });
        }
        match scene.extract() {
            Ok(_) if directory.is_some() => Err(refused(
                "directory: the files of a scene file are relative to it; give a directory with a dict alone",
            )),
            Ok(path) => Ok(Self::File(path)),
            Err(_) => Err(PyTypeError::new_err("a scene is a dict or the path of a scene file")),
        }
    }

    /// The scene, with values replaced.
    pub fn load(&self, overrides: &Overrides) -> Result<Scene, SceneError> {
        match self {
            Self::File(path) => Scene::load_with(path, overrides),
            Self::Text { text, directory } => Scene::from_json_text(text, directory, overrides),
        }
    }

    /// What reports and images call it.
    pub fn name(&self) -> String {
        let path = match self {
            Self::File(path) => path.file_name().map_or(path.as_path(), Path::new),
            Self::Text { .. } => Path::new(Scene::IN_MEMORY),
        };
        path.to_string_lossy().into_owned()
    }
}

/// What was mended on loading, as warnings.
pub fn warn(py: Python<'_>, warnings: &[String]) -> PyResult<()> {
    let category = py.get_type::<PyUserWarning>();
    for warning in warnings {
        let text = CString::new(warning.replace('\0', " ")).unwrap_or_default();
        PyErr::warn(py, &category, &text, 1)?;
    }
    Ok(())
}

/// A whole number from 0 on; `1e6` is one, too.
#[derive(Clone, Copy)]
pub struct Count(pub u64);

/// Largest whole number below which floating-point numbers skip none.
const EXACT_LIMIT: f64 = (1_u64 << 53) as f64;

impl FromPyObject<'_, '_> for Count {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        if let Ok(count) = object.extract::<u64>() {
            return Ok(Self(count));
        }
        match object.extract::<f64>() {
            Ok(value) if value.fract() == 0.0 && (0.0..=EXACT_LIMIT).contains(&value) => {
                Ok(Self(value as u64))
            }
            Ok(value) => Err(refused(format!("{value} is not a whole number from 0 on"))),
            Err(_) => Err(PyTypeError::new_err("a whole number is wanted")),
        }
    }
}

/// One count or several: a number, or anything to iterate over.
pub struct Counts(pub Vec<u64>);

impl FromPyObject<'_, '_> for Counts {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        if !object.hasattr("__len__")? && object.extract::<f64>().is_ok() {
            return Ok(Self(vec![object.extract::<Count>()?.0]));
        }
        let counts = object.try_iter()?.map(|item| Ok(item?.extract::<Count>()?.0));
        Ok(Self(counts.collect::<PyResult<_>>()?))
    }
}

/// One word or several.
pub struct Words(pub Vec<String>);

impl FromPyObject<'_, '_> for Words {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        if object.is_instance_of::<PyString>() {
            return Ok(Self(vec![object.extract()?]));
        }
        let words = object.try_iter()?.map(|item| item?.extract());
        Ok(Self(words.collect::<PyResult<_>>()?))
    }
}

/// The thing of a name, or an exception that says which names there are.
pub fn named<T: Copy>(
    what: &str,
    name: &str,
    all: &[T],
    name_of: impl Fn(T) -> &'static str,
) -> PyResult<T> {
    let found = all.iter().copied().find(|&thing| name_of(thing) == name);
    found.ok_or_else(|| {
        let known: Vec<&str> = all.iter().map(|&thing| name_of(thing)).collect();
        refused(format!("{what}: {name:?} is none of {}", known.join(", ")))
    })
}

/// The divisor of a name.
pub fn divisor(name: &str) -> PyResult<Divisor> {
    let all = [Divisor::K, Divisor::KMinus1, Divisor::KMinusHalf, Divisor::Calibrated];
    named("divisor", name, &all, Divisor::name)
}
