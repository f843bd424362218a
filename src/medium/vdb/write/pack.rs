//! Packing the values of a node: as they are, with zlib, or in a Blosc frame.

use flate2::{Compress, Compression as Level, FlushCompress, Status};

use super::blosc;
use crate::medium::vdb::codec::Codec;

/// Packs chunks of bytes, with room that is used again.
#[derive(Debug)]
pub(super) struct Packer {
    /// The bytes to pack.
    pub raw: Vec<u8>,
    packed: Vec<u8>,
    shuffled: Vec<u8>,
    zlib: Compress,
}

impl Packer {
    pub(super) fn new() -> Self {
        let zlib = Compress::new(Level::default(), true);
        Self { raw: Vec::new(), packed: Vec::new(), shuffled: Vec::new(), zlib }
    }

    /// Appends `raw`, values of `value_len` bytes each, as a chunk. A chunk that packing does not
    /// shorten is stored as it is, under a length of zero or less.
    pub(super) fn put_chunk(&mut self, codec: Codec, value_len: usize, out: &mut Vec<u8>) {
        let is_packed = match codec {
            Codec::Raw => {
                out.extend(&self.raw);
                return;
            }
            Codec::Zip => self.deflate(),
            Codec::Blosc => self.raw.len() > value_len && self.shuffle(value_len),
        };
        let (len, bytes) = if is_packed {
            (self.packed.len() as i64, &self.packed)
        } else {
            (-(self.raw.len() as i64), &self.raw)
        };
        out.extend(len.to_le_bytes());
        out.extend(bytes);
    }

    fn deflate(&mut self) -> bool {
        self.packed.clear();
        // Room for less than the values: what does not fit does not pay.
        self.packed.reserve_exact(self.raw.len().saturating_sub(1));
        self.packed.resize(self.raw.len().saturating_sub(1), 0);
        self.zlib.reset();
        let end = self.zlib.compress(&self.raw, &mut self.packed, FlushCompress::Finish);
        self.packed.truncate(self.zlib.total_out() as usize);
        matches!(end, Ok(Status::StreamEnd))
    }

    fn shuffle(&mut self, value_len: usize) -> bool {
        blosc::pack(&self.raw, value_len, &mut self.packed, &mut self.shuffled);
        self.packed.len() < self.raw.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::vdb::codec::{Chunk, Scratch};
    use crate::medium::vdb::cursor::Cursor;

    /// The bytes of a chunk of the values, and whether the reader finds them packed.
    fn chunk(codec: Codec, values: &[u8]) -> (Vec<u8>, bool) {
        let mut packer = Packer::new();
        let mut out = Vec::new();
        // What a packer has packed before leaves no trace.
        for values in [&[3; 999], values] {
            out.clear();
            packer.raw = values.to_vec();
            packer.put_chunk(codec, 4, &mut out);
        }
        let mut cursor = Cursor::new(&out, 0);
        let chunk = Chunk::read(&mut cursor, codec, values.len()).unwrap();
        assert_eq!(cursor.position(), out.len());
        assert_eq!(chunk.unpack(values.len(), &mut Scratch::default()).unwrap(), values);
        let is_packed = !matches!(chunk, Chunk::Raw(_));
        (out, is_packed)
    }

    #[test]
    fn chunks_are_packed_where_it_pays() {
        let noise: Vec<u8> = (0..2048usize).map(|i| ((i * i * 2_654_435_761) >> 7) as u8).collect();
        let flat = vec![1; 2048];
        for codec in [Codec::Zip, Codec::Blosc] {
            let (packed, is_packed) = chunk(codec, &flat);
            assert!(is_packed && packed.len() < 300, "{codec:?}: {}", packed.len());
            let mut hard: u64 = 1;
            let random: Vec<u8> = (0..2048)
                .map(|_| {
                    hard = hard.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    (hard >> 56) as u8
                })
                .collect();
            let (stored, is_packed) = chunk(codec, &random);
            assert!(!is_packed);
            assert_eq!(stored.len(), 2048 + 8);
            chunk(codec, &noise);
            chunk(codec, &flat[..4]);
            assert_eq!(chunk(codec, &[]).0, [0; 8]);
        }
        assert_eq!(chunk(Codec::Raw, &flat), (flat, false));
    }
}
