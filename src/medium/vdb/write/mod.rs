//! Writing OpenVDB files, in safe code.
//!
//! [`write_vdb`] writes grids that lie in memory, [`VdbWriter`] one after the other. A file is of
//! version 224, has 5-4-3 trees and offsets, and holds what the OpenVDB library (10.0) would have
//! written of the same grids, statistics included; only packed chunks differ by some bytes, as the
//! packers are others, and what equals but for the sign of zero or a NaN's bits is told apart.
//!
//! The modules follow the order of the bytes:
//!
//! writer (header, entries) -> names -> metadata, statistics -> transform -> tree (topology), in the
//! order of `order` -> leaves -> block (values of a node) -> pack, blosc.
//!
//! Leaves are packed in parallel and written in order, so that the bytes are the same for any number
//! of threads; the file's UUID is a hash of them.

mod block;
mod blosc;
mod error;
mod grid;
mod leaves;
mod metadata;
mod names;
mod options;
mod order;
mod output;
mod pack;
mod statistics;
mod transform;
mod tree;
mod value;
mod writer;

pub use error::{GridProblem, VdbWriteError};
pub use grid::{GridClass, GridToWrite, ValuesToWrite};
pub use options::{WriteCompression, WriteOptions};
pub use writer::{VdbWriter, WrittenGrid, write_vdb};
