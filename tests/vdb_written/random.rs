//! Random sparse grids: leaves and tiles anywhere, of ordinary and extraordinary values.

use photonvdb::math::{DAffine3, DMat3, DVec3};
use photonvdb::medium::vdb::{SparseGrid, Tile};
use proptest::prelude::*;
use proptest::sample::select;

use super::compare::Value;

/// Numbers of every kind, any bits at all among them.
pub fn numbers() -> impl Strategy<Value = f32> + Clone {
    const SPECIAL: [f32; 9] =
        [0.0, -0.0, 1.0, -1.0, f32::NAN, f32::INFINITY, -f32::INFINITY, 1e-40, 65_520.0];
    prop_oneof![3 => select(&SPECIAL[..]), 2 => -2f32..2.0, 1 => any::<u32>().prop_map(f32::from_bits)]
}

/// A grid with the values of the strategy.
pub fn grids<V: Value>(
    values: impl Strategy<Value = V> + Clone,
) -> impl Strategy<Value = SparseGrid<V>> {
    let pieces = prop::collection::vec(pieces(values.clone()), 0..12);
    (values, transforms(), pieces).prop_map(|(background, index_to_world, pieces)| {
        let mut grid = SparseGrid {
            background,
            index_to_world,
            leaves: Vec::new(),
            masks: Vec::new(),
            values: Vec::new(),
            tiles: Vec::new(),
        };
        let mut taken: Vec<([i32; 3], i32)> = Vec::new();
        for piece in pieces {
            if !taken.iter().any(|&(origin, dim)| overlap(origin, dim, piece.origin, piece.dim)) {
                taken.push((piece.origin, piece.dim));
                piece.add_to(&mut grid);
            }
        }
        grid
    })
}

/// A leaf or a tile.
#[derive(Clone, Debug)]
struct Piece<V> {
    origin: [i32; 3],
    dim: i32,
    is_leaf: bool,
    active: bool,
    mask: [u64; 8],
    /// Values of a leaf take turns; the first is that of a tile.
    palette: Vec<V>,
    /// Which values the voxels of a leaf have; where it falls short, the background.
    choice: Vec<usize>,
}

impl<V: Value> Piece<V> {
    fn add_to(self, grid: &mut SparseGrid<V>) {
        if !self.is_leaf {
            let (origin, dim, active) = (self.origin, self.dim as u32, self.active);
            return grid.tiles.push(Tile { origin, dim, value: self.palette[0], active });
        }
        let palette: Vec<V> = self.palette.into_iter().chain([grid.background]).collect();
        let values = (0..512).map(|offset| {
            let choice = self.choice[offset % self.choice.len()];
            palette[choice % palette.len()]
        });
        grid.values.extend(values);
        grid.leaves.push(self.origin);
        grid.masks.push(self.mask);
    }
}

fn pieces<V: Value>(values: impl Strategy<Value = V>) -> impl Strategy<Value = Piece<V>> {
    let words = prop_oneof![Just(0), Just(u64::MAX), any::<u64>()];
    let masks = prop_oneof![Just([0; 8]), Just([u64::MAX; 8]), prop::array::uniform8(words)];
    let kinds =
        select(&[(8, true), (8, true), (8, true), (8, false), (128, false), (4096, false)][..]);
    let palettes = prop::collection::vec(values, 1..5);
    let choices = prop::collection::vec(0..8usize, 1..40);
    (places(), kinds, any::<bool>(), masks, palettes, choices).prop_map(
        |(place, (dim, is_leaf), active, mask, palette, choice)| {
            let origin = place.map(|along| along & !(dim - 1));
            Piece { origin, dim, is_leaf, active, mask, palette, choice }
        },
    )
}

/// Voxels near the origin, and at the ends of what OpenVDB uses and of what there is.
fn places() -> impl Strategy<Value = [i32; 3]> {
    let ends = select(&[1 << 30, -(1 << 30), i32::MIN, i32::MAX - 5000][..]);
    let along = || prop_oneof![6 => -300..300i32, 1 => -9000..9000i32];
    let far = (ends, along()).prop_map(|(end, along)| end.saturating_add(along));
    prop_oneof![
        9 => prop::array::uniform3(along()),
        1 => (far, along(), along()).prop_map(|(x, y, z)| [x, y, z]),
    ]
}

fn transforms() -> impl Strategy<Value = DAffine3> {
    let lengths = || prop_oneof![Just(1.0), Just(0.1), 1e-6..1e6f64];
    let shifts = prop_oneof![Just([0.0; 3]), prop::array::uniform3(-1e6..1e6f64)];
    let axes = prop_oneof![
        lengths().prop_map(|length| DMat3::from_diagonal(DVec3::splat(length))),
        prop::array::uniform3(lengths()).prop_map(|scale| DMat3::from_diagonal(
            DVec3::from_array(scale) * DVec3::new(1.0, -1.0, 1.0)
        )),
        (lengths(), 0.1..6.0f64).prop_map(|(length, angle)| DMat3::from_rotation_y(angle) * length),
    ];
    (axes, shifts).prop_map(|(matrix3, shift)| DAffine3 { matrix3, translation: shift.into() })
}

fn overlap(one: [i32; 3], one_dim: i32, other: [i32; 3], other_dim: i32) -> bool {
    (0..3).all(|axis| {
        let [one, other] = [i64::from(one[axis]), i64::from(other[axis])];
        one < other + i64::from(other_dim) && other < one + i64::from(one_dim)
    })
}
