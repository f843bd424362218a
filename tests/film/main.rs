//! Images and their files.

mod compare;
mod exr;
mod files;
