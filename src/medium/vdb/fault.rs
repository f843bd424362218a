//! What goes wrong inside a grid or a header, before the file and the grid are named.

use super::error::{VdbError, memory_size};

/// A reason for not reading on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum Fault {
    /// The bytes end inside something.
    #[error("it is damaged (it ends inside {0}); export it again")]
    EndsEarly(&'static str),
    /// The bytes contradict the format.
    #[error("it is damaged ({0}); export it again")]
    Invalid(String),
    /// Sound, as far as one can tell, but not something this reader reads; says what to do.
    #[error("{0}")]
    Unsupported(String),
    /// The grid would take more memory than allowed.
    #[error("it needs {} of memory and the limit is {}", memory_size(*needed), memory_size(*limit))]
    TooLarge { needed: u64, limit: u64 },
    /// The machine has not got the memory.
    #[error("it needs {} of memory, more than there is", memory_size(*needed))]
    OutOfMemory { needed: u64 },
}

impl Fault {
    /// A contradiction of the format.
    pub(super) fn invalid(what: impl Into<String>) -> Self {
        Self::Invalid(what.into())
    }

    /// The fault as the error of a file.
    pub(super) fn in_file(self, file: &str) -> VdbError {
        VdbError::Damaged { file: file.to_owned(), reason: self.to_string() }
    }

    /// The fault as the error of a grid of a file.
    pub(super) fn in_grid(self, file: &str, grid: &str) -> VdbError {
        let (file, grid) = (file.to_owned(), grid.to_owned());
        match self {
            Self::TooLarge { needed, limit } => VdbError::TooLarge { file, grid, needed, limit },
            Self::OutOfMemory { needed } => VdbError::OutOfMemory { file, grid, needed },
            other => VdbError::Unusable { file, grid, reason: other.to_string() },
        }
    }
}
