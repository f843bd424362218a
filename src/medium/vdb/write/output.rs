//! Where the bytes go: counts them, hashes them, and writes over earlier ones.

use std::io::{self, BufWriter, Seek, SeekFrom, Write};

const START: [u64; 2] = [0xcbf2_9ce4_8422_2325, 0x9ae1_6a3b_2f90_404f];
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// A seekable output that begins at offset 0.
#[derive(Debug)]
pub(super) struct Output<W: Write> {
    to: BufWriter<W>,
    position: u64,
    /// FNV-1a over 64-bit words with an added shift, of two beginnings.
    hash: [u64; 2],
}

impl<W: Write + Seek> Output<W> {
    pub(super) fn new(to: W) -> Self {
        Self { to: BufWriter::with_capacity(1 << 20, to), position: 0, hash: START }
    }

    /// Bytes written so far.
    pub(super) fn position(&self) -> u64 {
        self.position
    }

    /// Appends bytes.
    pub(super) fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.to.write_all(bytes)?;
        self.position += bytes.len() as u64;
        self.hash = self.hash.map(|hash| hash_bytes(hash, bytes));
        Ok(())
    }

    /// Writes over bytes at an earlier `position`; they are not hashed.
    pub(super) fn patch(&mut self, position: u64, bytes: &[u8]) -> io::Result<()> {
        self.to.seek(SeekFrom::Start(position))?;
        self.to.write_all(bytes)?;
        self.to.seek(SeekFrom::Start(self.position)).map(drop)
    }

    /// A UUID made of the hash of all bytes appended (version 8 of RFC 9562: of the writer's own
    /// making).
    pub(super) fn uuid(&self) -> String {
        let [high, low] = self.hash;
        let high = high & !0xf000 | 0x8000;
        let low = low & !(0b11 << 62) | 0b10 << 62;
        format!(
            "{:08x}-{:04x}-{:04x}-{:04x}-{:012x}",
            high >> 32,
            high >> 16 & 0xffff,
            high & 0xffff,
            low >> 48,
            low & 0xffff_ffff_ffff
        )
    }

    /// The output, when all bytes have reached it.
    pub(super) fn into_inner(self) -> io::Result<W> {
        self.to.into_inner().map_err(io::IntoInnerError::into_error)
    }
}

/// Hashes bytes and their number.
fn hash_bytes(hash: u64, bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks::<8>();
    let mut last = [0; 8];
    last[..rest.len()].copy_from_slice(rest);
    let words = words.iter().chain([&last]).map(|&word| u64::from_le_bytes(word));
    words.chain([bytes.len() as u64]).fold(hash, |hash, word| {
        let product = (hash ^ word).wrapping_mul(PRIME);
        product ^ product >> 32
    })
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    #[test]
    fn what_is_patched_stays_in_place() {
        let mut output = Output::new(Cursor::new(Vec::new()));
        output.put(&[0; 5]).unwrap();
        let before = output.uuid();
        output.patch(1, &[7, 8]).unwrap();
        assert_eq!(output.uuid(), before);
        output.put(&[9]).unwrap();
        assert_ne!(output.uuid(), before);
        assert_eq!(output.position(), 6);
        assert_eq!(output.into_inner().unwrap().into_inner(), [0, 7, 8, 0, 0, 9]);
    }

    #[test]
    fn a_uuid_has_the_form_of_one() {
        let mut output = Output::new(Cursor::new(Vec::new()));
        output.put(b"photons").unwrap();
        let uuid = output.uuid();
        let lengths: Vec<_> = uuid.split('-').map(str::len).collect();
        assert_eq!(lengths, [8, 4, 4, 4, 12]);
        assert_eq!(&uuid[14..15], "8");
        assert!("89ab".contains(&uuid[19..20]));
    }
}
