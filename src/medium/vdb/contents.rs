//! The bytes of a VDB file: read once, in parallel, hashed on the way, and never more than allowed.

use std::fs::File;
use std::io::{self, Read};
use std::ops::Deref;
use std::path::Path;

use rayon::prelude::*;

use super::Limits;
use super::error::VdbError;
use crate::math::content_hash::{CHUNK_BYTES, hash_bytes, hash_chunk, hash_chunks};
use crate::medium::pages::Pages;

pub(super) const MAGIC: [u8; 8] = 0x5644_4220u64.to_le_bytes();

/// Chunks a thread reads at once.
const CHUNKS_A_TASK: usize = 16;

/// A file in memory.
#[derive(Debug)]
pub(super) struct Contents {
    pub bytes: FileBytes,
    /// Of all the bytes.
    pub hash: u64,
}

/// The bytes of a file.
#[derive(Debug)]
pub(super) enum FileBytes {
    /// Read here.
    Pages(Pages),
    /// From a caller, or from a pipe.
    Vec(Vec<u8>),
}

impl Deref for FileBytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::Pages(pages) => pages,
            Self::Vec(bytes) => bytes,
        }
    }
}

impl Contents {
    /// Reads a file, which errors call `name`. One that does not begin as a VDB does, or that is larger than
    /// the limit, is not read.
    pub(super) fn read(path: &Path, name: &str, limits: &Limits) -> Result<Self, VdbError> {
        let unreadable = |source| VdbError::Read { file: name.to_owned(), source };
        let mut file = File::open(path).map_err(unreadable)?;
        let mut head = Vec::new();
        file.by_ref().take(MAGIC.len() as u64).read_to_end(&mut head).map_err(unreadable)?;
        if head != MAGIC {
            return Err(VdbError::NotVdb { file: name.to_owned() });
        }
        let metadata = file.metadata().map_err(unreadable)?;
        let limit = limits.max_bytes;
        let too_large = |size| VdbError::FileTooLarge { file: name.to_owned(), size, limit };
        if metadata.is_file() {
            let size = metadata.len();
            if size > limit {
                return Err(too_large(size));
            }
            return read_in_parallel(&file, size).map_err(unreadable);
        }
        // A pipe does not say how much is to come.
        let rest_limit = limit.saturating_sub(MAGIC.len() as u64).saturating_add(1);
        file.take(rest_limit).read_to_end(&mut head).map_err(unreadable)?;
        if head.len() as u64 > limit {
            return Err(too_large(head.len() as u64));
        }
        Ok(Self::of_bytes(head))
    }

    /// Bytes that are in memory already.
    pub(super) fn of_bytes(bytes: Vec<u8>) -> Self {
        let hash = hash_bytes(&bytes);
        Self { bytes: FileBytes::Vec(bytes), hash }
    }
}

fn read_in_parallel(file: &File, size: u64) -> io::Result<Contents> {
    let len = usize::try_from(size).map_err(|_| io::ErrorKind::OutOfMemory)?;
    let mut bytes = Pages::zeroed(len)?;
    let chunks = bytes.par_chunks_mut(CHUNK_BYTES).enumerate().with_min_len(CHUNKS_A_TASK);
    // Each chunk is hashed while it is in the processor's cache.
    let hashes: Vec<u64> = chunks
        .map(|(number, chunk)| {
            read_exact_at(file, chunk, number as u64 * CHUNK_BYTES as u64)?;
            Ok(hash_chunk(chunk))
        })
        .collect::<io::Result<_>>()?;
    Ok(Contents { bytes: FileBytes::Pages(bytes), hash: hash_chunks(&hashes, size) })
}

#[cfg(unix)]
fn read_exact_at(file: &File, bytes: &mut [u8], offset: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, offset)
}

#[cfg(windows)]
fn read_exact_at(file: &File, mut bytes: &mut [u8], mut offset: u64) -> io::Result<()> {
    use std::os::windows::fs::FileExt;
    while !bytes.is_empty() {
        let len = file.seek_read(bytes, offset)?;
        if len == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        bytes = &mut bytes[len..];
        offset += len as u64;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_and_hashed_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vdb");
        for len in [8, CHUNK_BYTES, 70 * CHUNK_BYTES + 3] {
            let mut bytes = MAGIC.to_vec();
            bytes.extend((8..len).map(|n| (n * n / 7) as u8));
            std::fs::write(&path, &bytes).unwrap();
            let limits = |max_bytes| Limits { max_bytes };
            let read = Contents::read(&path, "a.vdb", &limits(len as u64)).unwrap();
            assert_eq!((read.bytes.len(), read.hash), (len, hash_bytes(&bytes)));
            assert!(*read.bytes == *bytes);
            let error = Contents::read(&path, "a.vdb", &limits(len as u64 - 1)).unwrap_err();
            assert!(matches!(error, VdbError::FileTooLarge { .. }), "{error}");
        }
    }
}
