//! A place in the bytes of a file that moves forward and never past the end. All numbers are
//! little-endian.

use super::fault::Fault;

/// Longest name or word read; the longest a sound file holds are some hundred bytes.
const MAX_STRING: usize = 1 << 20;

/// Bytes and how many of them have been read.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl<'a> Cursor<'a> {
    /// At the `position` of `bytes`; past the end there is nothing to read.
    pub(super) fn new(bytes: &'a [u8], position: usize) -> Self {
        Self { bytes, position }
    }

    /// Bytes from the start.
    pub(super) fn position(&self) -> usize {
        self.position
    }

    /// The next `len` bytes; `what` they are, for the message when there are fewer.
    pub(super) fn take(&mut self, len: usize, what: &'static str) -> Result<&'a [u8], Fault> {
        let end = self.position.checked_add(len).ok_or(Fault::EndsEarly(what))?;
        let taken = self.bytes.get(self.position..end).ok_or(Fault::EndsEarly(what))?;
        self.position = end;
        Ok(taken)
    }

    /// The next `N` bytes.
    pub(super) fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], Fault> {
        let taken = self.take(N, what)?;
        <[u8; N]>::try_from(taken).map_err(|_| Fault::EndsEarly(what))
    }

    /// One byte.
    pub(super) fn u8(&mut self, what: &'static str) -> Result<u8, Fault> {
        Ok(self.array::<1>(what)?[0])
    }

    /// An unsigned number of four bytes.
    pub(super) fn u32(&mut self, what: &'static str) -> Result<u32, Fault> {
        Ok(u32::from_le_bytes(self.array(what)?))
    }

    /// A signed number of four bytes.
    pub(super) fn i32(&mut self, what: &'static str) -> Result<i32, Fault> {
        Ok(i32::from_le_bytes(self.array(what)?))
    }

    /// A signed number of eight bytes.
    pub(super) fn i64(&mut self, what: &'static str) -> Result<i64, Fault> {
        Ok(i64::from_le_bytes(self.array(what)?))
    }

    /// `N` doubles.
    pub(super) fn f64s<const N: usize>(&mut self, what: &'static str) -> Result<[f64; N], Fault> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = f64::from_le_bytes(self.array(what)?);
        }
        Ok(numbers)
    }

    /// Three signed numbers of four bytes: index coordinates.
    pub(super) fn coordinates(&mut self, what: &'static str) -> Result<[i32; 3], Fault> {
        Ok([self.i32(what)?, self.i32(what)?, self.i32(what)?])
    }

    /// A length and as many bytes of UTF-8; what is not UTF-8 is replaced, as names are only shown
    /// and compared.
    pub(super) fn string(&mut self, what: &'static str) -> Result<String, Fault> {
        let len = self.u32(what)? as usize;
        if len > MAX_STRING {
            return Err(Fault::invalid(format!("{what} claims {len} bytes")));
        }
        Ok(String::from_utf8_lossy(self.take(len, what)?).into_owned())
    }
}
