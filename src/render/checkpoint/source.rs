//! The file of a checkpoint: its two parts, with their lengths and hashes before them.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use super::CheckpointError;
use crate::files::{WriteFailure, write_beside};
use crate::math::content_hash::hash_bytes;

const MAGIC: [u8; 8] = *b"photonvc";

/// Number of the format, and of what the numbers mean.
const FORMAT: u32 = 1;

/// How the version that runs is named against a checkpoint of another format.
const OWN_FORMAT: &str = concat!(env!("CARGO_PKG_VERSION"), " with format 1");

/// Bytes before the account.
const PREAMBLE: usize = 40;

/// Longest account that is read.
const MAX_ACCOUNT: u32 = 1 << 20;

/// Writes a checkpoint in place of what was at `path`.
pub fn write_parts(path: &Path, account: &[u8], numbers: &[u8]) -> Result<(), WriteFailure> {
    let failure = |source| WriteFailure { path: path.to_path_buf(), source };
    let account_len = u32::try_from(account.len()).map_err(io::Error::other).map_err(failure)?;
    let mut start = Vec::with_capacity(PREAMBLE + account.len());
    start.extend(MAGIC);
    start.extend(FORMAT.to_le_bytes());
    start.extend(account_len.to_le_bytes());
    start.extend((numbers.len() as u64).to_le_bytes());
    start.extend(hash_bytes(account).to_le_bytes());
    start.extend(hash_bytes(numbers).to_le_bytes());
    start.extend(account);
    write_beside(path, |file| {
        file.write_all(&start).and_then(|()| file.write_all(numbers)).map_err(failure)
    })
}

/// A checkpoint that is read: each part only once its length is known to be the file's.
pub struct Source<'a> {
    path: &'a Path,
    file: File,
    lengths: [u64; 2],
    hashes: [u64; 2],
}

impl<'a> Source<'a> {
    /// Opens a file and reads what stands before its two parts.
    pub fn open(path: &'a Path) -> Result<Self, CheckpointError> {
        let failure = |source| CheckpointError::Read { path: path.to_path_buf(), source };
        let foreign = || CheckpointError::Foreign { path: path.to_path_buf() };
        let mut file = File::open(path).map_err(failure)?;
        let found = file.metadata().map_err(failure)?;
        let mut start = Vec::new();
        if !found.is_dir() {
            Read::by_ref(&mut file)
                .take(PREAMBLE as u64)
                .read_to_end(&mut start)
                .map_err(failure)?;
        }
        if !start.starts_with(&MAGIC) {
            return Err(foreign());
        }
        let mut source = Self { path, file, lengths: [0; 2], hashes: [0; 2] };
        let number = |at: usize| -> Option<u32> {
            Some(u32::from_le_bytes(*start.get(at..)?.first_chunk()?))
        };
        let long = |at: usize| -> Option<u64> {
            Some(u64::from_le_bytes(*start.get(at..)?.first_chunk()?))
        };
        let parse = || Some((number(8)?, number(12)?, long(16)?, [long(24)?, long(32)?]));
        let Some((format, account, numbers, hashes)) = parse() else {
            return Err(source.damaged("it is cut off"));
        };
        if format != FORMAT {
            let (path, found) = (path.to_path_buf(), format!("in format {format}"));
            return Err(CheckpointError::OtherVersion { path, found, own: OWN_FORMAT });
        }
        (source.lengths, source.hashes) = ([account.into(), numbers], hashes);
        let expected = (PREAMBLE as u64 + u64::from(account)).checked_add(numbers);
        if account > MAX_ACCOUNT || expected != Some(found.len()) {
            return Err(source.damaged("its length is not the one that it states"));
        }
        Ok(source)
    }

    /// The account.
    pub fn read_account(&mut self) -> Result<Vec<u8>, CheckpointError> {
        self.read_part(0)
    }

    /// The numbers, at most `limit` bytes.
    pub fn read_numbers(&mut self, limit: u64) -> Result<Vec<u8>, CheckpointError> {
        if self.lengths[1] > limit {
            return Err(self.damaged("it holds more numbers than the image has"));
        }
        self.read_part(1)
    }

    fn read_part(&mut self, part: usize) -> Result<Vec<u8>, CheckpointError> {
        let failure = |source| CheckpointError::Read { path: self.path.to_path_buf(), source };
        let mut bytes = Vec::new();
        Read::by_ref(&mut self.file)
            .take(self.lengths[part])
            .read_to_end(&mut bytes)
            .map_err(failure)?;
        match bytes.len() as u64 == self.lengths[part] && hash_bytes(&bytes) == self.hashes[part] {
            true => Ok(bytes),
            false => Err(self.damaged("its bytes have changed since they were written")),
        }
    }

    /// The error of a file that is a checkpoint, but not a whole one.
    pub fn damaged(&self, reason: &str) -> CheckpointError {
        CheckpointError::Damaged { path: self.path.to_path_buf(), reason: reason.to_string() }
    }
}
