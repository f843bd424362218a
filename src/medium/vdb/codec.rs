//! How the values of a node are packed: as they are, with zlib, or in a Blosc frame.

use flate2::{Decompress, FlushDecompress, Status};

use super::blosc;
use super::cursor::Cursor;
use super::fault::Fault;

/// A grid's compression flags.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Compression {
    /// How chunks of values are packed.
    pub codec: Codec,
    /// Whether the values of inactive voxels may be left out.
    pub active_mask: bool,
}

/// How chunks of values are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Codec {
    /// Not at all.
    Raw,
    /// With zlib.
    Zip,
    /// In a Blosc frame.
    Blosc,
}

impl Compression {
    const ZIP: u32 = 1;
    const ACTIVE_MASK: u32 = 2;
    const BLOSC: u32 = 4;

    /// From the flags in the file. Where both are set, Blosc goes before zip, as in the OpenVDB
    /// library.
    pub(super) fn from_flags(flags: u32) -> Result<Self, Fault> {
        if flags & !(Self::ZIP | Self::ACTIVE_MASK | Self::BLOSC) != 0 {
            return Err(Fault::Unsupported(format!(
                "its compression (flags {flags:#x}) is unknown; \
                save it again with Blosc or zip compression"
            )));
        }
        let codec = if flags & Self::BLOSC != 0 {
            Codec::Blosc
        } else if flags & Self::ZIP != 0 {
            Codec::Zip
        } else {
            Codec::Raw
        };
        Ok(Self { codec, active_mask: flags & Self::ACTIVE_MASK != 0 })
    }

    /// The flags in the file.
    pub(super) fn flags(self) -> u32 {
        let codec = match self.codec {
            Codec::Raw => 0,
            Codec::Zip => Self::ZIP,
            Codec::Blosc => Self::BLOSC,
        };
        codec | if self.active_mask { Self::ACTIVE_MASK } else { 0 }
    }

    /// In the words of the OpenVDB library.
    pub(super) fn words(self) -> String {
        let codec = match self.codec {
            Codec::Raw => None,
            Codec::Zip => Some("zip"),
            Codec::Blosc => Some("blosc"),
        };
        let mask = self.active_mask.then_some("active values");
        let words: Vec<_> = codec.into_iter().chain(mask).collect();
        if words.is_empty() { "none".into() } else { words.join(" + ") }
    }
}

/// The values of one node as they lie in the file.
#[derive(Clone, Copy, Debug)]
pub(super) enum Chunk<'a> {
    Raw(&'a [u8]),
    Zip(&'a [u8]),
    Blosc(&'a [u8]),
}

impl<'a> Chunk<'a> {
    /// Reads a chunk of `len` bytes (unpacked) without unpacking it.
    pub(super) fn read(cursor: &mut Cursor<'a>, codec: Codec, len: usize) -> Result<Self, Fault> {
        const WHAT: &str = "the values of a node";
        if codec == Codec::Raw {
            return Ok(Self::Raw(cursor.take(len, WHAT)?));
        }
        // A packed length; zero or less says that packing did not pay.
        let packed = cursor.i64(WHAT)?;
        let stored = usize::try_from(packed.unsigned_abs()).map_err(|_| Fault::EndsEarly(WHAT))?;
        if packed <= 0 {
            if stored != len {
                return Err(Fault::invalid(format!("{stored} bytes of values where {len} belong")));
            }
            return Ok(Self::Raw(cursor.take(len, WHAT)?));
        }
        let bytes = cursor.take(stored, WHAT)?;
        Ok(match codec {
            Codec::Blosc => Self::Blosc(bytes),
            _ => Self::Zip(bytes),
        })
    }

    /// The chunk's `len` bytes.
    pub(super) fn unpack<'s>(&self, len: usize, scratch: &'s mut Scratch) -> Result<&'s [u8], Fault>
    where
        'a: 's,
    {
        match self {
            Self::Raw(bytes) => Ok(bytes),
            Self::Zip(bytes) => {
                scratch.unpacked.resize(len, 0);
                inflate(bytes, &mut scratch.unpacked)?;
                Ok(&scratch.unpacked)
            }
            Self::Blosc(bytes) => {
                scratch.unpacked.resize(len, 0);
                blosc::unpack(bytes, &mut scratch.unpacked, &mut scratch.shuffled)?;
                Ok(&scratch.unpacked)
            }
        }
    }
}

/// Room that unpacking reuses from node to node.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    unpacked: Vec<u8>,
    shuffled: Vec<u8>,
}

/// Unpacks a zlib stream that must fill `out` exactly.
pub(super) fn inflate(bytes: &[u8], out: &mut [u8]) -> Result<(), Fault> {
    let mut stream = Decompress::new(true);
    let end = stream.decompress(bytes, out, FlushDecompress::Finish);
    if matches!(end, Ok(Status::StreamEnd)) && stream.total_out() == out.len() as u64 {
        Ok(())
    } else {
        Err(Fault::invalid("values that zlib cannot unpack"))
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::{Compression as Level, write::ZlibEncoder};

    use super::*;

    fn deflated(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = ZlibEncoder::new(Vec::new(), Level::default());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn zlib_must_fill_the_values_exactly() {
        let packed = deflated(&[7; 100]);
        let mut out = [0; 100];
        inflate(&packed, &mut out).unwrap();
        assert_eq!(out, [7; 100]);
        assert!(inflate(&packed, &mut [0; 99]).is_err());
        assert!(inflate(&packed, &mut [0; 101]).is_err());
        assert!(inflate(&packed[..packed.len() - 5], &mut out).is_err());
    }

    #[test]
    fn a_chunk_that_did_not_pay_to_pack_is_raw() {
        let mut file = (-4i64).to_le_bytes().to_vec();
        file.extend([1, 2, 3, 4]);
        let chunk = Chunk::read(&mut Cursor::new(&file, 0), Codec::Zip, 4).unwrap();
        assert!(matches!(chunk, Chunk::Raw([1, 2, 3, 4])));
        assert!(Chunk::read(&mut Cursor::new(&file, 0), Codec::Zip, 5).is_err());
    }

    #[test]
    fn extreme_lengths_are_errors() {
        for packed in [i64::MIN, i64::MAX, -1, 1 << 40] {
            let file = packed.to_le_bytes();
            assert!(Chunk::read(&mut Cursor::new(&file, 0), Codec::Blosc, 4).is_err());
        }
    }

    #[test]
    fn compression_words_are_those_of_the_library() {
        for flags in [0, 1, 2, 3, 4, 6] {
            assert_eq!(Compression::from_flags(flags).unwrap().flags(), flags);
        }
        let words = |flags| Compression::from_flags(flags).unwrap().words();
        assert_eq!(words(0), "none");
        assert_eq!(words(3), "zip + active values");
        assert_eq!(words(6), "blosc + active values");
        assert!(Compression::from_flags(8).is_err());
    }
}
