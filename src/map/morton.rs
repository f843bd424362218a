//! The Morton (Z-order) curve: queries answered along it find what the last one found.

/// The place on the curve of a cell with 21 bits an axis.
pub fn morton_code([x, y, z]: [u64; 3]) -> u64 {
    spread(x) << 2 | spread(y) << 1 | spread(z)
}

/// Puts two zero bits between the 21 low bits.
fn spread(value: u64) -> u64 {
    let mut x = value & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    const BITS: u32 = 21;

    #[test]
    fn bits_are_spread_by_three() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
    }
}
