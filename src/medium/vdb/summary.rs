//! What a file says of a grid before its values are read.

use std::collections::BTreeMap;

use super::block::Layout;
use super::cursor::Cursor;
use super::fault::Fault;
use super::metadata::MetadataValue;
use super::sparse::Tile;
use super::tree::{LEAF_LEN, Node, ROOT_DIM, TreeVisitor, count_ones, walk};
use super::value::{GridValue, ValueType};
use crate::math::DAffine3;

/// A box of voxels, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexBox {
    /// Lowest voxel.
    pub min: [i32; 3],
    /// Highest voxel.
    pub max: [i32; 3],
}

impl IndexBox {
    /// The cube of `dim` voxels along each edge.
    pub(super) fn cube(origin: [i32; 3], dim: i32) -> Self {
        Self { min: origin, max: origin.map(|along| along.saturating_add(dim - 1)) }
    }

    /// What both hold, if anything.
    pub(super) fn intersection(self, other: Self) -> Option<Self> {
        let min: [i32; 3] = std::array::from_fn(|axis| self.min[axis].max(other.min[axis]));
        let max: [i32; 3] = std::array::from_fn(|axis| self.max[axis].min(other.max[axis]));
        (0..3).all(|axis| min[axis] <= max[axis]).then_some(Self { min, max })
    }

    /// The smallest box around both.
    pub(super) fn union(self, other: Self) -> Self {
        Self {
            min: std::array::from_fn(|axis| self.min[axis].min(other.min[axis])),
            max: std::array::from_fn(|axis| self.max[axis].max(other.max[axis])),
        }
    }
}

/// What a file says of a grid before its values are read.
#[derive(Clone, Debug, PartialEq)]
pub struct GridSummary {
    /// Name, possibly empty, possibly that of other grids of the file too.
    pub name: String,
    /// Name that no other grid of the file has: `density[1]` for the second grid named so.
    pub unique_name: String,
    /// Type of a voxel as OpenVDB names it ("float", "double", "int32", "vec3s", "bool", ...), or
    /// "points".
    pub value_type: String,
    /// "fog volume", "level set", "staggered" or "unknown".
    pub class: String,
    /// Whether values are saved as 16-bit halves.
    pub half: bool,
    /// "none" or any of "zip", "blosc", "active values".
    pub compression: String,
    /// OpenVDB's name of the transform's kind.
    pub map: String,
    /// Index to world \[world units per voxel\], when there is one that is affine and can be
    /// inverted.
    pub index_to_world: Option<DAffine3>,
    /// Value outside the tree, of a grid of numbers.
    pub background: Option<f64>,
    /// Bounds of the active voxels and tiles; none when there are none, or when they are not known.
    pub active_bbox: Option<IndexBox>,
    /// Active voxels, those in tiles included.
    pub active_voxel_count: u64,
    /// Active tiles.
    pub active_tile_count: u64,
    /// Leaves of 8^3 voxels.
    pub leaf_count: u64,
    /// Memory of the grid when loaded \[bytes\]; inactive tiles come on top, where there are any.
    pub memory_bytes: u64,
    /// Further metadata by name, up to 64 KiB of it.
    pub metadata: BTreeMap<String, MetadataValue>,
    /// Why the grid cannot be loaded, and what to do, when it cannot.
    pub unusable: Option<String>,
}

impl GridSummary {
    /// Whether the grid holds one number a voxel and can be loaded with
    /// [`load_scalar`](super::VolumeSource::load_scalar).
    pub fn is_usable_scalar(&self) -> bool {
        const SCALARS: [&str; 4] = ["float", "double", "int32", "int64"];
        self.unusable.is_none() && SCALARS.contains(&self.value_type.as_str())
    }

    /// Whether the grid holds distances to a surface.
    pub fn is_level_set(&self) -> bool {
        self.class == "level set"
    }
}

/// Counts of a tree's nodes and voxels.
#[derive(Clone, Debug, Default)]
pub(super) struct Census {
    /// Bytes of the background value.
    background: Vec<u8>,
    pub active_voxel_count: u64,
    pub active_tile_count: u64,
    pub bbox: Option<IndexBox>,
    /// Active voxels of each leaf.
    pub leaf_active_counts: Vec<u16>,
}

impl Census {
    /// Counts the tree at the cursor and leaves the cursor behind its topology.
    pub(super) fn take(cursor: &mut Cursor<'_>, layout: &Layout) -> Result<Self, Fault> {
        let mut census = Self::default();
        walk(cursor, layout, &mut census)?;
        Ok(census)
    }

