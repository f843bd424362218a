//! Grids compared bit for bit.

use half::f16;
use photonvdb::medium::vdb::{
    Limits, SparseGrid, VdbFile, VolumeSource, WriteCompression, WriteOptions,
};

/// Every way of storing.
pub const EVERY_OPTION: [WriteOptions; 8] = {
    use WriteCompression::{ActiveMask, Blosc, None, Zip};
    let kinds = [None, ActiveMask, Zip, Blosc];
    let mut options = [WriteOptions { compression: None, half: false }; 8];
    let mut index = 0;
    while index < 8 {
        options[index] = WriteOptions { compression: kinds[index / 2], half: index % 2 == 1 };
        index += 1;
    }
    options
};

/// A type of voxel that is written.
pub trait Value: Copy + Default + std::fmt::Debug {
    /// Its bits.
    fn bits(self) -> [u32; 3];
    /// As half precision leaves it.
    fn rounded(self) -> Self;
    fn load(file: &VdbFile, index: usize) -> SparseGrid<Self>;
}

impl Value for f32 {
    fn bits(self) -> [u32; 3] {
        [self.to_bits(), 0, 0]
    }
    fn rounded(self) -> Self {
        f16::from_f32(self).to_f32()
    }
    fn load(file: &VdbFile, index: usize) -> SparseGrid<Self> {
        file.load_scalar(index, &Limits::default()).unwrap()
    }
}

impl Value for [f32; 3] {
    fn bits(self) -> [u32; 3] {
        self.map(f32::to_bits)
    }
    fn rounded(self) -> Self {
        self.map(Value::rounded)
    }
    fn load(file: &VdbFile, index: usize) -> SparseGrid<Self> {
        file.load_vector(index, &Limits::default()).unwrap()
    }
}

/// What is to be read of a grid that was written: rounded, for `half`, but for tiles of the root.
pub fn expected<V: Value>(grid: &SparseGrid<V>, half: bool) -> SparseGrid<V> {
    let mut grid = grid.clone();
    if half {
        grid.background = grid.background.rounded();
        grid.values.iter_mut().for_each(|value| *value = value.rounded());
        let small = grid.tiles.iter_mut().filter(|tile| tile.dim < 4096);
        small.for_each(|tile| tile.value = tile.value.rounded());
    }
    grid
}

/// Compares leaves, whatever their order, with all their values; and tiles that are active or differ
/// from the background.
pub fn check_same<V: Value>(expected: &SparseGrid<V>, read: &SparseGrid<V>) {
    assert_eq!(expected.background.bits(), read.background.bits(), "background");
    let [expected_leaves, read_leaves] = [sorted_leaves(expected), sorted_leaves(read)];
    assert_eq!(expected_leaves.len(), read_leaves.len(), "number of leaves");
    for (expected, read) in expected_leaves.iter().zip(&read_leaves) {
        assert_eq!(expected, read, "a leaf");
    }
    assert_eq!(sorted_tiles(expected), sorted_tiles(read), "tiles");
}

/// Origin, mask and bits of the values of each leaf.
type Leaf = ([i32; 3], [u64; 8], Vec<[u32; 3]>);

fn sorted_leaves<V: Value>(grid: &SparseGrid<V>) -> Vec<Leaf> {
    let bits = grid.values.chunks(512).map(|values| values.iter().map(|v| v.bits()).collect());
    let leaves = grid.leaves.iter().zip(&grid.masks).zip(bits);
    let mut leaves: Vec<Leaf> =
        leaves.map(|((origin, mask), bits)| (*origin, *mask, bits)).collect();
    leaves.sort();
    leaves
}

fn sorted_tiles<V: Value>(grid: &SparseGrid<V>) -> Vec<([i32; 3], u32, bool, [u32; 3])> {
    let told = grid.tiles.iter().filter(|tile| tile.active || !is_background(tile.value, grid));
    let mut tiles: Vec<_> =
        told.map(|tile| (tile.origin, tile.dim, tile.active, tile.value.bits())).collect();
    tiles.sort();
    tiles
}

/// Zeros of either sign are one value here, and every NaN is: a reader leaves out inactive tiles of
/// background.
fn is_background<V: Value>(value: V, grid: &SparseGrid<V>) -> bool {
    let number = |bits: u32| f32::from_bits(bits);
    value.bits().iter().zip(grid.background.bits()).all(|(&one, other)| {
        number(one) == number(other) || (number(one).is_nan() && number(other).is_nan())
    })
}
