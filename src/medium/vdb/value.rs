//! The types a voxel can have, and how each is stored.

use half::f16;

use super::fault::Fault;

/// The value type a tree declares by its name, `Tree_<type>_5_4_3`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ValueType {
    Float,
    Double,
    /// A half in memory too: the `HalfGrid` of OpenVDB 13, file version 225.
    Half,
    Int32,
    Int64,
    Vec3s,
    Vec3d,
    /// Walked over, not read.
    Vec3i,
    Bool,
    Mask,
}

impl ValueType {
    /// The type and the word users know it by, or why the tree cannot be read at all.
    pub(super) fn of_tree(tree: &str) -> (String, Result<Self, Fault>) {
        let body = tree.strip_prefix("Tree_").unwrap_or(tree);
        let (word, shape) = body.split_once('_').unwrap_or((body, ""));
        if word.starts_with("ptdataidx") || word.starts_with("ptidx") {
            let reason = "it holds points; rasterise them to a density grid first";
            return ("points".into(), Err(Fault::Unsupported(reason.into())));
        }
        let value_type = match word {
            "float" => Self::Float,
            "double" => Self::Double,
            "half" => Self::Half,
            "int32" => Self::Int32,
            "int64" => Self::Int64,
            "vec3s" => Self::Vec3s,
            "vec3d" => Self::Vec3d,
            "vec3i" => Self::Vec3i,
            "bool" => Self::Bool,
            "mask" => Self::Mask,
            _ => {
                let reason = format!("it holds {word} values; convert it to a float grid first");
                return (word.into(), Err(Fault::Unsupported(reason)));
            }
        };
        if shape != "5_4_3" {
            let reason = format!(
                "its tree is {tree} and only 5-4-3 trees can be read; \
                convert it to a standard grid first"
            );
            return (word.into(), Err(Fault::Unsupported(reason)));
        }
        (word.into(), Ok(value_type))
    }

    /// Why grids of this type are listed but not read, if so.
    pub(super) fn refusal(self) -> Option<Fault> {
        let what = match self {
            Self::Vec3i => "vec3i",
            Self::Bool => "bool",
            Self::Mask => "mask",
            _ => return None,
        };
        let reason = format!("it holds {what} values; convert it to a float grid first");
        Some(Fault::Unsupported(reason))
    }

    /// Whether it is one number a voxel that can be read.
    pub(super) fn is_scalar(self) -> bool {
        matches!(self, Self::Float | Self::Double | Self::Half | Self::Int32 | Self::Int64)
    }

    /// Bytes of a value at full precision.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Bool | Self::Mask => 1,
            Self::Half => 2,
            Self::Float | Self::Int32 => 4,
            Self::Double | Self::Int64 => 8,
            Self::Vec3s | Self::Vec3i => 12,
            Self::Vec3d => 24,
        }
    }

    /// Bytes of a value saved as half, where that is fewer: what is half already is left as it is.
    pub(super) fn half_size(self) -> Option<usize> {
        match self {
            Self::Float | Self::Double => Some(2),
            Self::Vec3s | Self::Vec3d => Some(6),
            _ => None,
        }
    }
}

mod sealed {
    pub trait Sealed {}
}

/// A type of voxel that can be read as it is stored: `f16`, `f32`, `f64`, `i32`, `i64`, `[f32; 3]`,
/// `[f64; 3]`.
pub trait GridValue: Copy + Default + Send + Sync + sealed::Sealed + 'static {
    /// The word OpenVDB has for it.
    const WORD: &'static str;
    /// Bytes at full precision.
    #[doc(hidden)]
    const SIZE: usize;
    /// Bytes as half; those of `SIZE` where there are no halves.
    #[doc(hidden)]
    const HALF_SIZE: usize;
    /// From `SIZE` bytes, little-endian.
    #[doc(hidden)]
    fn from_bytes(bytes: &[u8]) -> Self;
    /// From `HALF_SIZE` bytes.
    #[doc(hidden)]
    fn from_half_bytes(bytes: &[u8]) -> Self;
    /// With the sign changed.
    #[doc(hidden)]
    fn negative(self) -> Self;
    /// Equality in which NaN equals NaN, and -0 is not 0.
    #[doc(hidden)]
    fn is_same(self, other: Self) -> bool;
}

/// The first `N` bytes, 0 where there are fewer; callers hand over exactly `N`.
fn head<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.first_chunk().copied().unwrap_or([0; N])
}