    /// Number of leaves.
    pub(super) fn leaf_count(&self) -> u64 {
        self.leaf_active_counts.len() as u64
    }

    /// The background of a grid of numbers.
    pub(super) fn background(&self, value_type: ValueType) -> Option<f64> {
        let bytes = self.background.as_slice();
        match value_type {
            ValueType::Float => Some(f32::from_bytes(bytes).into()),
            ValueType::Double => Some(f64::from_bytes(bytes)),
            ValueType::Int32 => Some(i32::from_bytes(bytes).into()),
            ValueType::Int64 => Some(i64::from_bytes(bytes) as f64),
            _ => None,
        }
    }

    fn extend(&mut self, bbox: IndexBox) {
        self.bbox = Some(self.bbox.map_or(bbox, |before| before.union(bbox)));
    }

    fn count_tile(&mut self, origin: [i32; 3], dim: i32) {
        let volume = u64::from(dim.unsigned_abs()).pow(3);
        self.active_tile_count += 1;
        self.active_voxel_count = self.active_voxel_count.saturating_add(volume);
        self.extend(IndexBox::cube(origin, dim));
    }
}

impl TreeVisitor for Census {
    fn background(&mut self, value: &[u8]) -> Result<(), Fault> {
        self.background = value.to_vec();
        Ok(())
    }

    fn root_tile(&mut self, origin: [i32; 3], _value: &[u8], active: bool) -> Result<(), Fault> {
        if active {
            self.count_tile(origin, ROOT_DIM);
        }
        Ok(())
    }

    fn node(&mut self, node: &Node<'_>) -> Result<(), Fault> {
        for offset in node.active_tiles() {
            self.count_tile(node.child_origin(offset), node.level.child_dim);
        }
        Ok(())
    }

    fn leaf(&mut self, origin: [i32; 3], mask: [u64; 8]) -> Result<(), Fault> {
        let active_count = count_ones(&mask);
        self.leaf_active_counts.push(active_count as u16);
        self.active_voxel_count = self.active_voxel_count.saturating_add(active_count as u64);
        if let Some(bbox) = active_bounds(origin, &mask) {
            self.extend(bbox);
        }
        Ok(())
    }
}

/// Bounds of a leaf's active voxels. A word of the mask is a slice of constant x, a byte of it a
/// row of z.
pub(super) fn active_bounds(origin: [i32; 3], mask: &[u64; 8]) -> Option<IndexBox> {
    let x_min = mask.iter().position(|&slice| slice != 0)?;
    let x_max = mask.iter().rposition(|&slice| slice != 0)?;
    let yz = mask.iter().fold(0, |all, slice| all | slice);
    let z = yz.to_le_bytes().iter().fold(0, |all, row| all | row);
    let min = [x_min as i32, yz.trailing_zeros() as i32 / 8, z.trailing_zeros() as i32];
    let max = [x_max as i32, 7 - yz.leading_zeros() as i32 / 8, 7 - z.leading_zeros() as i32];
    Some(IndexBox {
        min: std::array::from_fn(|axis| origin[axis] + min[axis]),
        max: std::array::from_fn(|axis| origin[axis] + max[axis]),
    })
}

/// Memory of a loaded grid whose values take `value_size` bytes.
pub(super) fn memory_bytes(leaf_count: u64, tile_count: u64, value_size: usize) -> u64 {
    let leaf_bytes = LEAF_LEN * value_size + size_of::<[u64; 8]>() + size_of::<[i32; 3]>();
    // The origin, the edge and the flag of a tile take what those of a tile of bytes take.
    let tile_bytes = size_of::<Tile<u32>>() + value_size;
    let leaves = leaf_count.saturating_mul(leaf_bytes as u64);
    leaves.saturating_add(tile_count.saturating_mul(tile_bytes as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_of_a_leaf_are_those_of_its_voxels() {
        let mut mask = [0; 8];
        assert_eq!(active_bounds([0; 3], &mask), None);
        for [x, y, z] in [[2, 5, 1], [6, 3, 4]] {
            mask[x] |= 1u64 << (8 * y + z);
        }
        let bbox = active_bounds([-8, 0, 16], &mask).unwrap();
        assert_eq!(bbox.min, [-6, 3, 17]);
        assert_eq!(bbox.max, [-2, 5, 20]);
    }
}
