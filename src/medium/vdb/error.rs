//! What can go wrong with a VDB file, as one clear sentence that names the file and the grid.

/// Why a file or a grid was not read.
#[derive(Debug, thiserror::Error)]
pub enum VdbError {
    /// The operating system does not give the bytes.
    #[error("cannot read {file}: {source}")]
    Read {
        /// The file.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is of another kind.
    #[error("{file} is not an OpenVDB file; give a file saved as .vdb")]
    NotVdb {
        /// The file.
        file: String,
    },
    /// The file's version of the format is too old or too new.
    #[error(
        "{file} has OpenVDB file version {version} and versions 222 to 225 can be read; \
                save it again with a current OpenVDB"
    )]
    Version {
        /// The file.
        file: String,
        /// Its version.
        version: u32,
    },
    /// Nothing of the file can be read.
    #[error("{file} cannot be read: {reason}")]
    Damaged {
        /// The file.
        file: String,
        /// Where it breaks and what to do.
        reason: String,
    },
    /// No grid of that name.
    #[error("{file} has no grid \"{grid}\"; {present}")]
    NoSuchGrid {
        /// The file.
        file: String,
        /// The grid asked for.
        grid: String,
        /// The grids there are, in words.
        present: String,
    },
    /// No grid of that index.
    #[error("{file} has no grid number {index}; it has {count}, counted from 0")]
    NoSuchIndex {
        /// The file.
        file: String,
        /// The index asked for.
        index: usize,
        /// How many grids there are.
        count: usize,
    },
    /// The grid is damaged or of a kind that cannot be read.
    #[error("grid \"{grid}\" of {file} cannot be used: {reason}")]
    Unusable {
        /// The file.
        file: String,
        /// The grid.
        grid: String,
        /// Why, and what to do.
        reason: String,
    },
    /// The grid holds another type of value.
    #[error(
        "grid \"{grid}\" of {file} holds {value_type} values where {wanted} are wanted; \
                name another grid"
    )]
    WrongType {
        /// The file.
        file: String,
        /// The grid.
        grid: String,
        /// What it holds.
        value_type: String,
        /// What was asked for.
        wanted: &'static str,
    },
    /// The grid holds distances to a surface.
    #[error(
        "grid \"{grid}\" of {file} is a level set: it holds distances to a surface, \
                not densities; give --sdf-to-fog, or medium.sdf_to_fog = true in the scene, to fill it with fog"
    )]
    LevelSet {
        /// The file.
        file: String,
        /// The grid.
        grid: String,
    },
    /// The grid would take more memory than allowed.
    #[error(
        "grid \"{grid}\" of {file} needs {} of memory and the limit is {}; \
                raise the limit (--max-volume-memory) or export it at a lower resolution",
        memory_size(*needed), memory_size(*limit)
    )]
    TooLarge {
        /// The file.
        file: String,
        /// The grid.
        grid: String,
        /// What it needs \[bytes\].
        needed: u64,
        /// What is allowed \[bytes\].
        limit: u64,
    },
    /// The machine has not got the memory.
    #[error(
        "grid \"{grid}\" of {file} needs {} of memory, more than there is; \
                export it at a lower resolution",
        memory_size(*needed)
    )]
    OutOfMemory {
        /// The file.
        file: String,
        /// The grid.
        grid: String,
        /// What it needs \[bytes\].
        needed: u64,
    },
}

/// A number of bytes in the unit that suits it.
pub(super) fn memory_size(bytes: u64) -> String {
    const UNITS: [(&str, u32); 3] = [("GiB", 30), ("MiB", 20), ("KiB", 10)];
    match UNITS.iter().find(|(_, shift)| bytes >> shift > 0) {
        Some((unit, shift)) => format!("{:.1} {unit}", bytes as f64 / (1u64 << shift) as f64),
        None => format!("{bytes} bytes"),
    }
}
