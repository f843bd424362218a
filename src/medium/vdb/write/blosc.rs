//! Blosc 1 frames as c-blosc makes them for OpenVDB: one block, its bytes shuffled, packed with LZ4.
//!
//! A block whose values are few enough bytes wide and many is split into one stream for each byte of
//! a value. A stream that LZ4 does not shorten is stored. The header is described where frames are
//! read.

use crate::medium::vdb::blosc::{
    BYTE_SHUFFLE, FORMAT_VERSION, HEADER_LEN, LZ4, MAX_STREAMS, MIN_STREAM,
};

/// Version of LZ4's format that c-blosc notes.
const LZ4_VERSION: u8 = 1;
/// Header, and the offset of the one block.
const BLOCK_START: usize = HEADER_LEN + 4;

/// Packs values of `value_len` bytes into `frame`. `shuffled` is room to work in.
pub(super) fn pack(values: &[u8], value_len: usize, frame: &mut Vec<u8>, shuffled: &mut Vec<u8>) {
    shuffle(values, value_len, shuffled);
    let splits = value_len <= MAX_STREAMS && values.len() / value_len >= MIN_STREAM;
    let stream_len = if splits { values.len() / value_len } else { values.len() };

    frame.clear();
    frame.resize(BLOCK_START, 0);
    for stream in shuffled.chunks_exact(stream_len) {
        put_stream(stream, frame);
    }
    frame[..4].copy_from_slice(&[
        FORMAT_VERSION,
        LZ4_VERSION,
        BYTE_SHUFFLE | LZ4 << 5,
        value_len as u8,
    ]);
    let lengths = [values.len(), values.len(), frame.len(), BLOCK_START];
    for (word, length) in frame[4..BLOCK_START].chunks_exact_mut(4).zip(lengths) {
        word.copy_from_slice(&(length as u32).to_le_bytes());
    }
}

/// Appends the length of a packed stream and the stream.
fn put_stream(stream: &[u8], frame: &mut Vec<u8>) {
    let start = frame.len() + 4;
    frame.resize(start + lz4_flex::block::get_maximum_output_size(stream.len()), 0);
    let packed = lz4_flex::block::compress_into(stream, &mut frame[start..]);
    let len = match packed {
        Ok(len) if len < stream.len() => len,
        _ => {
            frame[start..start + stream.len()].copy_from_slice(stream);
            stream.len()
        }
    };
    frame[start - 4..start].copy_from_slice(&(len as u32).to_le_bytes());
    frame.truncate(start + len);
}

/// Puts first bytes of all values first, then all second bytes, and so on.
fn shuffle(values: &[u8], value_len: usize, shuffled: &mut Vec<u8>) {
    let count = values.len() / value_len;
    shuffled.clear();
    shuffled.resize(count * value_len, 0);
    for (plane, bytes) in shuffled.chunks_exact_mut(count).enumerate() {
        for (byte, value) in bytes.iter_mut().zip(values.chunks_exact(value_len)) {
            *byte = value[plane];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::vdb::blosc::unpack;

    #[test]
    fn frames_of_every_size_come_back() {
        let noise = |i: usize| (i * i * 2_654_435_761) as u8;
        for value_len in [2, 4, 6, 12] {
            for count in [1, 2, 11, 31, 127, 128, 129, 512, 4096] {
                for kind in 0..3 {
                    let byte = |i: usize| match kind {
                        0 => 7,
                        1 => (i / 64) as u8,
                        _ => noise(i),
                    };
                    let values: Vec<u8> = (0..count * value_len).map(byte).collect();
                    let mut frame = Vec::new();
                    pack(&values, value_len, &mut frame, &mut Vec::new());
                    let mut out = vec![0; values.len()];
                    unpack(&frame, &mut out, &mut Vec::new()).unwrap();
                    assert_eq!(out, values, "{count} values of {value_len} bytes");
                }
            }
        }
    }
}
