//! Blosc 1 frames: a header, offsets of blocks, and in each block one or several packed streams.
//!
//! Header, 16 bytes: version, version of the codec, flags, size of a value, then as u32 the
//! unpacked length, the length of a block, and the length of the frame. Flags: 1 bytes shuffled, 2
//! stored unpacked, 4 bits shuffled, 16 blocks not split; the upper three bits are the codec. A
//! block is split into as many streams as a value has bytes, where blocks are long enough. Source:
//! c-blosc's README_HEADER and blosc.c.

use super::codec::inflate;
use super::cursor::Cursor;
use super::fault::Fault;

pub(super) const HEADER_LEN: usize = 16;
pub(super) const FORMAT_VERSION: u8 = 2;
pub(super) const BYTE_SHUFFLE: u8 = 0x1;
const STORED: u8 = 0x2;
const BIT_SHUFFLE: u8 = 0x4;
const NOT_SPLIT: u8 = 0x10;
/// Values of more bytes are never split into streams, nor are streams of fewer bytes than
/// `MIN_STREAM`.
pub(super) const MAX_STREAMS: usize = 16;
pub(super) const MIN_STREAM: usize = 128;
/// Codec in the upper bits of the flags.
pub(super) const LZ4: u8 = 1;
const ZLIB: u8 = 3;
const WHAT: &str = "a Blosc frame";

/// The packers a frame can name that are read here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Packer {
    Lz4,
    Zlib,
}

impl Packer {
    fn of_flags(flags: u8) -> Result<Self, Fault> {
        let name = match flags >> 5 {
            LZ4 => return Ok(Self::Lz4),
            ZLIB => return Ok(Self::Zlib),
            0 => "BloscLZ",
            2 => "Snappy",
            4 => "Zstandard",
            _ => "an unknown codec",
        };
        Err(Fault::Unsupported(format!(
            "its Blosc frames are packed with {name} and only LZ4 and zlib are read; \
                save it again with OpenVDB's own Blosc or zip compression"
        )))
    }

    fn unpack(self, bytes: &[u8], out: &mut [u8]) -> Result<(), Fault> {
        match self {
            Self::Zlib => inflate(bytes, out),
            Self::Lz4 => match lz4_flex::block::decompress_into(bytes, out) {
                Ok(len) if len == out.len() => Ok(()),
                _ => Err(Fault::invalid("values that LZ4 cannot unpack")),
            },
        }
    }
}

/// Unpacks a frame that must fill `out` exactly. `shuffled` is room to work in.
pub(super) fn unpack(frame: &[u8], out: &mut [u8], shuffled: &mut Vec<u8>) -> Result<(), Fault> {
    let header: [u8; 4] = Cursor::new(frame, 0).array(WHAT)?;
    let [version, _, flags, value_len] = header;
    let value_len = usize::from(value_len);
    let mut cursor = Cursor::new(frame, 4);
    let unpacked_len = cursor.u32(WHAT)? as usize;
    let block_len = cursor.u32(WHAT)? as usize;
    let frame_len = cursor.u32(WHAT)? as usize;

    if version != FORMAT_VERSION || value_len == 0 {
        return Err(Fault::invalid("a Blosc frame of another kind"));
    }
    if unpacked_len != out.len() || frame_len != frame.len() {
        return Err(Fault::invalid("a Blosc frame of the wrong length"));
    }
    if flags & STORED != 0 {
        let stored = frame.get(HEADER_LEN..).unwrap_or(&[]);
        if stored.len() != out.len() {
            return Err(Fault::invalid("a Blosc frame of the wrong length"));
        }
        out.copy_from_slice(stored);
        return Ok(());
    }
    if flags & BIT_SHUFFLE != 0 {
        return Err(Fault::Unsupported(
            "its Blosc frames have their bits shuffled; \
                save it again with OpenVDB's own Blosc or zip compression"
                .into(),
        ));
    }
    if block_len == 0 || block_len > out.len() {
        return Err(Fault::invalid("a Blosc frame with blocks of the wrong length"));
    }

    let packer = Packer::of_flags(flags)?;
    let is_shuffled = flags & BYTE_SHUFFLE != 0 && value_len > 1;
    // The table of block offsets follows the header.
    for block in out.chunks_mut(block_len) {
        let start = cursor.u32(WHAT)? as usize;
        let is_whole = block.len() == block_len;
        let splits = flags & NOT_SPLIT == 0
            && value_len <= MAX_STREAMS
            && block_len / value_len >= MIN_STREAM;
        let stream_count = if splits && is_whole { value_len } else { 1 };
        let streams = Cursor::new(frame, start);
        if is_shuffled {
            shuffled.resize(block.len(), 0);
            unpack_streams(streams, packer, stream_count, shuffled)?;
            unshuffle(shuffled, value_len, block);
        } else {
            unpack_streams(streams, packer, stream_count, block)?;
        }
    }
    Ok(())
}

/// Unpacks the streams of one block, each a length and as many bytes.
fn unpack_streams(
    mut cursor: Cursor<'_>,
    packer: Packer,
    count: usize,
    block: &mut [u8],
) -> Result<(), Fault> {
    if !block.len().is_multiple_of(count) {
        return Err(Fault::invalid("a Blosc block that cannot be split"));
    }
    let stream_len = block.len() / count;
    for stream in block.chunks_exact_mut(stream_len) {
        let packed_len = cursor.u32(WHAT)? as usize;
        let packed = cursor.take(packed_len, WHAT)?;
        // A stream as long packed as unpacked was stored.
        if packed_len == stream_len {
            stream.copy_from_slice(packed);
        } else {
            packer.unpack(packed, stream)?;
        }
    }
    Ok(())
}

