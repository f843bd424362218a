//! The C interface of photonvdb: opaque handles, status codes, and a sentence for what went wrong.
//!
//! Every function catches panics, refuses null pointers, and writes to the caller's memory only within the lengths that it is told. What is
//! unsafe is kept to this layer: turning pointers into slices and handles into references.

mod borrow;
mod last_error;
mod map;
mod scene;

pub use map::{
    pvdb_divisor, pvdb_map, pvdb_map_build, pvdb_map_fluence, pvdb_map_free, pvdb_map_photon_count,
    pvdb_map_power_density, pvdb_map_radiance,
};
pub use scene::{
    pvdb_render, pvdb_scene, pvdb_scene_free, pvdb_scene_from_text, pvdb_scene_load,
    pvdb_scene_resolution,
};

use std::ffi::c_char;
use std::panic::{AssertUnwindSafe, catch_unwind};

use last_error::{clear, keep};

/// What became of a call.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum pvdb_status {
    /// It did what was asked for.
    Ok = 0,
    /// An argument cannot be: a null pointer, a length that does not fit, a number out of range.
    BadArgument = 1,
    /// The scene or a file that it names cannot be used.
    BadScene = 2,
    /// It cannot be rendered, or no map can be built.
    RenderFailed = 3,
    /// A fault of the library itself; the handles in use should be freed.
    Panic = 4,
}

/// Why a call failed: its status, and a sentence.
struct Failure {
    status: pvdb_status,
    sentence: String,
}

impl Failure {
    fn argument(sentence: impl Into<String>) -> Self {
        Self { status: pvdb_status::BadArgument, sentence: sentence.into() }
    }

    fn null(name: &str) -> Self {
        Self::argument(format!("{name} is a null pointer"))
    }

    fn scene(error: impl ToString) -> Self {
        Self { status: pvdb_status::BadScene, sentence: error.to_string() }
    }

    fn render(error: impl ToString) -> Self {
        Self { status: pvdb_status::RenderFailed, sentence: error.to_string() }
    }
}

/// Runs a call; no panic passes, and what went wrong is kept for `pvdb_last_error`.
fn guarded(call: impl FnOnce() -> Result<(), Failure>) -> pvdb_status {
    clear();
    // What a panic leaves half done is not looked at again: handles are read only, buffers the caller's.
    let failure = match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(())) => return pvdb_status::Ok,
        Ok(Err(failure)) => failure,
        Err(_) => Failure {
            status: pvdb_status::Panic,
            sentence: "photonvdb failed; please report it".to_string(),
        },
    };
    keep(&failure.sentence);
    failure.status
}

/// Version of the library, such as "0.1.0". Never null; not to be freed.
#[unsafe(no_mangle)]
pub extern "C" fn pvdb_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// What went wrong in the last call of this thread, as one sentence in UTF-8; empty if it did not fail. Never null; not to be freed, and
/// good until the next call of the same thread.
#[unsafe(no_mangle)]
pub extern "C" fn pvdb_last_error() -> *const c_char {
    last_error::pointer()
}
