//! The OpenVDB library's own answers about a file, and what is needed to compare a read grid with
//! them.

pub mod answer;
pub mod bytes;
pub mod hash;
pub mod sampler;
pub mod stream;
