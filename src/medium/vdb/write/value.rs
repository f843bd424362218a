//! The types of value that can be written, and their bytes.

use half::f16;

use crate::medium::vdb::value::{GridValue, ValueType};

/// A type of value that can be written.
pub(super) trait StoredValue: GridValue {
    const TYPE: ValueType;
    /// Bytes the OpenVDB library (10.0, 64 bits) takes for a tree without nodes, and for each place
    /// of an internal node: a pointer or a value.
    const TREE_BYTES: u64;
    const PLACE_BYTES: u64;

    /// Appends its `SIZE` bytes, little-endian.
    fn put(self, out: &mut Vec<u8>);
    /// Appends its `HALF_SIZE` bytes, rounded to the nearest half.
    fn put_half(self, out: &mut Vec<u8>);
    /// The value that half precision leaves of it.
    fn rounded(self) -> Self;
    /// Equality of all bits: tells zeros of either sign apart, and NaN equals the same NaN.
    fn is_identical(self, other: Self) -> bool;
}

impl StoredValue for f32 {
    const TYPE: ValueType = ValueType::Float;
    const TREE_BYTES: u64 = 1304;
    const PLACE_BYTES: u64 = 8;

    fn put(self, out: &mut Vec<u8>) {
        out.extend(self.to_le_bytes());
    }

    fn put_half(self, out: &mut Vec<u8>) {
        out.extend(f16::from_f32(self).to_le_bytes());
    }

    fn rounded(self) -> Self {
        f16::from_f32(self).to_f32()
    }

    fn is_identical(self, other: Self) -> bool {
        self.to_bits() == other.to_bits()
    }
}

impl StoredValue for [f32; 3] {
    const TYPE: ValueType = ValueType::Vec3s;
    const TREE_BYTES: u64 = 1320;
    const PLACE_BYTES: u64 = 16;

    fn put(self, out: &mut Vec<u8>) {
        self.into_iter().for_each(|component| component.put(out));
    }

    fn put_half(self, out: &mut Vec<u8>) {
        self.into_iter().for_each(|component| component.put_half(out));
    }

    fn rounded(self) -> Self {
        self.map(StoredValue::rounded)
    }

    fn is_identical(self, other: Self) -> bool {
        (0..3).all(|axis| self[axis].is_identical(other[axis]))
    }
}
