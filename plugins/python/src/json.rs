//! Python objects to JSON and back, by Python's own `json`.

use pyo3::prelude::*;
use pyo3::types::{PyCFunction, PyDict, PyTuple};
use serde::Serialize;

use crate::error::refused;

/// The JSON of an object; NumPy's arrays and numbers are lists and numbers, paths are strings.
pub fn to_text(object: &Bound<'_, PyAny>) -> PyResult<String> {
    let py = object.py();
    let plain =
        |arguments: &Bound<'_, PyTuple>, _: Option<&Bound<'_, PyDict>>| -> PyResult<Py<PyAny>> {
            let object = arguments.get_item(0)?;
            for method in ["tolist", "__fspath__"] {
                if object.hasattr(method)? {
                    return Ok(object.call_method0(method)?.unbind());
                }
            }
            let kind = object.get_type();
            Err(refused(format!(
                "a scene holds numbers, words, lists and dicts, and no {}",
                kind.name()?
            )))
        };
    let options = PyDict::new(py);
    options.set_item("default", PyCFunction::new_closure(py, None, None, plain)?)?;
    options.set_item("allow_nan", true)?;
    let text = py.import("json")?.call_method("dumps", (object,), Some(&options))?;
    text.extract()
}

/// JSON as dicts, lists and numbers.
pub fn to_python<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(refused)?;
    py.import("json")?.call_method1("loads", (text,))
}