/// Puts back together values whose first bytes come first, then all second bytes, and so on. Bytes
/// after the last whole value were left in place.
fn unshuffle(shuffled: &[u8], value_len: usize, out: &mut [u8]) {
    let count = out.len() / value_len;
    let (values, rest) = out.split_at_mut(count * value_len);
    for (index, value) in values.chunks_exact_mut(value_len).enumerate() {
        for (plane, byte) in value.iter_mut().enumerate() {
            *byte = shuffled[plane * count + index];
        }
    }
    rest.copy_from_slice(&shuffled[count * value_len..]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(flags: u8, value_len: u8, unpacked: u32, block: u32, frame: u32) -> Vec<u8> {
        let mut bytes = vec![FORMAT_VERSION, 1, flags, value_len];
        [unpacked, block, frame].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
        bytes
    }

    /// A frame of values packed with LZ4 as c-blosc packs them.
    fn packed(values: &[u8], value_len: usize, block_len: usize, flags: u8) -> Vec<u8> {
        let block_count = values.len().div_ceil(block_len);
        let mut body = Vec::new();
        let mut offsets = Vec::new();
        for block in values.chunks(block_len) {
            offsets.push((HEADER_LEN + 4 * block_count + body.len()) as u32);
            let count = block.len() / value_len;
            let mut planes: Vec<u8> =
                (0..count * value_len).map(|i| block[i % count * value_len + i / count]).collect();
            planes.extend(&block[count * value_len..]);
            let block_shuffled = if flags & BYTE_SHUFFLE != 0 { planes } else { block.to_vec() };
            let split = flags & NOT_SPLIT == 0
                && block_len / value_len >= MIN_STREAM
                && block.len() == block_len;
            let stream_len = if split { block.len() / value_len } else { block.len() };
            for stream in block_shuffled.chunks(stream_len) {
                let mut lz4 = lz4_flex::block::compress(stream);
                if lz4.len() >= stream.len() {
                    lz4 = stream.to_vec();
                }
                body.extend((lz4.len() as u32).to_le_bytes());
                body.extend(lz4);
            }
        }
        let frame_len = HEADER_LEN + 4 * block_count + body.len();
        let mut frame = header(
            1 << 5 | flags,
            value_len as u8,
            values.len() as u32,
            block_len as u32,
            frame_len as u32,
        );
        offsets.iter().for_each(|offset| frame.extend(offset.to_le_bytes()));
        frame.extend(body);
        frame
    }

    #[test]
    fn every_layout_of_blocks_comes_back() {
        let values: Vec<u8> = (0..4099u32).map(|i| (i / 64 + i % 4 * 40) as u8).collect();
        for flags in [0, BYTE_SHUFFLE, NOT_SPLIT, NOT_SPLIT | BYTE_SHUFFLE] {
            for (value_len, block_len) in
                [(4, 256), (4, 1024), (2, 512), (8, 4096), (12, 240), (1, 300), (4, 4099)]
            {
                if block_len % value_len != 0 && flags & NOT_SPLIT == 0 {
                    continue;
                }
                let frame = packed(&values, value_len, block_len, flags);
                let mut out = vec![0; values.len()];
                unpack(&frame, &mut out, &mut Vec::new()).unwrap();
                assert_eq!(out, values, "flags {flags}, {value_len} in {block_len}");
            }
        }
    }

    #[test]
    fn a_stored_frame_is_copied() {
        let mut frame = header(STORED | BYTE_SHUFFLE, 4, 5, 5, 21);
        frame.extend([1, 2, 3, 4, 5]);
        let mut out = [0; 5];
        unpack(&frame, &mut out, &mut Vec::new()).unwrap();
        assert_eq!(out, [1, 2, 3, 4, 5]);
    }

    #[test]
    fn headers_that_lie_are_errors() {
        let sound = packed(&[9; 512], 4, 256, BYTE_SHUFFLE);
        let lies: [(usize, &[u8]); 9] = [
            (0, &[3]),
            (3, &[0]),
            (2, &[STORED]),
            (2, &[BIT_SHUFFLE | 1 << 5]),
            (4, &[0, 3, 0, 0]),
            (8, &[0, 0, 0, 0]),
            (8, &[0xff, 0xff, 0xff, 0xff]),
            (12, &[0, 0, 0, 0x80]),
            (16, &[0xff, 0xff, 0xff, 0xff]),
        ];
        for (at, bytes) in lies {
            let mut frame = sound.clone();
            frame[at..at + bytes.len()].copy_from_slice(bytes);
            assert!(unpack(&frame, &mut [0; 512], &mut Vec::new()).is_err(), "at {at}");
        }
        for len in 0..sound.len() {
            assert!(unpack(&sound[..len], &mut [0; 512], &mut Vec::new()).is_err());
        }
    }

    #[test]
    fn other_packers_are_refused_by_name() {
        for (code, name) in [(0u8, "BloscLZ"), (2, "Snappy"), (4, "Zstandard")] {
            let frame = header(code << 5, 4, 8, 8, 16);
            let fault = unpack(&frame, &mut [0; 8], &mut Vec::new()).unwrap_err();
            assert!(fault.to_string().contains(name), "{fault}");
        }
    }
}
