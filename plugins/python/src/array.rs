//! Arrays in and out: places from anything NumPy can read, results in the memory that they were computed in.

use numpy::ndarray::{ArrayD, IxDyn};
use numpy::{AllowTypeChange, PyArrayLikeDyn};
use photonvdb::math::{DVec3, Rgb};
use pyo3::prelude::*;

use crate::error::refused;

/// Numbers, cast to 64-bit floats.
pub type Floats<'py> = PyArrayLikeDyn<'py, f64, AllowTypeChange>;

/// The array of some values; no copy.
pub fn to_array<T>(shape: Vec<usize>, values: Vec<T>) -> PyResult<ArrayD<T>> {
    ArrayD::from_shape_vec(IxDyn(&shape), values).map_err(refused)
}

/// Vectors, and the shape of the array without its last axis.
pub struct Vectors {
    /// Finite, in the array's order.
    pub vectors: Vec<DVec3>,
    /// Their shape.
    pub shape: Vec<usize>,
}

impl Vectors {
    /// Those of an array of shape (..., 3).
    pub fn of(what: &str, array: &Floats<'_>) -> PyResult<Self> {
        let array = array.as_array();
        let Some((3, shape)) = array.shape().split_last().map(|(last, shape)| (*last, shape))
        else {
            let shape = array.shape();
            return Err(refused(format!("{what}: of shape {shape:?}, where (..., 3) is wanted")));
        };
        let rows = array.rows();
        let vectors = rows.into_iter().map(|row| DVec3::new(row[0], row[1], row[2]));
        let vectors: Vec<DVec3> = vectors.collect();
        match vectors.iter().position(|vector| !vector.is_finite()) {
            Some(index) => Err(refused(format!("{what}: number {index} is not finite"))),
            None => Ok(Self { vectors, shape: shape.to_vec() }),
        }
    }
}

/// Colours as an array of `shape` and three channels.
pub fn from_colors<'py>(
    py: Python<'py>,
    shape: &[usize],
    colors: impl Iterator<Item = Rgb>,
) -> PyResult<Bound<'py, numpy::PyArrayDyn<f64>>> {
    let shape = [shape, &[3]].concat();
    let values: Vec<f64> = colors.flat_map(|color| color.to_array()).collect();
    Ok(numpy::PyArray::from_owned_array(py, to_array(shape, values)?))
}
