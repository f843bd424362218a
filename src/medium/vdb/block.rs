//! The values of one node, with what the active-mask compression left out put back.
//!
//! A byte says how inactive values are told: 0 all are the background, 1 all are minus the
//! background, 2 all are one value that follows, 3 a mask selects between minus and plus
//! background, 4 between one value and the background, 5 between two values, 6 all values are
//! stored. Under the active-mask flag, only the active values are stored unless the byte is 6.

use super::codec::{Chunk, Compression, Scratch};
use super::cursor::Cursor;
use super::fault::Fault;
use super::tree::bits_of;
use super::value::{GridValue, ValueType};

const WHAT: &str = "the values of a node";

/// How the values of a grid are stored.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub compression: Compression,
    /// Bytes of background, tile and inactive values, which are never halved.
    pub value_size: usize,
    /// Bytes of a stored value.
    pub stored_size: usize,
    pub is_half: bool,
}

impl Layout {
    /// That of a grid of the type, saved as half if `half` and the type has halves.
    pub(super) fn new(value_type: ValueType, half: bool, compression: Compression) -> Self {
        let halved = value_type.half_size().filter(|_| half);
        Self {
            compression,
            value_size: value_type.size(),
            stored_size: halved.unwrap_or(value_type.size()),
            is_half: halved.is_some(),
        }
    }
}

/// The values of one node as they lie in the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block<'a> {
    code: u8,
    /// Bytes of the up to two inactive values told.
    inactive: &'a [u8],
    /// Bits that select the second inactive value.
    selection: Option<&'a [u8]>,
    /// Number of values stored.
    count: usize,
    chunk: Chunk<'a>,
}

impl<'a> Block<'a> {
    /// Reads the block of a node of `len` values, `active_count` of them active, without unpacking
    /// it.
    pub(super) fn read(
        cursor: &mut Cursor<'a>,
        layout: &Layout,
        len: usize,
        active_count: usize,
    ) -> Result<Self, Fault> {
        let code = cursor.u8(WHAT)?;
        let inactive_count = match code {
            0 | 1 | 3 | 6 => 0,
            2 | 4 => 1,
            5 => 2,
            _ => {
                return Err(Fault::invalid(format!(
                    "a node whose values have the unknown code {code}"
                )));
            }
        };
        let inactive = cursor.take(inactive_count * layout.value_size, WHAT)?;
        let selection = match code {
            3..=5 => Some(cursor.take(len / 8, WHAT)?),
            _ => None,
        };
        let count = if layout.compression.active_mask && code != 6 { active_count } else { len };
        // No values: nothing at all is written for halves, an empty chunk otherwise.
        let chunk = if count == 0 && layout.is_half {
            Chunk::Raw(&[])
        } else {
            Chunk::read(cursor, layout.compression.codec, count * layout.stored_size)?
        };
        Ok(Self { code, inactive, selection, count, chunk })
    }

    /// Whether every inactive value is the background.
    pub(super) fn has_only_background_inactive(&self, layout: &Layout) -> bool {
        layout.compression.active_mask && self.code == 0
    }

    /// Unpacks the values into `out`, the active ones where `active` has its bits.
    pub(super) fn unpack<V: GridValue, O: Copy>(
        &self,
        layout: &Layout,
        active: &[u64],
        background: V,
        convert: impl Fn(V) -> O,
        out: &mut [O],
        scratch: &mut Scratch,
    ) -> Result<(), Fault> {
        let bytes = self.chunk.unpack(self.count * layout.stored_size, scratch)?;
        let inactive = self.inactive_values(layout, background).map(&convert);
        // Sizes the compiler knows make the loops over the values fast.
        if layout.is_half {
            let stored = bytes.chunks_exact(V::HALF_SIZE).map(V::from_half_bytes);
            self.place(stored.map(convert), active, inactive, out);
        } else {
            let stored = bytes.chunks_exact(V::SIZE).map(V::from_bytes);
            self.place(stored.map(convert), active, inactive, out);
        }
        Ok(())
    }

