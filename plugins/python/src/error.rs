//! The library's errors as Python exceptions, in the library's own words.

use std::fmt::Display;
use std::io;

use photonvdb::film::FilmError;
use photonvdb::lab::{LabError, SceneComparisonError};
use photonvdb::medium::vdb::{DenseError, VdbError, VdbWriteError};
use photonvdb::render::{NotCalibrated, RenderError};
use photonvdb::scene::SceneError;
use pyo3::PyErr;
use pyo3::exceptions::{
    PyFileNotFoundError, PyIsADirectoryError, PyMemoryError, PyOSError, PyPermissionError,
    PyValueError,
};

pyo3::create_exception!(
    photonvdb,
    Error,
    PyValueError,
    "A scene, a volume or a value that photonvdb cannot work with: one sentence that says what, where, and the way out."
);

/// What a message says is wrong with the arguments.
pub fn refused(message: impl Display) -> PyErr {
    Error::new_err(message.to_string())
}

/// What the operating system refuses, as Python's own exception for it.
fn refused_by_system(source: &io::Error, message: String) -> PyErr {
    match source.kind() {
        io::ErrorKind::NotFound => PyFileNotFoundError::new_err(message),
        io::ErrorKind::PermissionDenied => PyPermissionError::new_err(message),
        io::ErrorKind::IsADirectory => PyIsADirectoryError::new_err(message),
        // Bytes that are no text, say.
        io::ErrorKind::InvalidData => refused(message),
        _ => PyOSError::new_err(message),
    }
}

/// An error of the library as an exception.
pub trait IntoPyErr {
    /// With the same words.
    fn into_py_err(self) -> PyErr;
}

impl IntoPyErr for SceneError {
    fn into_py_err(self) -> PyErr {
        match &self {
            Self::Read { source, .. } => refused_by_system(source, self.to_string()),
            _ => refused(self),
        }
    }
}

impl IntoPyErr for VdbError {
    fn into_py_err(self) -> PyErr {
        match &self {
            Self::Read { source, .. } => refused_by_system(source, self.to_string()),
            Self::OutOfMemory { .. } => PyMemoryError::new_err(self.to_string()),
            _ => refused(self),
        }
    }
}

impl IntoPyErr for VdbWriteError {
    fn into_py_err(self) -> PyErr {
        match &self {
            Self::Write(failure) => refused_by_system(&failure.source, self.to_string()),
            _ => refused(self),
        }
    }
}

impl IntoPyErr for FilmError {
    fn into_py_err(self) -> PyErr {
        match &self {
            Self::Read { source, .. } | Self::Write { source, .. } => {
                refused_by_system(source, self.to_string())
            }
            _ => refused(self),
        }
    }
}

impl IntoPyErr for DenseError {
    fn into_py_err(self) -> PyErr {
        match self {
            Self::OutOfMemory { .. } => PyMemoryError::new_err(self.to_string()),
            _ => refused(self),
        }
    }
}

impl IntoPyErr for RenderError {
    fn into_py_err(self) -> PyErr {
        refused(self)
    }
}

impl IntoPyErr for NotCalibrated {
    fn into_py_err(self) -> PyErr {
        refused(self)
    }
}

impl IntoPyErr for LabError {
    fn into_py_err(self) -> PyErr {
        refused(self)
    }
}

impl IntoPyErr for SceneComparisonError {
    fn into_py_err(self) -> PyErr {
        refused(self)
    }
}
