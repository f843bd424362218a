//! The values of one node, with what the active mask makes superfluous left out.
//!
//! The codes are those told of where blocks are read.

use super::pack::Packer;
use super::value::StoredValue;
use crate::medium::vdb::block::Layout;

/// The values of a node, and which of them count.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeValues<'a, V> {
    pub values: &'a [V],
    pub active: &'a [u64],
    /// Places of children, whose values are of no account; none in leaves.
    pub children: &'a [u64],
    /// Already rounded, where values are saved as half.
    pub background: V,
}

impl<V: StoredValue> NodeValues<'_, V> {
    /// Appends code, inactive values and chunk.
    pub(super) fn put(&self, layout: &Layout, packer: &mut Packer, out: &mut Vec<u8>) {
        let inactive = if layout.compression.active_mask {
            Inactive::of(self.inactive_values(layout), self.background)
        } else {
            Inactive::Many
        };
        out.push(inactive.code());
        inactive.told().into_iter().flatten().for_each(|value| value.put(out));
        if let Some(second) = inactive.second(self.background) {
            self.put_selection(layout, second, out);
        }

        packer.raw.clear();
        let put = if layout.is_half { V::put_half } else { V::put };
        for (index, &value) in self.values.iter().enumerate() {
            if matches!(inactive, Inactive::Many) || is_set(self.active, index) {
                put(value, &mut packer.raw);
            }
        }
        // No values: nothing at all is written for halves, an empty chunk otherwise.
        if !(packer.raw.is_empty() && layout.is_half) {
            packer.put_chunk(layout.compression.codec, layout.stored_size, out);
        }
    }

    /// The inactive values that count, as a reader is to see them.
    fn inactive_values(&self, layout: &Layout) -> impl Iterator<Item = V> {
        let counts = |index: &usize| !is_set(self.active, *index) && !is_set(self.children, *index);
        (0..self.values.len()).filter(counts).map(|index| seen(self.values[index], layout))
    }

    /// Appends a bit a value: whether it is the second of two inactive values.
    fn put_selection(&self, layout: &Layout, second: V, out: &mut Vec<u8>) {
        for (word, values) in self.values.chunks(64).enumerate() {
            let inactive = !self.active.get(word).copied().unwrap_or(0);
            let bits = values.iter().enumerate().fold(0, |bits, (bit, &value)| {
                bits | u64::from(seen(value, layout).is_identical(second)) << bit
            });
            out.extend((bits & inactive).to_le_bytes());
        }
    }
}

/// The value that the file's precision leaves.
fn seen<V: StoredValue>(value: V, layout: &Layout) -> V {
    if layout.is_half { value.rounded() } else { value }
}

fn is_set(bits: &[u64], index: usize) -> bool {
    bits.get(index >> 6).is_some_and(|word| word >> (index & 63) & 1 == 1)
}

/// What the inactive values of a node have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Inactive<V> {
    Background,
    MinusBackground,
    One(V),
    MinusAndBackground,
    OneAndBackground(V),
    Two(V, V),
    /// More than two, or not to be left out.
    Many,
}

impl<V: StoredValue> Inactive<V> {
    fn of(values: impl Iterator<Item = V>, background: V) -> Self {
        let mut distinct = [None, None];
        for value in values {
            match distinct {
                [Some(first), _] if value.is_identical(first) => {}
                [_, Some(second)] if value.is_identical(second) => {}
                [None, _] => distinct[0] = Some(value),
                [_, None] => distinct[1] = Some(value),
                _ => return Self::Many,
            }
        }
        let is_background = |value: V| value.is_identical(background);
        let is_minus = |value: V| value.is_identical(background.negative());
        match distinct {
            [None, _] => Self::Background,
            [Some(one), None] if is_background(one) => Self::Background,
            [Some(one), None] if is_minus(one) => Self::MinusBackground,
            [Some(one), None] => Self::One(one),
            [Some(first), Some(second)] => {
                let other = match (is_background(first), is_background(second)) {
                    (true, _) => second,
                    (_, true) => first,
                    _ => return Self::Two(first, second),
                };
                if is_minus(other) {
                    Self::MinusAndBackground
                } else {
                    Self::OneAndBackground(other)
                }
            }
        }
    }

    fn code(&self) -> u8 {
        match self {
            Self::Background => 0,
            Self::MinusBackground => 1,
            Self::One(_) => 2,
            Self::MinusAndBackground => 3,
            Self::OneAndBackground(_) => 4,
            Self::Two(..) => 5,
            Self::Many => 6,
        }
    }

    /// The values that stand in the file.
    fn told(&self) -> [Option<V>; 2] {
        match *self {
            Self::One(one) | Self::OneAndBackground(one) => [Some(one), None],
            Self::Two(first, second) => [Some(first), Some(second)],
            _ => [None, None],
        }
    }

    /// The value that a mask selects, where there is one.
    fn second(&self, background: V) -> Option<V> {
        match *self {
            Self::MinusAndBackground | Self::OneAndBackground(_) => Some(background),
            Self::Two(_, second) => Some(second),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inactive_values_are_told_by_the_shortest_code() {
        let code = |values: &[f32], background: f32| {
            Inactive::of(values.iter().copied(), background).code()
        };
        let nan = f32::NAN;
        for (values, background, expected) in [
            (&[][..], 2.0, 0),
            (&[2.0, 2.0], 2.0, 0),
            (&[-2.0], 2.0, 1),
            (&[5.0, 5.0], 2.0, 2),
            (&[-2.0, 2.0, -2.0], 2.0, 3),
            (&[2.0, -2.0], 2.0, 3),
            (&[2.0, 5.0, 2.0], 2.0, 4),
            (&[5.0, 2.0], 2.0, 4),
            (&[5.0, 6.0], 2.0, 5),
            (&[-2.0, 6.0], 2.0, 5),
            (&[5.0, 6.0, 2.0], 2.0, 6),
            (&[nan, nan], nan, 0),
            (&[nan, 1.0, nan], 0.0, 5),
            (&[-0.0], 0.0, 1),
            (&[-0.0, 0.0], 0.0, 3),
        ] {
            assert_eq!(code(values, background), expected, "{values:?} in {background}");
        }
    }
}