/// The number that a half's bits stand for, without a branch, so that many are converted at once.
#[inline(always)]
fn half_to_f32(bits: u16) -> f32 {
    const EXPONENT: u16 = 0x7c00;
    const MANTISSA_DIFFERENCE: u32 = 23 - 10;
    // The difference of the exponents' biases: where a f32 has its exponent, that of a half stands for 2^-112 times it,
    // in subnormal numbers too.
    const TWO_TO_112: f32 = f32::from_bits((127 + 112) << 23);
    let magnitude = u32::from(bits & 0x7fff) << MANTISSA_DIFFERENCE;
    let finite = (f32::from_bits(magnitude) * TWO_TO_112).to_bits();
    let special = magnitude | f32::INFINITY.to_bits();
    let value = if bits & EXPONENT == EXPONENT { special } else { finite };
    f32::from_bits(value | u32::from(bits & 0x8000) << 16)
}

macro_rules! real_value {
    ($real:ty, $word:literal) => {
        impl sealed::Sealed for $real {}
        impl GridValue for $real {
            const WORD: &'static str = $word;
            const SIZE: usize = size_of::<$real>();
            const HALF_SIZE: usize = 2;
            fn from_bytes(bytes: &[u8]) -> Self {
                <$real>::from_le_bytes(head(bytes))
            }
            fn from_half_bytes(bytes: &[u8]) -> Self {
                half_to_f32(u16::from_le_bytes(head(bytes))).into()
            }
            fn negative(self) -> Self {
                -self
            }
            fn is_same(self, other: Self) -> bool {
                self.to_bits() == other.to_bits() || (self.is_nan() && other.is_nan())
            }
        }
    };
}

impl sealed::Sealed for f16 {}
impl GridValue for f16 {
    const WORD: &'static str = "half";
    const SIZE: usize = size_of::<f16>();
    const HALF_SIZE: usize = Self::SIZE;
    fn from_bytes(bytes: &[u8]) -> Self {
        f16::from_le_bytes(head(bytes))
    }
    fn from_half_bytes(bytes: &[u8]) -> Self {
        Self::from_bytes(bytes)
    }
    fn negative(self) -> Self {
        -self
    }
    fn is_same(self, other: Self) -> bool {
        self.to_bits() == other.to_bits() || (self.is_nan() && other.is_nan())
    }
}

macro_rules! integer_value {
    ($integer:ty, $word:literal) => {
        impl sealed::Sealed for $integer {}
        impl GridValue for $integer {
            const WORD: &'static str = $word;
            const SIZE: usize = size_of::<$integer>();
            const HALF_SIZE: usize = Self::SIZE;
            fn from_bytes(bytes: &[u8]) -> Self {
                <$integer>::from_le_bytes(head(bytes))
            }
            fn from_half_bytes(bytes: &[u8]) -> Self {
                Self::from_bytes(bytes)
            }
            fn negative(self) -> Self {
                self.wrapping_neg()
            }
            fn is_same(self, other: Self) -> bool {
                self == other
            }
        }
    };
}

macro_rules! vector_value {
    ($real:ty, $word:literal) => {
        impl sealed::Sealed for [$real; 3] {}
        impl GridValue for [$real; 3] {
            const WORD: &'static str = $word;
            const SIZE: usize = 3 * <$real>::SIZE;
            const HALF_SIZE: usize = 3 * <$real>::HALF_SIZE;
            fn from_bytes(bytes: &[u8]) -> Self {
                std::array::from_fn(|axis| {
                    <$real>::from_bytes(bytes.get(axis * <$real>::SIZE..).unwrap_or(&[]))
                })
            }
            fn from_half_bytes(bytes: &[u8]) -> Self {
                std::array::from_fn(|axis| {
                    <$real>::from_half_bytes(bytes.get(axis * <$real>::HALF_SIZE..).unwrap_or(&[]))
                })
            }
            fn negative(self) -> Self {
                self.map(|component| -component)
            }
            fn is_same(self, other: Self) -> bool {
                (0..3).all(|axis| self[axis].is_same(other[axis]))
            }
        }
    };
}

real_value!(f32, "float");
real_value!(f64, "double");
integer_value!(i32, "int32");
integer_value!(i64, "int64");
vector_value!(f32, "vec3s");
vector_value!(f64, "vec3d");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_half_is_the_number_it_stands_for() {
        for bits in 0..=u16::MAX {
            let (value, expected) = (half_to_f32(bits), f16::from_bits(bits).to_f32());
            assert_eq!(value.is_nan(), expected.is_nan(), "{bits:#x}");
            assert!(value.is_nan() || value.to_bits() == expected.to_bits(), "{bits:#x}");
        }
    }

    #[test]
    fn sameness_is_of_bits_but_for_nan() {
        assert!(!0_f32.is_same(-0.0) && !0_f64.is_same(-0.0) && !f16::ZERO.is_same(f16::NEG_ZERO));
        assert!(f32::NAN.is_same(-f32::NAN) && [1.0, f64::NAN, 0.0].is_same([1.0, f64::NAN, 0.0]));
        assert!(![1.0_f32, 2.0, 0.0].is_same([1.0, 2.0, -0.0]));
    }
}
