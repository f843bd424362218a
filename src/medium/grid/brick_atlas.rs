//! The values of all bricks, each with a one-voxel apron, so that one brick serves every lookup in it.
//!
//! A brick covers 8^3 cells. The cell at b needs the voxels b and b+1, so a brick stores 9^3 voxels, the
//! last layer being the first one of its upper neighbours.

use super::trilinear::Corners;

/// Cells along a brick's edge.
pub(super) const BRICK_EDGE: usize = 8;
/// Voxels along a brick's edge.
const VOXEL_EDGE: usize = BRICK_EDGE + 1;
const STRIDE_X: usize = VOXEL_EDGE * VOXEL_EDGE;
const STRIDE_Y: usize = VOXEL_EDGE;
/// Voxels a brick.
pub(super) const BRICK_VOXELS: usize = VOXEL_EDGE * VOXEL_EDGE * VOXEL_EDGE;
/// From a cell's first corner to its last, inclusive.
const CORNER_REACH: usize = STRIDE_X + STRIDE_Y + 2;

/// A blend of values can exceed their largest by rounding; no more than this factor.
pub(super) const MAJORANT_MARGIN: f64 = 1.0 + 1e-5;

/// Values and largest value of each brick.
#[derive(Debug, Default)]
pub(super) struct BrickAtlas {
    /// 9^3 values a brick; voxel (x, y, z) is number 81x + 9y + z.
    values: Vec<f32>,
    /// Largest value of each brick.
    maxima: Vec<f32>,
}

impl BrickAtlas {
    /// An atlas of bricks given by their values, `BRICK_VOXELS` each, and their largest values.
    pub(super) fn new(values: Vec<f32>, maxima: Vec<f32>) -> Self {
        Self { values, maxima }
    }

    /// The largest value of any brick, 0 if there is none.
    pub(super) fn max(&self) -> f32 {
        self.maxima.iter().copied().fold(0.0, f32::max)
    }

    /// An upper bound of the density in the brick.
    #[inline]
    pub(super) fn majorant(&self, brick: usize) -> f64 {
        f64::from(self.maxima[brick]) * MAJORANT_MARGIN
    }

    /// The corners of cell (x, y, z), each in 0..8, of the brick.
    #[inline(always)]
    pub(super) fn corners(&self, brick: usize, [x, y, z]: [usize; 3]) -> Corners {
        let first = brick * BRICK_VOXELS + x * STRIDE_X + y * STRIDE_Y + z;
        let v = &self.values[first..first + CORNER_REACH];
        [
            v[0].into(),
            v[1].into(),
            v[STRIDE_Y].into(),
            v[STRIDE_Y + 1].into(),
            v[STRIDE_X].into(),
            v[STRIDE_X + 1].into(),
            v[STRIDE_X + STRIDE_Y].into(),
            v[STRIDE_X + STRIDE_Y + 1].into(),
        ]
    }

    /// Number of bricks.
    pub(super) fn len(&self) -> usize {
        self.maxima.len()
    }

    /// Memory held \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        (self.values.capacity() + self.maxima.capacity()) * size_of::<f32>()
    }
}
