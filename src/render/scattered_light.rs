//! Where the light comes from that is scattered more than once: the strategies of gathering.

use serde::Serialize;

use crate::estimate::{Estimator, InScattered};
use crate::lattice::{Lamps, LightLattice};
use crate::math::{DVec3, Rgb, Stream};
use crate::medium::{Extinction, Phase};
use crate::reference::PathTracer;
use crate::render::photon_query::PhotonQuery;

/// How scattered light is gathered from photons.
///
/// A [`Scene`](crate::scene::Scene) that was loaded has no `Auto`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Gather {
    /// In a lattice, or by bounced paths where light is scattered many times.
    Auto,
    /// From the k nearest photons of points along the camera's rays.
    Knn,
    /// From the lengths that photons fly in the cells of a lattice.
    Lattice,
    /// By paths that scatter a few times before they end in such a lattice.
    Bounce,
}

/// Answers queries for scattered light, from one thread.
pub trait ScatteredLight {
    /// Whether queries are answered faster in an order in which each is near the last.
    const ORDERED: bool;

    /// Whether there are coarser cells to compare with.
    const HAS_COARSE: bool;

    /// Lamps at whose peaks it is to be looked for apart.
    fn lamps(&self) -> Option<&Lamps> {
        None
    }

    /// Light scattered at the query's place towards the camera, per sigma_s \[W/(m^2 sr)\]: not weighted.
    fn in_scattered(&mut self, query: &PhotonQuery) -> InScattered;

    /// The same, and what cells twice as long would add to it.
    fn compared(&mut self, query: &PhotonQuery) -> (InScattered, Rgb) {
        (self.in_scattered(query), Rgb::ZERO)
    }
}

impl<E: Extinction> ScatteredLight for Estimator<'_, E> {
    const ORDERED: bool = true;
    const HAS_COARSE: bool = false;

    fn in_scattered(&mut self, query: &PhotonQuery) -> InScattered {
        Estimator::in_scattered(self, query.place, query.towards, query.turn)
    }
}

/// A lattice read where queries are.
pub struct LatticeReader<'a> {
    /// The light.
    pub lattice: &'a LightLattice,
    /// Where it scatters.
    pub phase: Phase,
}

impl ScatteredLight for LatticeReader<'_> {
    const ORDERED: bool = false;
    const HAS_COARSE: bool = true;

    fn lamps(&self) -> Option<&Lamps> {
        self.lattice.shape().lamps()
    }

    fn in_scattered(&mut self, query: &PhotonQuery) -> InScattered {
        let multiple = self.lattice.scattered(query.place, query.towards, self.phase);
        from_cells(self.lattice, multiple)
    }

    fn compared(&mut self, query: &PhotonQuery) -> (InScattered, Rgb) {
        let found = self.in_scattered(query);
        let coarse = self.lattice.coarse_scattered(query.place, query.towards, self.phase);
        (found, coarse - found.multiple)
    }
}

/// A lattice read where paths end that began at the query.
pub struct BouncedReader<'a, E> {
    /// What paths end in.
    pub lattice: LatticeReader<'a>,
    /// What they are traced by.
    pub paths: PathTracer<'a, E>,
    /// Their collisions.
    pub bounces: u32,
    /// Seed of their random numbers, together with that of the query.
    pub seed: u64,
}

impl<E: Extinction> ScatteredLight for BouncedReader<'_, E> {
    const ORDERED: bool = false;
    const HAS_COARSE: bool = true;

    fn in_scattered(&mut self, query: &PhotonQuery) -> InScattered {
        let LatticeReader { lattice, phase } = self.lattice;
        let multiple = self.path(query, |place, towards| lattice.scattered(place, towards, phase));
        from_cells(lattice, multiple)
    }

    fn compared(&mut self, query: &PhotonQuery) -> (InScattered, Rgb) {
        let LatticeReader { lattice, phase } = self.lattice;
        let coarse =
            self.path(query, |place, towards| lattice.coarse_scattered(place, towards, phase));
        let found = self.in_scattered(query);
        (found, coarse - found.multiple)
    }
}

impl<E: Extinction> BouncedReader<'_, E> {
    /// The light of the query's path, the same at every call but for its end.
    fn path(&mut self, query: &PhotonQuery, end: impl FnMut(DVec3, DVec3) -> Rgb) -> Rgb {
        let mut random = Stream::Bounce.random(self.seed, query.turn.to_bits());
        self.paths.scattered_light(query.place, query.towards, self.bounces, &mut random, end)
    }
}

fn from_cells(lattice: &LightLattice, multiple: Rgb) -> InScattered {
    InScattered { multiple, radius: lattice.shape().cell_edge(), ..InScattered::default() }
}
