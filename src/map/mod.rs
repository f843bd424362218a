//! The photon map: a tree over photon positions, and what estimates need of each photon.
//!
//! Photons are kept in the order of the tree, so that neighbours in space are neighbours in memory. A photon takes 25 bytes, and
//! 4 more for its direction, sigma_t or order each where the scene needs them.

mod candidates;
mod lanes;
mod morton;
mod nearest;
mod packed;
mod search;
mod wide_tree;

pub use morton::morton_code;
pub use nearest::{Nearest, NearestPhotons, RADIUS_FLOOR};
pub use packed::PackedDirection;

use glam::Vec3;
use rayon::prelude::*;
use wide_tree::{Record, WideTree};

use crate::math::{DVec3, Rgb};
use crate::trace::{MapFrame, Photon};

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
    tree: WideTree,
    frame: MapFrame,
    power: Vec<[f32; 3]>,
    direction: Vec<PackedDirection>,
    sigma_t: Vec<f32>,
    order: Vec<u32>,
}

/// Why a photon map could not be built.
#[derive(Debug, thiserror::Error)]
pub enum MapError {
    /// More photons than indices.
    #[error("a photon map holds up to {} photons, not {count}: use fewer photons a pass", u32::MAX)]
    TooMany {
        /// Photons to be stored.
        count: usize,
    },
}

impl PhotonMap {
    /// Builds the map. Photons whose place or power is not finite are left out.
    pub fn build(photons: &[Photon], frame: MapFrame, columns: Columns) -> Result<Self, MapError> {
        // The leaf's unused lanes have indices too.
        if photons.len() >= u32::MAX as usize {
            return Err(MapError::TooMany { count: photons.len() });
        }
        let is_finite =
            |p: &Photon| p.position.iter().chain(&p.power).all(|value| value.is_finite());
        let mut records: Vec<Record> = (photons.par_iter().zip(0_u32..photons.len() as u32))
            .filter(|(p, _)| is_finite(p))
            .map(|(p, photon)| Record { position: p.position, photon })
            .collect();
        let tree = WideTree::build(&mut records);
        let sorted = || records.par_iter().map(|record| photons[record.photon as usize]);
        let direction = if columns.direction {
            sorted().map(|p| PackedDirection::new(p.direction)).collect()
        } else {
            Vec::new()
        };
        let sigma_t =
            if columns.sigma_t { sorted().map(|p| p.sigma_t).collect() } else { Vec::new() };
        let order = if columns.order { sorted().map(|p| p.order).collect() } else { Vec::new() };
        let power = sorted().map(|p| p.power).collect();
        Ok(Self { tree, frame, power, direction, sigma_t, order })
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
        let column = |is_empty: bool, bytes: usize| if is_empty { 0 } else { bytes };
        self.tree.bytes_per_photon()
            + size_of::<[f32; 3]>()
            + column(self.direction.is_empty(), size_of::<PackedDirection>())
            + column(self.sigma_t.is_empty(), size_of::<f32>())
            + column(self.order.is_empty(), size_of::<u32>())
    }

    /// From a place to a photon, both in map coordinates.
    #[inline]
    pub fn offset(&self, photon: u32, from: [f32; 3]) -> Vec3 {
        Vec3::from_array(self.tree.position(photon)) - Vec3::from_array(from)
    }

    /// Power of a photon \[W\].
    #[inline]
    pub fn power(&self, photon: u32) -> [f32; 3] {
        self.power[photon as usize]
    }

    /// Sum of the powers of photons \[W\]. Apart, where the loop has all registers.
    #[inline(never)]
    pub fn total_power(&self, photons: &[u32]) -> Rgb {
        let mut sum = Rgb::ZERO;
        for &photon in photons {
            let [r, g, b] = self.power[photon as usize];
            sum += Rgb::new(f64::from(r), f64::from(g), f64::from(b));
        }
        sum
    }

    /// What is kept of each photon besides position and power.
    #[inline]
    pub fn columns(&self) -> Columns {
        Columns {
            direction: !self.direction.is_empty(),
            sigma_t: !self.sigma_t.is_empty(),
            order: !self.order.is_empty(),
        }
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
