//! Where the light comes from that is scattered more than once: the strategies of gathering.

use serde::Serialize;

use crate::estimate::{Estimator, InScattered};
use crate::lattice::LightLattice;
use crate::math::{DVec3, Rgb};
use crate::medium::Extinction;

/// How scattered light is gathered from photons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Gather {
    /// From the k nearest photons of points along the camera's rays.
    Knn,
    /// From the lengths that photons fly in the cells of a lattice.
    Lattice,
}

/// Answers queries for scattered light, from one thread.
pub trait ScatteredLight {
    /// Whether queries are answered faster in an order in which each is near the last.
    const ORDERED: bool;

    /// Whether there are coarser cells to compare with.
    const HAS_COARSE: bool;

    /// Light scattered at a place into a direction of travel, per sigma_s \[W/(m^2 sr)\].
    fn in_scattered(&mut self, place: DVec3, towards: DVec3, turn: f64) -> InScattered;

    /// The same from cells twice as long.
    fn coarse_in_scattered(&self, _place: DVec3) -> Rgb {
        Rgb::ZERO
    }
}

impl<E: Extinction> ScatteredLight for Estimator<'_, E> {
    const ORDERED: bool = true;
    const HAS_COARSE: bool = false;

    fn in_scattered(&mut self, place: DVec3, towards: DVec3, turn: f64) -> InScattered {
        Estimator::in_scattered(self, place, towards, turn)
    }
}

/// A lattice made for the camera that asks.
impl ScatteredLight for &LightLattice {
    const ORDERED: bool = false;
    const HAS_COARSE: bool = true;

    fn in_scattered(&mut self, place: DVec3, _towards: DVec3, _turn: f64) -> InScattered {
        let radius = self.shape().cell_edge();
        InScattered { multiple: self.at(place), radius, ..InScattered::default() }
    }

    fn coarse_in_scattered(&self, place: DVec3) -> Rgb {
        self.coarse_at(place)
    }
}
