//! Names of files to be written, refused where they promise another format than what comes. A name without extension is taken as it
//! is (`/dev/null`).

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::{OsStringValueParser, TypedValueParser};

/// Names of OpenEXR images.
pub fn exr_name() -> impl TypedValueParser<Value = PathBuf> {
    OsStringValueParser::new().try_map(|name| match extension(&name) {
        Some(extension) if extension == "png" => Err(
            "the image is written as OpenEXR, its name must end in .exr; --preview writes a .png",
        ),
        Some(extension) if extension != "exr" => {
            Err("the image is written as OpenEXR, its name must end in .exr")
        }
        _ => Ok(name.into()),
    })
}

/// Names of PNG images.
pub fn png_name() -> impl TypedValueParser<Value = PathBuf> {
    OsStringValueParser::new().try_map(|name| match extension(&name) {
        Some(extension) if extension != "png" => {
            Err("the preview is written as PNG, its name must end in .png")
        }
        _ => Ok(PathBuf::from(name)),
    })
}

/// Names of OpenVDB files.
pub fn vdb_name() -> impl TypedValueParser<Value = PathBuf> {
    OsStringValueParser::new().try_map(|name| match extension(&name) {
        Some(extension) if extension != "vdb" => {
            Err("grids are written as OpenVDB, the file's name must end in .vdb")
        }
        _ => Ok(PathBuf::from(name)),
    })
}

/// Names of scene files in TOML, or `-`.
pub fn toml_name() -> impl TypedValueParser<Value = PathBuf> {
    OsStringValueParser::new().try_map(|name| match extension(&name) {
        Some(extension) if extension == "toml" => Ok(PathBuf::from(name)),
        _ if name == "-" => Ok(PathBuf::from(name)),
        _ => Err("the scene is written as TOML, its name must end in .toml"),
    })
}

fn extension(name: &OsString) -> Option<String> {
    let extension = std::path::Path::new(name).extension()?;
    Some(extension.to_string_lossy().to_ascii_lowercase())
}
