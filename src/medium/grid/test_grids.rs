//! Grids for this module's tests.

use super::DensityGrid;
use crate::{math::DAffine3, medium::vdb::SparseGrid};

/// The grid of a field on the 8^3 leaves from `first` to `last` (in leaves, inclusive), all voxels active.
pub(super) fn of_field(
    first: [i32; 3],
    last: [i32; 3],
    field: impl Fn([i32; 3]) -> f32,
) -> DensityGrid {
    let mut sparse = SparseGrid {
        background: 0.0,
        index_to_world: DAffine3::IDENTITY,
        leaves: vec![],
        masks: vec![],
        values: vec![],
        tiles: vec![],
    };
    for x in first[0]..=last[0] {
        for y in first[1]..=last[1] {
            for z in first[2]..=last[2] {
                let origin = [8 * x, 8 * y, 8 * z];
                let values = (0..512_i32).map(|n| {
                    field([origin[0] + (n >> 6), origin[1] + (n >> 3 & 7), origin[2] + (n & 7)])
                });
                sparse.leaves.push(origin);
                sparse.masks.push([u64::MAX; 8]);
                sparse.values.extend(values);
            }
        }
    }
    DensityGrid::from_sparse(&sparse)
}

/// Steep noise in and around scattered balls, with empty and constant bricks between.
pub(super) fn clumps() -> DensityGrid {
    of_field([-3; 3], [2; 3], |[x, y, z]| {
        let wave = |c: i32, f: f32| (c as f32 * f).sin();
        let sum = wave(x, 0.31) + wave(y, 0.27) + wave(z, 0.23);
        let ripple = 1.0 + 0.5 * wave(x + 2 * y, 1.3) * wave(z - y, 0.9);
        if x > 8 { 1.0 } else { sum.max(0.0) * ripple }
    })
}
