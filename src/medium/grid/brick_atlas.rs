//! The values of all bricks, each with a one-voxel apron, so that one brick serves every lookup in it.
//!
//! A brick covers 8^3 cells. The cell at b needs the voxels b and b+1, so a brick stores 9^3 voxels, the
//! last layer being the first one of its upper neighbours.

use rayon::prelude::*;

use super::{
    budget::{Budget, DensityGridError},
    half_scale::HalfScale,
    trilinear::Corners,
    voxel_source::{Voxels, raise},
};
use crate::medium::pages::Pages;

/// Cells along a brick's edge.
pub(super) const BRICK_EDGE: usize = 8;
/// Voxels along a brick's edge.
const VOXEL_EDGE: usize = BRICK_EDGE + 1;
const STRIDE_X: usize = VOXEL_EDGE * VOXEL_EDGE;
const STRIDE_Y: usize = VOXEL_EDGE;
/// Voxels a brick.
const BRICK_VOXELS: usize = VOXEL_EDGE * VOXEL_EDGE * VOXEL_EDGE;
/// From a cell's first corner to its last, inclusive.
const CORNER_REACH: usize = STRIDE_X + STRIDE_Y + 2;

/// A blend of values can exceed their largest by rounding; no more than this factor.
pub(super) const MAJORANT_MARGIN: f64 = 1.0 + 1e-5;

/// Bricks a thread fills at once.
const BRICKS_A_TASK: usize = 32;

/// How exactly the values of bricks are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BrickPrecision {
    /// As they are: 32 bits a value.
    #[default]
    Single,
    /// Rounded to the nearest of 16 bits: half the memory.
    ///
    /// Values are scaled by a power of two, the same for the whole grid, that brings the largest between 2^14
    /// and 2^15: none is too large. A value keeps 11 significant bits (a relative error of at most 2^-11) down to
    /// 2^-28 of the largest; what is smaller has an absolute error of at most 2^-39 of the largest. Uniform
    /// blocks, which are not stored as bricks, stay exact.
    Half,
}

/// Values and largest value of each brick.
#[derive(Debug)]
pub(super) struct BrickAtlas {
    /// 9^3 values a brick; voxel (x, y, z) is number 81x + 9y + z.
    values: Pages,
    encoding: Encoding,
    /// Largest value of each brick, as it is stored.
    maxima: Vec<f32>,
}

/// What the bytes of a value mean.
#[derive(Debug)]
enum Encoding {
    Single,
    Half(HalfScale),
}

const SINGLE_BYTES: usize = size_of::<f32>();
const HALF_BYTES: usize = size_of::<u16>();

impl BrickAtlas {
    /// Copies the values of `count` bricks, each given with its seven upper neighbours. `max_value` returns the
    /// largest value of any.
    pub(super) fn new<'a>(
        count: usize,
        voxels_of: impl Fn(usize) -> [Voxels<'a>; 8] + Sync,
        precision: BrickPrecision,
        max_value: impl Fn() -> f32,
        budget: &mut Budget,
    ) -> Result<Self, DensityGridError> {
        let mut maxima = budget.vector(count)?;
        maxima.resize(count, 0.0);
        let (encoding, value_bytes) = match precision {
            BrickPrecision::Single => (Encoding::Single, SINGLE_BYTES),
            BrickPrecision::Half => (Encoding::Half(HalfScale::new(max_value())), HALF_BYTES),
        };
        let brick_bytes = BRICK_VOXELS * value_bytes;
        let mut values = budget.pages(count.saturating_mul(brick_bytes))?;
        values
            .par_chunks_exact_mut(brick_bytes)
            .zip(&mut maxima)
            .enumerate()
            .with_min_len(BRICKS_A_TASK)
            .for_each(|(brick, (bytes, max))| {
                let mut values = [0.0; BRICK_VOXELS];
                let largest = gather(&voxels_of(brick), &mut values);
                *max = match &encoding {
                    Encoding::Single => {
                        store(bytes, values.map(f32::to_ne_bytes));
                        largest
                    }
                    Encoding::Half(scale) => {
                        store(bytes, scale.encode(&values).map(u16::to_ne_bytes));
                        scale.rounded(largest)
                    }
                };
            });
        Ok(Self { values, encoding, maxima })
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
    pub(super) fn corners(&self, brick: usize, place: [usize; 3]) -> Corners {
        match self.brick(brick) {
            Brick::Single(values) => single_corners(values, place),
            Brick::Half(values, scale) => half_corners(values, place, scale),
        }
    }

    /// The values of a brick.
    #[inline(always)]
    pub(super) fn brick(&self, brick: usize) -> Brick<'_> {
        match &self.encoding {
            Encoding::Single => Brick::Single(brick_values(&self.values, brick)),
            Encoding::Half(scale) => Brick::Half(brick_values(&self.values, brick), scale),
        }
    }

