//! The library's tables, which it writes as CSV to the last digit, as dicts of columns.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::refused;

/// One array a column, in order: whole numbers, floating-point numbers (NaN where the table has nothing), or words.
pub fn columns<'py>(py: Python<'py>, csv: &str) -> PyResult<Bound<'py, PyDict>> {
    let mut lines = csv.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let mut cells: Vec<Vec<&str>> = vec![Vec::new(); names.len()];
    for line in lines {
        for (column, cell) in cells.iter_mut().zip(line.split(',')) {
            column.push(cell);
        }
    }
    let columns = PyDict::new(py);
    for (name, cells) in names.into_iter().zip(cells) {
        columns.set_item(name, column(py, &cells)?)?;
    }
    Ok(columns)
}

fn column<'py>(py: Python<'py>, cells: &[&str]) -> PyResult<Bound<'py, PyAny>> {
    if let Ok(counts) = cells.iter().map(|cell| cell.parse()).collect::<Result<Vec<i64>, _>>() {
        return Ok(PyArray1::from_vec(py, counts).into_any());
    }
    let number = |cell: &&str| if cell.is_empty() { Ok(f64::NAN) } else { cell.parse() };
    if let Ok(numbers) = cells.iter().map(number).collect::<Result<Vec<f64>, _>>() {
        return Ok(PyArray1::from_vec(py, numbers).into_any());
    }
    py.import("numpy")?.call_method1("array", (cells.to_vec(),)).map_err(refused)
}
