//! `photonvdb inspect`: what is in a file, for people or as JSON. The first bytes tell the kind of file,
//! whatever its name; what is neither OpenVDB nor OpenEXR is taken for a scene.

pub mod args;
mod exr;
mod grid_values;
mod scene;
mod vdb;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::error::CliError;
use args::InspectArguments;

/// First bytes of an OpenVDB file: a 64-bit number that spells ` BDV`.
const VDB_MAGIC: &[u8] = b" BDV\0\0\0\0";
/// First bytes of an OpenEXR file.
const EXR_MAGIC: &[u8] = &[0x76, 0x2f, 0x31, 0x01];

/// Shows what the arguments name.
pub fn run(arguments: &InspectArguments) -> Result<(), CliError> {
    let path = &arguments.file;
    let start = first_bytes(path)?;
    if start.starts_with(EXR_MAGIC) || has_extension(path, "exr") {
        exr::inspect(path, arguments.json)
    } else if start.starts_with(VDB_MAGIC) || has_extension(path, "vdb") {
        vdb::inspect(path, arguments.json, &arguments.volume.limits())
    } else {
        scene::inspect(path, arguments.json, arguments.volume.max_volume_memory)
    }
}

fn first_bytes(path: &Path) -> Result<Vec<u8>, CliError> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(VDB_MAGIC.len() as u64).read_to_end(&mut bytes))
        .map_err(|source| CliError::Read { path: path.to_path_buf(), source })?;
    Ok(bytes)
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
}