    /// Puts the stored values in their places and inactive ones between.
    #[inline(always)]
    fn place<O: Copy>(
        &self,
        mut stored: impl Iterator<Item = O>,
        active: &[u64],
        inactive: [O; 2],
        out: &mut [O],
    ) {
        if self.count == out.len() {
            out.iter_mut().zip(stored).for_each(|(value, stored)| *value = stored);
            return;
        }
        let [first, second] = inactive;
        for (number, (values, &active)) in out.chunks_mut(64).zip(active).enumerate() {
            if active != u64::MAX {
                values.fill(first);
                for offset in bits_of(self.selection_word(number)) {
                    values[offset] = second;
                }
            }
            let mut rest = active;
            while rest != 0 {
                // A run of active voxels, from its first to behind its last.
                let start = rest.trailing_zeros() as usize;
                let end = start + (!(rest >> start)).trailing_zeros() as usize;
                for (value, stored) in values[start..end].iter_mut().zip(&mut stored) {
                    *value = stored;
                }
                rest = if end == 64 { 0 } else { rest >> end << end };
            }
        }
    }

    fn inactive_values<V: GridValue>(&self, layout: &Layout, background: V) -> [V; 2] {
        let mut told = self.inactive.chunks_exact(layout.value_size).map(V::from_bytes);
        let untold = if self.code == 0 { background } else { background.negative() };
        [told.next().unwrap_or(untold), told.next().unwrap_or(background)]
    }

    /// Which of 64 values are the second inactive one.
    fn selection_word(&self, number: usize) -> u64 {
        let word = self.selection.and_then(|bytes| bytes.get(8 * number..)?.first_chunk());
        word.copied().map_or(0, u64::from_le_bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A node of 64 values, voxel 0 active with value 9, under the code, with what follows it.
    fn values(code: u8, inactive: &[f32], selection: Option<u64>) -> Vec<f32> {
        let mut file = vec![code];
        inactive.iter().for_each(|value| file.extend(value.to_le_bytes()));
        selection.iter().for_each(|bits| file.extend(bits.to_le_bytes()));
        file.extend(9f32.to_le_bytes());
        let compression = Compression::from_flags(2).unwrap();
        let layout = Layout::new(ValueType::Float, false, compression);
        let mut cursor = Cursor::new(&file, 0);
        let block = Block::read(&mut cursor, &layout, 64, 1).unwrap();
        assert_eq!(cursor.position(), file.len());
        let mut out = vec![0.0; 64];
        block
            .unpack(&layout, &[1], 2.0, |value: f32| value, &mut out, &mut Scratch::default())
            .unwrap();
        out
    }

    #[test]
    fn every_code_restores_its_inactive_values() {
        // Voxel 3 is the one the selection picks.
        let picked = Some(1 << 3);
        // Code, values told, selection; then the values of the other voxels and of voxel 3.
        let expect = |code, inactive: &[f32], selection, others, third| {
            let mut expected = vec![others; 64];
            expected[0] = 9.0;
            expected[3] = third;
            assert_eq!(values(code, inactive, selection), expected, "code {code}");
        };
        expect(0, &[], None, 2.0, 2.0);
        expect(1, &[], None, -2.0, -2.0);
        expect(2, &[5.0], None, 5.0, 5.0);
        expect(3, &[], picked, -2.0, 2.0);
        expect(4, &[5.0], picked, 5.0, 2.0);
        expect(5, &[5.0, 6.0], picked, 5.0, 6.0);
    }

    #[test]
    fn an_unknown_code_is_an_error() {
        let compression = Compression::from_flags(2).unwrap();
        let layout = Layout::new(ValueType::Float, false, compression);
        for code in [7, 255] {
            assert!(Block::read(&mut Cursor::new(&[code; 99], 0), &layout, 64, 1).is_err());
        }
    }
}
