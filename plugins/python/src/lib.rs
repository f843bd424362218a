//! The Python module `photonvdb`: scenes in, NumPy arrays out.
//!
//! ```text
//! dict or path ──input──▶ Scene ──run──▶ the library's work, on threads of its own ──▶ arrays, dicts
//! ```
//! Nothing is computed here: each function turns its arguments into a call of the library and the result into arrays. While the
//! library works the interpreter is free, and [`run`] listens to Ctrl-C and calls back.

mod array;
mod blackbody;
mod error;
mod input;
mod json;
mod lab;
mod photon_map;
mod render;
mod rendering;
mod report;
mod run;
mod table;
mod volume;

/// The compiled half of the package.
#[pyo3::pymodule]
mod _photonvdb {
    #[pymodule_export]
    use crate::blackbody::blackbody_xyz;
    #[pymodule_export]
    use crate::error::Error;
    #[pymodule_export]
    use crate::lab::{bias, compare};
    #[pymodule_export]
    use crate::photon_map::PhotonMap;
    #[pymodule_export]
    use crate::render::render;
    #[pymodule_export]
    use crate::rendering::Rendering;
    #[pymodule_export]
    use crate::volume::{read_vdb, write_vdb};

    /// Of the library and of this module.
    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
