//! What can go wrong with writing a VDB file, as one sentence that names the file and the grid.

use std::path::PathBuf;

use crate::files::WriteFailure;

/// Why a file was not written. What stood in its place is untouched.
#[derive(Debug, thiserror::Error)]
pub enum VdbWriteError {
    /// The operating system does not take the bytes.
    #[error(transparent)]
    Write(#[from] WriteFailure),
    /// The grid is not one that can be written.
    #[error("grid \"{grid}\" cannot be written to {path}: {problem}", path = path.display())]
    Grid {
        /// The file.
        path: PathBuf,
        /// The grid.
        grid: String,
        /// What does not fit.
        problem: GridProblem,
    },
    /// Other grids, or in another order, than the writer was made for.
    #[error(
        "{path} was to hold {names:?} and got {got} where that list goes on; write those grids, in order",
        path = path.display(), got = got.as_ref().map_or("its end".into(), |name| format!("{name:?}"))
    )]
    Order {
        /// The file.
        path: PathBuf,
        /// Names the writer was made for.
        names: Vec<String>,
        /// Name that came instead of the next; none at the end.
        got: Option<String>,
    },
}

/// Why a grid cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GridProblem {
    /// Leaves, masks and values do not belong together.
    #[error(
        "it has {leaves} leaves, {masks} masks and {values} values where each leaf has one mask and 512 values"
    )]
    Lengths {
        /// Number of leaves.
        leaves: usize,
        /// Number of masks.
        masks: usize,
        /// Number of values.
        values: usize,
    },
    /// A leaf or a tile does not begin at a multiple of its edge.
    #[error("its leaf or tile at {origin:?} does not begin at multiples of {dim}")]
    Misaligned {
        /// Lowest voxel.
        origin: [i32; 3],
        /// Edge \[voxels\].
        dim: u32,
    },
    /// A tile of a size no node has.
    #[error("its tile at {origin:?} has an edge of {dim} voxels, and tiles have 8, 128 or 4096")]
    TileSize {
        /// Lowest voxel.
        origin: [i32; 3],
        /// Edge \[voxels\].
        dim: u32,
    },
    /// A voxel would have two values.
    #[error("two of its leaves or tiles hold the voxel {voxel:?}")]
    Overlap {
        /// A voxel of both.
        voxel: [i32; 3],
    },
    /// The map to the world is not finite or has no inverse.
    #[error("its transform is not finite or cannot be inverted")]
    Transform,
    /// The name holds the character that OpenVDB sets before the number of a duplicate, or has more
    /// than 65535 bytes.
    #[error("its name is too long or holds the character U+001E, which OpenVDB reserves")]
    Name,
    /// Metadata of a name that the writer fills itself.
    #[error("its metadata \"{name}\" is one the writer sets itself")]
    ReservedMetadata {
        /// Name of the value.
        name: String,
    },
}
