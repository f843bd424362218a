//! The voxels that bear light: those that are active in a grid of densities, each with a value of its own.

use std::f64::consts::PI;

use crate::math::{DAffine3, DMat3, DVec3};
use crate::medium::vdb::{Limits, SparseGrid, Tile};
use crate::medium::{Bounds, Medium, Parallelepiped};
use crate::render::RenderError;

/// Voxels of a leaf.
pub const LEAF_LEN: usize = 512;

/// Edge of a leaf \[voxels\].
const LEAF_DIM: i32 = 8;

/// Bytes a leaf takes: fluence, emission, and where its voxels are.
const LEAF_BYTES: u64 = (2 * LEAF_LEN * size_of::<[f32; 3]>() + 3 * 76) as u64;

/// A voxel.
#[derive(Clone, Copy, Debug)]
pub struct Voxel {
    /// In its leaf: (x << 6) | (y << 3) | z.
    pub offset: usize,
    /// Among all voxels of all leaves.
    pub number: u64,
    /// Its middle in world space \[m\].
    pub middle: DVec3,
}

/// Leaves of voxels, of which some are active.
#[derive(Debug)]
pub struct Voxels {
    index_to_world: DAffine3,
    leaves: Vec<[i32; 3]>,
    masks: Vec<[u64; 8]>,
}

impl Voxels {
    /// The active voxels of a grid. Active tiles become leaves, as light varies in them.
    ///
    /// # Errors
    /// [`RenderError::TooManyVoxels`].
    pub fn of(densities: &SparseGrid<f32>, limits: &Limits) -> Result<Self, RenderError> {
        let active = || densities.tiles.iter().filter(|tile| tile.active);
        let of_tile = |tile: &Tile<f32>| u64::from(tile.dim / 8).saturating_pow(3);
        let of_tiles = active().map(of_tile).fold(0, u64::saturating_add);
        let leaf_count = of_tiles.saturating_add(densities.leaves.len() as u64);
        check(leaf_count, LEAF_BYTES, limits)?;
        let mut voxels = Self {
            index_to_world: densities.index_to_world,
            leaves: densities.leaves.clone(),
            masks: densities.masks.clone(),
        };
        for tile in active() {
            let steps = || (0..tile.dim as i32).step_by(LEAF_DIM as usize);
            let [i, j, k] = tile.origin;
            for x in steps() {
                for y in steps() {
                    voxels.leaves.extend(steps().map(|z| [i + x, j + y, k + z]));
                }
            }
        }
        voxels.masks.resize(voxels.leaves.len(), [u64::MAX; 8]);
        Ok(voxels)
    }

    /// The active voxels of leaf number `leaf`.
    pub fn active_of(&self, leaf: usize) -> impl Iterator<Item = Voxel> {
        let origin = DVec3::from_array(self.leaves[leaf].map(f64::from));
        let mask = self.masks[leaf];
        let is_active = move |offset: &usize| mask[offset >> 6] >> (offset & 63) & 1 == 1;
        (0..LEAF_LEN).filter(is_active).map(move |offset| {
            let [x, y, z] = [offset >> 6, offset >> 3 & 7, offset & 7].map(|step| step as f64);
            let middle = self.index_to_world.transform_point3(origin + DVec3::new(x, y, z));
            Voxel { offset, number: (leaf * LEAF_LEN + offset) as u64, middle }
        })
    }

    /// How many are active.
    pub fn active_count(&self) -> u64 {
        self.masks.iter().flatten().map(|word| u64::from(word.count_ones())).sum()
    }

    /// Nothing in every voxel of every leaf.
    pub fn zeros(&self) -> Vec<[f32; 3]> {
        vec![[0.0; 3]; self.leaves.len() * LEAF_LEN]
    }

    /// Volume of a voxel \[m^3\].
    pub fn voxel_volume(&self) -> f64 {
        self.index_to_world.matrix3.determinant().abs()
    }

    /// Radius of a ball of that volume \[m\].
    pub fn ball_radius(&self) -> f64 {
        (0.75 / PI * self.voxel_volume()).cbrt()
    }

