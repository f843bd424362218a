//! Hashes of a grid's values that do not depend on their order: sums of hashes of (coordinates,
//! value). All arithmetic is modulo 2^64.

use photonvdb::medium::vdb::{GridValue, SparseGrid, f16};

/// A value as 64 bits, the same for every NaN.
pub trait Bits: GridValue {
    fn bits(self) -> u64;
    /// As number, of scalars.
    fn number(self) -> f64;
}

impl Bits for f32 {
    fn bits(self) -> u64 {
        u64::from(if self.is_nan() { 0x7fc0_0000 } else { self.to_bits() })
    }
    fn number(self) -> f64 {
        f64::from(self)
    }
}

/// As the `f32` it is equal to.
impl Bits for f16 {
    fn bits(self) -> u64 {
        self.to_f32().bits()
    }
    fn number(self) -> f64 {
        self.to_f64()
    }
}

impl Bits for f64 {
    fn bits(self) -> u64 {
        if self.is_nan() { 0x7ff8_0000_0000_0000 } else { self.to_bits() }
    }
    fn number(self) -> f64 {
        self
    }
}

impl Bits for i32 {
    fn bits(self) -> u64 {
        u64::from(self as u32)
    }
    fn number(self) -> f64 {
        f64::from(self)
    }
}

impl Bits for i64 {
    fn bits(self) -> u64 {
        self as u64
    }
    fn number(self) -> f64 {
        self as f64
    }
}

impl Bits for [f32; 3] {
    fn bits(self) -> u64 {
        vector_bits(self.map(Bits::bits))
    }
    fn number(self) -> f64 {
        f64::NAN
    }
}

impl Bits for [f64; 3] {
    fn bits(self) -> u64 {
        vector_bits(self.map(Bits::bits))
    }
    fn number(self) -> f64 {
        f64::NAN
    }
}

fn vector_bits([x, y, z]: [u64; 3]) -> u64 {
    sum([
        mix(x).wrapping_mul(11),
        mix(y.wrapping_add(1)).wrapping_mul(13),
        mix(z.wrapping_add(2)).wrapping_mul(17),
    ])
}

/// splitmix64.
fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

fn sum(terms: impl IntoIterator<Item = u64>) -> u64 {
    terms.into_iter().fold(0, u64::wrapping_add)
}

fn hash_at([x, y, z]: [i32; 3], bits: u64) -> u64 {
    let word = |along: i32| u64::from(along as u32);
    let place = sum([
        mix(word(x)).wrapping_mul(3),
        mix(word(y) << 1 | 1 << 40).wrapping_mul(5),
        mix(word(z) << 2 | 1 << 41).wrapping_mul(7),
    ]);
    mix(place ^ mix(bits))
}

/// Every voxel of every leaf: coordinates, whether active, value.
pub fn leaf_voxels<V: Bits>(grid: &SparseGrid<V>) -> impl Iterator<Item = ([i32; 3], bool, V)> {
    let leaves = grid.leaves.iter().zip(&grid.masks).zip(grid.values.chunks_exact(512));
    leaves.flat_map(|((origin, mask), values)| {
        values.iter().enumerate().map(move |(offset, &value)| {
            let place = [offset >> 6, offset >> 3 & 7, offset & 7];
            let voxel = std::array::from_fn(|axis| origin[axis] + place[axis] as i32);
            (voxel, mask[offset >> 6] >> (offset & 63) & 1 == 1, value)
        })
    })
}

/// Sums over active leaf voxels, all leaf voxels, active tiles.
pub fn hashes<V: Bits>(grid: &SparseGrid<V>) -> [u64; 3] {
    let active = leaf_voxels(grid)
        .filter(|voxel| voxel.1)
        .map(|(voxel, _, value)| hash_at(voxel, value.bits()));
    let all = leaf_voxels(grid).map(|(voxel, _, value)| hash_at(voxel, value.bits()));
    let tiles =
        grid.tiles.iter().filter(|tile| tile.active).map(|tile| {
            mix(hash_at(tile.origin, tile.value.bits()).wrapping_add(u64::from(tile.dim)))
        });
    [sum(active), sum(all), sum(tiles)]
}
