//! What can go wrong with image files, each with the path it happened to.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::files::WriteFailure;

/// An image file could not be read, written or compared.
#[derive(Debug, Error)]
pub enum FilmError {
    /// The file cannot be opened or its bytes cannot be read.
    #[error("cannot read {path}: {source}", path = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file cannot be created, filled or put in place. What stood there before is untouched.
    #[error("cannot write {path}: {source}", path = path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The bytes are not an EXR image, or not an intact one.
    #[error("{path} is not an intact EXR image: {reason}", path = path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        reason: String,
    },
    /// A valid EXR image of a kind that is not read, such as deep or subsampled pixels.
    #[error("{path} is an EXR image of a kind that is not supported: {reason}", path = path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// The feature.
        reason: String,
    },
    /// No part of the image has the channels R, G and B.
    #[error("{path} has no channels R, G and B; its channels are {channels}", path = path.display())]
    NoRgb {
        /// The file.
        path: PathBuf,
        /// What it has, separated by commas.
        channels: String,
    },
    /// More pixels than this library reads.
    #[error("{path} is {width} x {height} pixels, more than the {limit} that are read", path = path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// \[pixels\]
        width: usize,
        /// \[pixels\]
        height: usize,
        /// Largest number of pixels.
        limit: usize,
    },
    /// Two images of different size cannot be compared.
    #[error("the image is {} x {} pixels but its reference is {} x {}", image[0], image[1], reference[0], reference[1])]
    SizeMismatch {
        /// Width and height of the image \[pixels\].
        image: [usize; 2],
        /// Width and height of the reference \[pixels\].
        reference: [usize; 2],
    },
}

impl From<WriteFailure> for FilmError {
    fn from(WriteFailure { path, source }: WriteFailure) -> Self {
        Self::Write { path, source }
    }
}
