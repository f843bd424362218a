//! A grid's metadata: what the caller gives, the class, and the statistics of the values.

use std::collections::BTreeMap;

use super::error::GridProblem;
use super::grid::GridToWrite;
use super::options::WriteOptions;
use super::statistics::Statistics;
use crate::medium::vdb::metadata::{MetadataValue, is_reserved};

/// The bytes of all metadata of a grid, sorted by name.
pub(super) fn metadata_bytes(
    grid: &GridToWrite<'_>,
    statistics: &Statistics,
    options: &WriteOptions,
) -> Result<Vec<u8>, GridProblem> {
    if let Some(name) = grid.metadata.keys().find(|name| is_reserved(name)) {
        return Err(GridProblem::ReservedMetadata { name: name.clone() });
    }
    let mut values = statistics.metadata();
    let compression = options.compression.compression().words();
    values.insert("file_compression".into(), MetadataValue::text(&compression));
    values.insert("name".into(), MetadataValue::text(grid.name));
    if let Some(class) = grid.class.word() {
        values.insert("class".into(), MetadataValue::text(class));
    }
    if options.half || grid.half {
        values.insert("is_saved_as_half_float".into(), MetadataValue::flag(true));
    }
    let own = values.iter();
    let all: BTreeMap<_, _> = own.chain(&grid.metadata).collect();

    let mut bytes = (all.len() as u32).to_le_bytes().to_vec();
    for (name, value) in all {
        put_string(&mut bytes, name);
        put_string(&mut bytes, value.kind());
        bytes.extend((value.bytes().len() as u32).to_le_bytes());
        bytes.extend(value.bytes());
    }
    Ok(bytes)
}

/// Appends a length and as many bytes.
pub(super) fn put_string(bytes: &mut Vec<u8>, text: &str) {
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(text.as_bytes());
}
