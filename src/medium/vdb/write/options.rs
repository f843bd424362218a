//! How grids are stored.

use crate::medium::vdb::codec::{Codec, Compression};

/// How grids are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WriteOptions {
    /// How values are packed.
    pub compression: WriteCompression,
    /// Whether values are rounded to 16 bits, to the nearest half; what is beyond 65504 becomes
    /// infinite. Tiles of 4096 voxels keep all their bits, as in the OpenVDB library.
    pub half: bool,
}

/// How values are packed. All are lossless.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WriteCompression {
    /// Every value as it is.
    None,
    /// Inactive values are left out where a node has two or fewer of them.
    ActiveMask,
    /// As `ActiveMask`, and packed with zlib: smallest, and slow to write.
    Zip,
    /// As `ActiveMask`, and packed with Blosc (LZ4): what OpenVDB does by default.
    #[default]
    Blosc,
}

impl WriteCompression {
    pub(super) fn compression(self) -> Compression {
        let codec = match self {
            Self::None | Self::ActiveMask => Codec::Raw,
            Self::Zip => Codec::Zip,
            Self::Blosc => Codec::Blosc,
        };
        Compression { codec, active_mask: self != Self::None }
    }
}
