//! `blackbody_xyz`

use numpy::PyArrayDyn;
use pyo3::prelude::*;

use crate::array::{Floats, from_colors};

/// CIE 1931 XYZ of blackbodies [W/(m^2 sr)] by their temperatures [K]: (..., 3). The luminance is 683 Y [cd/m^2]; nothing below
/// 400 K.
#[pyfunction]
pub fn blackbody_xyz<'py>(
    py: Python<'py>,
    kelvin: Floats<'py>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let kelvin = kelvin.as_array();
    let colors = kelvin.iter().map(|&kelvin| photonvdb::medium::blackbody_xyz(kelvin));
    from_colors(py, kelvin.shape(), colors)
}