    /// Number of bricks.
    pub(super) fn len(&self) -> usize {
        self.maxima.len()
    }

    /// Memory held \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        self.values.len() + self.maxima.capacity() * size_of::<f32>()
    }
}

/// Puts a brick's encoded values in its place.
#[inline(always)]
fn store<const N: usize>(place: &mut [u8], values: [[u8; N]; BRICK_VOXELS]) {
    place.copy_from_slice(values.as_flattened());
}

/// The values of one brick, encoded. Walks through a brick tell its encoding once, not at every cell.
pub(super) enum Brick<'a> {
    Single(&'a SingleValues),
    Half(&'a HalfValues, &'a HalfScale),
}

/// The bytes of a brick's values in either encoding.
pub(super) type SingleValues = [[u8; SINGLE_BYTES]; BRICK_VOXELS];
pub(super) type HalfValues = [[u8; HALF_BYTES]; BRICK_VOXELS];

#[inline(always)]
fn brick_values<const N: usize>(bytes: &[u8], brick: usize) -> &[[u8; N]; BRICK_VOXELS] {
    &bytes.as_chunks::<N>().0.as_chunks::<BRICK_VOXELS>().0[brick]
}

/// The corners of a cell of a brick of single values.
#[inline(always)]
pub(super) fn single_corners(values: &SingleValues, place: [usize; 3]) -> Corners {
    corners(values, place, |bytes| f32::from_ne_bytes(bytes).into())
}

/// The corners of a cell of a brick of halves. Apart, so that lookups in single bricks have the registers to
/// themselves.
#[inline(never)]
pub(super) fn half_corners(values: &HalfValues, place: [usize; 3], scale: &HalfScale) -> Corners {
    corners(values, place, |bytes| scale.decode(u16::from_ne_bytes(bytes)))
}

#[inline(always)]
fn corners<const N: usize>(
    values: &[[u8; N]; BRICK_VOXELS],
    [x, y, z]: [usize; 3],
    decode: impl Fn([u8; N]) -> f64,
) -> Corners {
    let first = x * STRIDE_X + y * STRIDE_Y + z;
    let v = &values[first..first + CORNER_REACH];
    [
        decode(v[0]),
        decode(v[1]),
        decode(v[STRIDE_Y]),
        decode(v[STRIDE_Y + 1]),
        decode(v[STRIDE_X]),
        decode(v[STRIDE_X + 1]),
        decode(v[STRIDE_X + STRIDE_Y]),
        decode(v[STRIDE_X + STRIDE_Y + 1]),
    ]
}

/// Copies a brick's 9^3 voxels from it and its seven upper neighbours, a row at a time. Returns the largest.
#[inline(always)]
fn gather(voxels: &[Voxels; 8], values: &mut [f32; BRICK_VOXELS]) -> f32 {
    let mut lanes = [0.0; 8];
    let mut last = 0.0_f32;
    let (rows, _) = values.as_chunks_mut::<VOXEL_EDGE>();
    for (number, row) in rows.iter_mut().enumerate() {
        let (x, y) = (number / VOXEL_EDGE, number % VOXEL_EDGE);
        let (voxels, upper) = row_voxels(voxels, x, y);
        let (x, y) = (x % BRICK_EDGE, y % BRICK_EDGE);
        let (body, apron) = (voxels.row(x, y), upper.first_of_row(x, y));
        row[..BRICK_EDGE].copy_from_slice(&body);
        row[BRICK_EDGE] = apron;
        raise(&mut lanes, &body);
        last = last.max(apron);
    }
    lanes.into_iter().fold(last, f32::max)
}

/// The value that all of a brick's 9^3 voxels have, if they have.
pub(super) fn is_uniform(voxels: &[Voxels; 8]) -> Option<f32> {
    let first = voxels[0].first_of_row(0, 0);
    let is_row_uniform = |number: usize| {
        let (x, y) = (number / VOXEL_EDGE, number % VOXEL_EDGE);
        let (voxels, upper) = row_voxels(voxels, x, y);
        let (x, y) = (x % BRICK_EDGE, y % BRICK_EDGE);
        voxels.row(x, y).iter().all(|&value| value == first) && upper.first_of_row(x, y) == first
    };
    (0..VOXEL_EDGE * VOXEL_EDGE).all(is_row_uniform).then_some(first)
}

/// What holds the row of voxels at (x, y), and what holds its end.
#[inline(always)]
fn row_voxels<'a>(voxels: &[Voxels<'a>; 8], x: usize, y: usize) -> (Voxels<'a>, Voxels<'a>) {
    let neighbour = (x / BRICK_EDGE) << 2 | (y / BRICK_EDGE) << 1;
    (voxels[neighbour], voxels[neighbour | 1])
}
