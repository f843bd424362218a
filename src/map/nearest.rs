//! The k nearest photons of a place.
//!
//! A query near the last one begins with a bound on the k-th distance that follows from the last (`search`). The photons found are
//! those of brute force, of photons equally far the first ones in the map, and in the same order whatever the last query was.

use std::num::NonZeroUsize;

use crate::map::PhotonMap;
use crate::map::candidates::Candidates;
use crate::map::lanes::Instructions;
use crate::map::search::{LastQuery, Search};
use crate::math::DVec3;

/// The photons about a place.
#[derive(Clone, Copy, Debug)]
pub struct Nearest<'a> {
    /// The photons, as indices into the map, in its order, but that the farthest of k and the last change places.
    pub photons: &'a [u32],
    /// Their squared distances in map units.
    pub squares: &'a [f32],
    /// Whether k were found: then the last lies on the ball. Otherwise the ball is the largest allowed and
    /// holds all its photons inside.
    pub complete: bool,
    /// Radius of the ball in map units.
    pub radius: f32,
    /// Its centre in map coordinates.
    pub query: [f32; 3],
}

impl<'a> Nearest<'a> {
    /// The photons, each with its squared distance in map units.
    #[inline]
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (u32, f32)> + 'a {
        self.photons.iter().copied().zip(self.squares.iter().copied())
    }
}

/// Finds nearest photons, with memory reused from query to query.
pub struct NearestPhotons<'a> {
    map: &'a PhotonMap,
    instructions: Instructions,
    candidates: Candidates,
    last: Option<LastQuery>,
}

/// The smallest radius of a ball in map units. Photons that coincide, or a query on its only photon, would
/// otherwise make a density infinite; the floor is a few steps of `f32` at the edge of the medium.
pub const RADIUS_FLOOR: f32 = 1e-6;

/// No ball is larger, in map units: its square must be finite.
const MOST_REACH: f32 = 1e18;

impl<'a> NearestPhotons<'a> {
    /// A finder in a map.
    pub fn new(map: &'a PhotonMap) -> Self {
        Self::with(map, Instructions::detect())
    }

    fn with(map: &'a PhotonMap, instructions: Instructions) -> Self {
        Self { map, instructions, candidates: Candidates::default(), last: None }
    }

    /// The map searched.
    pub fn map(&self) -> &'a PhotonMap {
        self.map
    }

    /// The `k` photons nearest to a world-space `place`, within `max_radius` \[m\].
    pub fn find(&mut self, place: DVec3, k: NonZeroUsize, max_radius: f64) -> Nearest<'_> {
        let query = self.map.frame.to_map(place);
        let limit = self.reach(max_radius);
        let k = k.get();
        let complete = self.search(query, k, limit);
        let Candidates { squares, photons, count } = &self.candidates;
        let (squares, photons) = (&squares[..*count], &photons[..*count]);
        let radius = match squares.last() {
            Some(farthest) if complete => farthest.sqrt(),
            _ => limit,
        };
        self.last = complete.then_some(LastQuery { query, k, radius });
        Nearest { photons, squares, complete, radius: radius.max(RADIUS_FLOOR), query }
    }

    /// All photons within `radius` \[m\] of a world-space `place`, in the map's order.
    pub fn within(&mut self, place: DVec3, radius: f64) -> Nearest<'_> {
        let query = self.map.frame.to_map(place);
        let radius = self.reach(radius);
        self.last = None;
        // One more than there are: none is dropped.
        self.search(query, self.map.len() + 1, radius);
        let Candidates { squares, photons, count } = &self.candidates;
        let (squares, photons) = (&squares[..*count], &photons[..*count]);
        Nearest { photons, squares, complete: false, radius: radius.max(RADIUS_FLOOR), query }
    }

    /// A distance \[m\] in map units.
    #[inline]
    fn reach(&self, distance: f64) -> f32 {
        ((distance / self.map.frame.unit) as f32).min(MOST_REACH)
    }

    #[inline]
    fn search(&mut self, query: [f32; 3], k: usize, limit: f32) -> bool {
        let (tree, last, candidates) = (&self.map.tree, self.last, &mut self.candidates);
        self.instructions.run(Search { tree, query, k, limit, last, candidates })
    }
}

#[cfg(test)]
mod tests;
