//! The named values written before a file's grids and before each grid's transform.
//!
//! Each is a name, a type, a length and as many bytes; what is not needed here is passed over by
//! its length.

use std::collections::BTreeMap;

use super::cursor::Cursor;
use super::fault::Fault;
use super::summary::IndexBox;

/// Bytes of further metadata kept of a grid: the sound ones have some hundred.
const MAX_KEPT: usize = 1 << 16;

/// A value of a grid's metadata, of any type: kept as its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MetadataValue {
    /// OpenVDB's name of the type.
    kind: String,
    bytes: Vec<u8>,
}

impl MetadataValue {
    /// A text.
    pub fn text(text: &str) -> Self {
        Self::new("string", text.as_bytes())
    }

    /// A number of single precision.
    pub fn float(number: f32) -> Self {
        Self::new("float", &number.to_le_bytes())
    }

    /// Yes or no.
    pub(super) fn flag(is_set: bool) -> Self {
        Self::new("bool", &[is_set.into()])
    }

    /// A voxel.
    pub(super) fn coordinates(voxel: [i32; 3]) -> Self {
        Self::new("vec3i", voxel.map(i32::to_le_bytes).as_flattened())
    }

    /// A count; what is beyond a signed number becomes the greatest.
    pub(super) fn count(count: u64) -> Self {
        Self::new("int64", &i64::try_from(count).unwrap_or(i64::MAX).to_le_bytes())
    }

    fn new(kind: &str, bytes: &[u8]) -> Self {
        Self { kind: kind.to_owned(), bytes: bytes.to_vec() }
    }

    /// OpenVDB's name of the type: `string`, `float`, `vec3i`, ...
    pub fn kind(&self) -> &str {
        &self.kind
    }

    /// The value as it lies in files, little-endian.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// Whether metadata of this name follows from the rest of the file.
pub(super) fn is_reserved(name: &str) -> bool {
    matches!(name, "name" | "class" | "is_saved_as_half_float") || name.starts_with("file_")
}

/// What a grid's metadata says that is of use.
#[derive(Clone, Debug, Default)]
pub(super) struct Metadata {
    /// "fog volume", "level set", "staggered".
    pub class: Option<String>,
    /// Statistics the writer left: bounds of the active voxels and their number.
    pub bbox_min: Option<[i32; 3]>,
    pub bbox_max: Option<[i32; 3]>,
    pub voxel_count: Option<u64>,
    /// What is not told elsewhere, by name.
    pub further: BTreeMap<String, MetadataValue>,
}

impl Metadata {
    /// Reads all of it.
    pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<Self, Fault> {
        let mut metadata = Self::default();
        let mut kept = 0;
        for _ in 0..cursor.u32("the metadata")? {
            let name = cursor.string("the name of a metadata value")?;
            let kind = cursor.string("the type of a metadata value")?;
            let len = cursor.u32("a metadata value")? as usize;
            let value = cursor.take(len, "a metadata value")?;
            metadata.note(&name, &kind, value);
            kept += name.len() + kind.len() + len + size_of::<MetadataValue>();
            if !is_reserved(&name) && kept <= MAX_KEPT {
                metadata.further.insert(name, MetadataValue::new(&kind, value));
            }
        }
        Ok(metadata)
    }

    fn note(&mut self, name: &str, kind: &str, value: &[u8]) {
        match (name, kind) {
            ("class", "string") => self.class = Some(String::from_utf8_lossy(value).into_owned()),
            ("file_bbox_min", "vec3i") => self.bbox_min = coordinates(value),
            ("file_bbox_max", "vec3i") => self.bbox_max = coordinates(value),
            ("file_voxel_count", "int64") => {
                self.voxel_count = value.try_into().ok().map(u64::from_le_bytes);
            }
            _ => {}
        }
    }

    /// Bounds of the active voxels as the writer noted them; none when there are no active voxels.
    pub(super) fn bbox(&self) -> Option<IndexBox> {
        let bbox = IndexBox { min: self.bbox_min?, max: self.bbox_max? };
        (0..3).all(|axis| bbox.min[axis] <= bbox.max[axis]).then_some(bbox)
    }
}

fn coordinates(value: &[u8]) -> Option<[i32; 3]> {
    let mut cursor = Cursor::new(value, 0);
    cursor.coordinates("a metadata value").ok()
}
