//! A 64-bit hash of the content of a file, computed in parallel and equal for any number of threads.
//!
//! FNV-1a (Fowler, Noll and Vo) over 64-bit words with an added shift, since FNV's product moves bits upwards
//! only. A file is cut into chunks of fixed size; a chunk is hashed in four lanes that take every fourth word,
//! so that four products are under way at once. Lanes, chunks and the length are hashed in their order. Every
//! step is one-to-one in what it takes in, so files that differ in one word never have the same hash. Tells
//! files apart; no defence against forgery.

use rayon::prelude::*;

/// Bytes of a chunk; only the last of a file may have fewer.
pub(crate) const CHUNK_BYTES: usize = 1 << 14;

const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;
const WORD_BYTES: usize = 8;
const LANES: usize = 4;

/// The hash of a whole file in memory.
pub(crate) fn hash_bytes(bytes: &[u8]) -> u64 {
    let chunks: Vec<u64> = bytes.par_chunks(CHUNK_BYTES).map(hash_chunk).collect();
    hash_chunks(&chunks, bytes.len() as u64)
}

/// The hash of a file of `len` bytes from the hashes of its chunks.
pub(crate) fn hash_chunks(chunks: &[u64], len: u64) -> u64 {
    chunks.iter().copied().chain([len]).fold(OFFSET_BASIS, step)
}

/// The hash of one chunk.
pub(crate) fn hash_chunk(bytes: &[u8]) -> u64 {
    let (rounds, rest) = bytes.as_chunks::<{ WORD_BYTES * LANES }>();
    let mut lanes = [OFFSET_BASIS; LANES];
    for round in rounds {
        let (words, _) = round.as_chunks::<WORD_BYTES>();
        for (lane, word) in lanes.iter_mut().zip(words) {
            *lane = step(*lane, u64::from_le_bytes(*word));
        }
    }
    // The last words are filled up with zeros; the length tells how many.
    let rest = rest.chunks(WORD_BYTES).map(|bytes| {
        let mut word = [0; WORD_BYTES];
        word[..bytes.len()].copy_from_slice(bytes);
        u64::from_le_bytes(word)
    });
    lanes.into_iter().chain(rest).chain([bytes.len() as u64]).fold(OFFSET_BASIS, step)
}

#[inline(always)]
fn step(hash: u64, word: u64) -> u64 {
    let product = (hash ^ word).wrapping_mul(PRIME);
    product ^ (product >> 32)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn every_bit_counts() {
        let bytes: Vec<u8> = (0..100).collect();
        let mut hashes = vec![hash_bytes(&bytes), hash_bytes(&[])];
        for bit in 0..800 {
            let mut changed = bytes.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            hashes.push(hash_bytes(&changed));
        }
        hashes.extend((1..80).map(|zeros| hash_bytes(&vec![0; zeros])));
        assert_eq!(hashes.iter().collect::<HashSet<_>>().len(), hashes.len());
    }

    #[test]
    fn the_place_of_every_chunk_counts() {
        let mut bytes = vec![0; 3 * CHUNK_BYTES + 5];
        let mut hashes = vec![hash_bytes(&bytes)];
        for at in [0, CHUNK_BYTES - 1, CHUNK_BYTES, 2 * CHUNK_BYTES, 3 * CHUNK_BYTES + 4] {
            bytes[at] = 1;
            hashes.push(hash_bytes(&bytes));
            bytes[at] = 0;
        }
        hashes.push(hash_bytes(&bytes[..3 * CHUNK_BYTES]));
        assert_eq!(hashes.iter().collect::<HashSet<_>>().len(), hashes.len());
    }
}
