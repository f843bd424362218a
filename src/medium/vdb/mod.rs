//! Reading and writing OpenVDB files, in safe code.
//!
//! [`VolumeSource`] is the seam: whatever reads the file returns plain [`SparseGrid`]s. [`VdbFile`]
//! is the project's own reader of the format, written after the OpenVDB library's `io` sources
//! (file versions 222 to 225). The modules follow the order of the bytes:
//!
//! file and descriptors -> metadata -> transform -> tree (topology) -> block (values of a node) ->
//! codec, blosc. `VdbRsFile` (feature `vdb-rs`) is a second reader, for some of the grids.
//!
//! [`write_vdb`] writes [`SparseGrid`]s; its modules are in `write/`. [`crop`] cuts a grid.
//!
//! A file is data from a stranger: every length and offset is checked before it is used, nothing
//! recurses, and the memory a grid takes is computed from its topology and compared with [`Limits`]
//! before any of it is allocated.

mod block;
mod blosc;
mod codec;
mod contents;
mod crop;
mod cursor;
mod dense;
mod descriptor;
mod error;
mod fault;
mod file;
mod find;
mod find_named;
mod fog;
mod listing;
mod load;
mod metadata;
mod sanitize;
mod sparse;
mod summary;
mod transform;
mod tree;
mod value;
#[cfg(feature = "vdb-rs")]
mod vdb_rs_file;
mod write;

/// The 16-bit number of half grids.
pub use half::f16;

pub use crop::{CropError, crop};
pub use dense::{DenseBox, DenseError};
pub use error::VdbError;
pub(super) use error::memory_size;
pub use file::VdbFile;
pub use find::{find_density, find_density_or_level_set, find_grid};
pub use find_named::{find_scalar, find_vector};
pub use fog::fog_of_level_set;
pub use metadata::MetadataValue;
pub use sanitize::{SanitizeCount, sanitize_density};
pub use sparse::{SparseGrid, Tile};
pub use summary::{GridSummary, IndexBox};
pub use value::GridValue;
#[cfg(feature = "vdb-rs")]
pub use vdb_rs_file::VdbRsFile;
pub use write::{
    GridClass, GridProblem, GridToWrite, ValuesToWrite, VdbWriteError, VdbWriter, WriteCompression,
    WriteOptions, WrittenGrid, write_vdb,
};

/// A file of volumes, whatever reads it.
pub trait VolumeSource {
    /// What messages call the file: its path, if it has one.
    fn name(&self) -> &str;

    /// Every grid of the file, in its order, those that cannot be read included.
    fn grids(&self) -> &[GridSummary];

    /// Reads a grid of numbers, converted to `f32` (of double and integer grids the nearest value).
    /// Values pass through as they are, NaN and infinite ones included: see [`sanitize_density`].
    ///
    /// # Errors
    /// When there is no such grid, when it is not of numbers, cannot be used, is damaged, or needs
    /// more memory than `limits` allows.
    fn load_scalar(&self, index: usize, limits: &Limits) -> Result<SparseGrid<f32>, VdbError>;

    /// Reads a grid of three-component vectors (velocity, colour), converted to `f32`.
    ///
    /// # Errors
    /// As for [`VolumeSource::load_scalar`], when it is not of vectors.
    fn load_vector(&self, index: usize, limits: &Limits) -> Result<SparseGrid<[f32; 3]>, VdbError>;
}

/// What reading a grid may cost, from the bytes of its file to the voxels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Memory of one loaded grid and of what it is made from: of the file's bytes and the voxels while they
    /// are read, and of the voxels and the bricks while a
    /// [`DensityGrid`](crate::medium::grid::DensityGrid) is built \[bytes\].
    pub max_bytes: u64,
}

impl Default for Limits {
    /// 8 GiB: four million leaves, some 2000 x 1000 x 1000 filled voxels.
    fn default() -> Self {
        Self { max_bytes: 8 << 30 }
    }
}