    /// The grid of `values`, 0 beyond.
    pub fn grid(&self, values: Vec<[f32; 3]>) -> SparseGrid<[f32; 3]> {
        SparseGrid {
            background: [0.0; 3],
            index_to_world: self.index_to_world,
            leaves: self.leaves.clone(),
            masks: self.masks.clone(),
            values,
            tiles: Vec::new(),
        }
    }
}

fn check(leaf_count: u64, leaf_bytes: u64, limits: &Limits) -> Result<(), RenderError> {
    if leaf_count.saturating_mul(leaf_bytes) <= limits.max_bytes {
        return Ok(());
    }
    let voxels = leaf_count.saturating_mul(LEAF_LEN as u64);
    Err(RenderError::TooManyVoxels { voxels, limit_mib: limits.max_bytes >> 20 })
}

/// Densities of a homogeneous medium: a grid over its bounds of `resolution` voxels along their longest side and about as long ones along
/// the others, of which those are active whose middle is inside. Each has the medium's sigma_t \[1/m\], of coloured extinction the mean
/// of the channels.
///
/// # Errors
/// An infinite medium, or more voxels than memory allows.
pub fn even_densities(
    medium: &Medium,
    resolution: usize,
    limits: &Limits,
) -> Result<SparseGrid<f32>, RenderError> {
    let shape = match medium.bounds {
        Bounds::Sphere { center, radius } => {
            let edges = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * (2.0 * radius));
            Some(Parallelepiped::new(center - DVec3::splat(radius), edges))
        }
        _ => medium.bounds.parallelepiped(),
    };
    let shape = shape.ok_or(RenderError::InfiniteMedium)?;
    let lengths = shape.edges().map(DVec3::length);
    let longest = lengths.into_iter().fold(0.0, f64::max);
    let counts = lengths.map(|length| (resolution as f64 * length / longest).round().max(1.0));
    let of_leaves = counts.map(|count| (count / f64::from(LEAF_DIM)).ceil());
    let densities = (LEAF_LEN * size_of::<f32>()) as u64;
    check(of_leaves.iter().product::<f64>() as u64, LEAF_BYTES + densities, limits)?;

    let edges: [DVec3; 3] = std::array::from_fn(|axis| shape.edges()[axis] / counts[axis]);
    let [a, b, c] = edges;
    let first = shape.corner() + 0.5 * (a + b + c);
    let index_to_world = DAffine3 { matrix3: DMat3::from_cols(a, b, c), translation: first };
    let sigma_t = crate::math::mean_channel(medium.extinction.sigma_t(first)) as f32;
    let mut grid = SparseGrid {
        background: 0.0,
        index_to_world,
        leaves: Vec::new(),
        masks: Vec::new(),
        values: Vec::new(),
        tiles: Vec::new(),
    };
    let is_round = matches!(medium.bounds, Bounds::Sphere { .. });
    let counts = counts.map(|count| count as i32);
    let origins = |axis: usize| (0..counts[axis]).step_by(LEAF_DIM as usize);
    for i in origins(0) {
        for j in origins(1) {
            for k in origins(2) {
                let mut mask = [0u64; 8];
                for offset in 0..LEAF_LEN {
                    let step = [offset >> 6, offset >> 3 & 7, offset & 7].map(|step| step as i32);
                    let index = [i + step[0], j + step[1], k + step[2]];
                    let is_within = (0..3).all(|axis| index[axis] < counts[axis]);
                    let middle = DVec3::from_array(index.map(f64::from));
                    let middle = index_to_world.transform_point3(middle);
                    if is_within && (!is_round || medium.bounds.contains(middle)) {
                        mask[offset >> 6] |= 1 << (offset & 63);
                    }
                }
                if mask == [0; 8] {
                    continue;
                }
                let value = |offset: usize| match mask[offset >> 6] >> (offset & 63) & 1 {
                    1 => sigma_t,
                    _ => 0.0,
                };
                grid.leaves.push([i, j, k]);
                grid.masks.push(mask);
                grid.values.extend((0..LEAF_LEN).map(value));
            }
        }
    }
    Ok(grid)
}
