//! The entry of a grid in the file: its name, its type, and where its bytes are.

use super::cursor::Cursor;
use super::fault::Fault;

/// Separates a name from the number that makes it unique.
pub(super) const SEPARATOR: char = '\u{1e}';
/// Follows the type of a grid whose values are saved as half.
pub(super) const HALF_SUFFIX: &str = "_HalfFloat";

/// The entry of a grid.
#[derive(Clone, Debug)]
pub(super) struct Descriptor {
    /// Name, and number if the name comes more than once.
    pub unique_name: String,
    /// Name of the tree type, such as `Tree_float_5_4_3`.
    pub tree: String,
    /// Whether values are saved as half.
    pub is_half: bool,
    /// Unique name of the grid whose tree this one shares.
    pub parent: Option<String>,
    /// Where the grid begins and ends; zeros in a stream.
    pub start: i64,
    pub end: i64,
}

impl Descriptor {
    /// Reads an entry.
    pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<Self, Fault> {
        let unique_name = cursor.string("the name of a grid")?;
        let type_name = cursor.string("the type of a grid")?;
        let parent = cursor.string("the entry of a grid")?;
        let start = cursor.i64("the entry of a grid")?;
        let _values = cursor.i64("the entry of a grid")?;
        let end = cursor.i64("the entry of a grid")?;
        let tree = type_name.strip_suffix(HALF_SUFFIX);
        Ok(Self {
            unique_name,
            is_half: tree.is_some(),
            tree: tree.unwrap_or(&type_name).to_owned(),
            parent: (!parent.is_empty()).then_some(parent),
            start,
            end,
        })
    }

    /// The name without its number.
    pub(super) fn name(&self) -> &str {
        let name = self.unique_name.split_once(SEPARATOR);
        name.map_or(&self.unique_name, |(name, _)| name)
    }

    /// The unique name as the OpenVDB tools write it: `density[1]`.
    pub(super) fn shown_name(&self) -> String {
        shown_name(&self.unique_name)
    }

    /// The grid's place in a file of `len` bytes whose entry ends at `entry_end`.
    pub(super) fn place(
        &self,
        entry_end: usize,
        len: usize,
    ) -> Result<std::ops::Range<usize>, Fault> {
        let offset = |position: i64| usize::try_from(position).ok();
        match (offset(self.start), offset(self.end)) {
            (Some(start), Some(end)) if entry_end <= start && start <= end && end <= len => {
                Ok(start..end)
            }
            (Some(_), Some(end)) if end > len => Err(Fault::EndsEarly("a grid")),
            _ => Err(Fault::invalid("a grid's place in the file makes no sense")),
        }
    }
}

/// A unique name as the OpenVDB tools write it: `density[1]`.
pub(super) fn shown_name(unique_name: &str) -> String {
    match unique_name.split_once(SEPARATOR) {
        Some((name, number)) => format!("{name}[{number}]"),
        None => unique_name.to_owned(),
    }
}
