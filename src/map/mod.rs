//! The photon map: a k-d tree over photon positions, and what estimates need of each photon.
//!
//! Photons are sorted along a Morton curve first, so that neighbours in space are neighbours in memory; the
//! tree is kiddo's immutable one, in the configuration that measured best for coherent queries (flat leaves
//! of 32, Eytzinger stems). A photon takes 40 bytes, and 4 more for its direction, sigma_t or order each where
//! the scene needs them.

mod morton;
mod nearest;
mod packed;

pub use morton::morton_code;
pub use nearest::{Nearest, NearestPhotons, Neighbor, RADIUS_FLOOR};
pub use packed::PackedDirection;

use glam::Vec3;
use kiddo::leaf_strategies::FlatVec;
use kiddo::{Eytzinger, KdTree};
use rayon::prelude::*;

use crate::math::DVec3;
use crate::trace::{MapFrame, Photon};

/// `f32` coordinates, `u32` ids, three dimensions, leaves of 32.
type PhotonTree = KdTree<f32, u32, Eytzinger, FlatVec<f32, u32, 3, 32>, 3, 32>;

/// What to keep of each photon besides position and power.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// The direction of travel: needed unless scattering is isotropic.
    pub direction: bool,
    /// sigma_t at the photon: needed unless it is the same everywhere.
    pub sigma_t: bool,
    /// The scattering order: needed where one map holds single and multiple scattering.
    pub order: bool,
}

/// Photons in space.
#[derive(Debug)]
pub struct PhotonMap {
    tree: PhotonTree,
    frame: MapFrame,
    position: Vec<[f32; 3]>,
    power: Vec<[f32; 3]>,
    direction: Vec<PackedDirection>,
    sigma_t: Vec<f32>,
    order: Vec<u32>,
}

/// Why a photon map could not be built.
#[derive(Debug, thiserror::Error)]
pub enum MapError {
    /// The tree refused the photons.
    #[error(
        "the photon map of {count} photons could not be built ({cause}): use fewer photons a pass"
    )]
    Tree {
        /// Photons to be stored.
        count: usize,
        /// The tree's own words.
        cause: String,
    },
}

impl PhotonMap {
    /// Builds the map. Photons whose place or power is not finite are left out.
    pub fn build(photons: &[Photon], frame: MapFrame, columns: Columns) -> Result<Self, MapError> {
        let order = morton::sorted_indices(photons);
        let gather = |index: &u32| photons[*index as usize];
        let sorted = || order.par_iter().map(gather);
        let positions: Vec<[f32; 3]> = sorted().map(|p| p.position).collect();
        let tree = PhotonTree::builder()
            .with_parallel_construction()
            .build_from_slice(&positions)
            .map_err(|error| MapError::Tree {
                count: positions.len(),
                cause: format!("{error:?}"),
            })?;
        let direction = if columns.direction {
            sorted().map(|p| PackedDirection::new(p.direction)).collect()
        } else {
            Vec::new()
        };
        let sigma_t =
            if columns.sigma_t { sorted().map(|p| p.sigma_t).collect() } else { Vec::new() };
        let order_column =
            if columns.order { sorted().map(|p| p.order).collect() } else { Vec::new() };
        let power = sorted().map(|p| p.power).collect();
        Ok(Self {
            tree,
            frame,
            position: positions,
            power,
            direction,
            sigma_t,
            order: order_column,
        })
    }

    /// Photons stored.
    pub fn len(&self) -> usize {
        self.power.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.power.is_empty()
    }

    /// The coordinates of the stored positions.
    pub fn frame(&self) -> MapFrame {
        self.frame
    }

    /// Bytes a photon takes, tree included.
    pub fn bytes_per_photon(&self) -> usize {
        let tree = 3 * size_of::<f32>() + size_of::<u32>();
        let column = |is_empty: bool, bytes: usize| if is_empty { 0 } else { bytes };
        tree + 2 * size_of::<[f32; 3]>()
            + column(self.direction.is_empty(), size_of::<PackedDirection>())
            + column(self.sigma_t.is_empty(), size_of::<f32>())
            + column(self.order.is_empty(), size_of::<u32>())
    }

    /// From a place to a photon, both in map coordinates.
    #[inline]
    pub fn offset(&self, photon: u32, from: [f32; 3]) -> Vec3 {
        Vec3::from_array(self.position[photon as usize]) - Vec3::from_array(from)
    }

    /// Power of a photon \[W\].
    #[inline]
    pub fn power(&self, photon: u32) -> [f32; 3] {
        self.power[photon as usize]
    }

    /// Direction of travel, if kept.
    #[inline]
    pub fn direction(&self, photon: u32) -> Option<DVec3> {
        self.direction.get(photon as usize).map(|packed| packed.unpack())
    }

    /// sigma_t at the photon \[1/m\], if kept.
    #[inline]
    pub fn sigma_t(&self, photon: u32) -> Option<f32> {
        self.sigma_t.get(photon as usize).copied()
    }

    /// Scatterings before the collision, if kept.
    #[inline]
    pub fn order(&self, photon: u32) -> Option<u32> {
        self.order.get(photon as usize).copied()
    }
}
