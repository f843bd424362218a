//! The k nearest photons of a place.
//!
//! The k-th distance changes along a ray no faster than the ray moves: r_k(q) <= r_k(p) + |q - p|. A query near
//! the last one therefore gathers all photons within that bound, without a heap, and selects the k-th of them;
//! only a query far from the last one asks the tree for the k nearest. Both find the same photons.

use std::num::NonZeroUsize;

use kiddo::{Eytzinger, QueryScratch, SquaredEuclidean};

use crate::map::PhotonMap;
use crate::math::DVec3;

type Metric = SquaredEuclidean<f32>;

/// A photon found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbor {
    /// Squared distance in map units.
    pub distance_squared: f32,
    /// Index into the map.
    pub photon: u32,
}

/// The photons about a place.
#[derive(Clone, Copy, Debug)]
pub struct Nearest<'a> {
    /// The photons, in no order but that the farthest of k comes last.
    pub photons: &'a [Neighbor],
    /// Whether k were found: then the last lies on the ball. Otherwise the ball is the largest allowed and
    /// holds all its photons inside.
    pub complete: bool,
    /// Radius of the ball in map units.
    pub radius: f32,
    /// Its centre in map coordinates.
    pub query: [f32; 3],
}

/// Finds nearest photons, with memory reused from query to query.
pub struct NearestPhotons<'a> {
    map: &'a PhotonMap,
    scratch: QueryScratch<Eytzinger, f32, 3>,
    found: Vec<Neighbor>,
    last: Option<([f32; 3], f32)>,
}

/// The smallest radius of a ball in map units. Photons that coincide, or a query on its only photon, would
/// otherwise make a density infinite; the floor is a few steps of `f32` at the edge of the medium.
pub const RADIUS_FLOOR: f32 = 1e-6;

/// A gather by bound visits the photons of the whole bounding ball: beyond this many last radii the tree's own
/// search is cheaper.
const WARM_RATIO: f32 = 1.8;

impl<'a> NearestPhotons<'a> {
    /// A finder in a map.
    pub fn new(map: &'a PhotonMap) -> Self {
        let scratch = map.tree.create_scratch::<Metric>();
        Self { map, scratch, found: Vec::new(), last: None }
    }

    /// The map searched.
    pub fn map(&self) -> &'a PhotonMap {
        self.map
    }

    /// The `k` photons nearest to a world-space `place`, within `max_radius` \[m\].
    pub fn find(&mut self, place: DVec3, k: NonZeroUsize, max_radius: f64) -> Nearest<'_> {
        let query = self.map.frame.to_map(place);
        let limit = ((max_radius / self.map.frame.unit) as f32).min(1e18);
        let warm = self.last.and_then(|(last_query, last_radius)| {
            let moved = distance(query, last_query);
            let bound = (last_radius + moved) * (1.0 + 1e-5) + f32::MIN_POSITIVE;
            (bound <= last_radius * WARM_RATIO && bound < limit).then_some(bound)
        });
        let complete = match warm {
            Some(bound) if self.gather(query, bound) >= k.get() => {
                let by_distance = |a: &Neighbor, b: &Neighbor| {
                    a.distance_squared.total_cmp(&b.distance_squared).then(a.photon.cmp(&b.photon))
                };
                self.found.select_nth_unstable_by(k.get() - 1, by_distance);
                self.found.truncate(k.get());
                true
            }
            _ => self.search(query, k, limit) == k.get(),
        };
        let farthest = self.found.last().map_or(0.0, |n| n.distance_squared.sqrt());
        let radius = if complete { farthest } else { limit };
        self.last = complete.then_some((query, radius));
        Nearest { photons: &self.found, complete, radius: radius.max(RADIUS_FLOOR), query }
    }

    /// All photons within `radius` \[m\] of a world-space `place`, in no order.
    pub fn within(&mut self, place: DVec3, radius: f64) -> &[Neighbor] {
        let query = self.map.frame.to_map(place);
        self.last = None;
        self.gather(query, ((radius / self.map.frame.unit) as f32).min(1e18));
        &self.found
    }

    /// All photons within `radius`.
    fn gather(&mut self, query: [f32; 3], radius: f32) -> usize {
        let found = &mut self.found;
        found.clear();
        self.map
            .tree
            .query(&query)
            .within::<Metric>(radius * radius)
            .unsorted()
            .with_scratch(&mut self.scratch)
            .visit(|n| found.push(Neighbor { distance_squared: n.distance, photon: n.item }));
        found.len()
    }

    /// The k nearest within `limit`, by the tree.
    fn search(&mut self, query: [f32; 3], k: NonZeroUsize, limit: f32) -> usize {
        self.found.clear();
        // No more than there are: k may be any number.
        let Some(k) = NonZeroUsize::new(k.get().min(self.map.len())) else { return 0 };
        let nearest = self
            .map
            .tree
            .query(&query)
            .nearest_n::<Metric>(k)
            .within(limit * limit)
            .with_scratch(&mut self.scratch)
            .execute();
        let neighbors =
            nearest.iter().map(|n| Neighbor { distance_squared: n.distance, photon: n.item });
        self.found.extend(neighbors);
        self.found.len()
    }
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|axis| (a[axis] - b[axis]) * (a[axis] - b[axis])).sum::<f32>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::Columns;
    use crate::math::{Stream, uniform};
    use crate::trace::{MapFrame, Photon};

    fn map_of(positions: &[[f32; 3]]) -> PhotonMap {
        let photons: Vec<Photon> = positions
            .iter()
            .map(|&position| Photon {
                position,
                direction: [0.0, 0.0, 1.0],
                power: [1.0; 3],
                sigma_t: 1.0,
                order: 0,
            })
            .collect();
        let frame = MapFrame { origin: DVec3::ZERO, unit: 1.0 };
        PhotonMap::build(&photons, frame, Columns::default()).unwrap()
    }

    fn k_of(k: usize) -> NonZeroUsize {
        NonZeroUsize::new(k).unwrap()
    }

    /// Radii against brute force, along lines of close queries (warm) and far ones (cold), in a uniform cloud
    /// with a dense clump, some coincident and some coplanar photons.
    #[test]
    fn radii_equal_brute_force() {
        let mut random = Stream::Experiment.random(5, 0);
        let mut positions: Vec<[f32; 3]> = (0..3000)
            .map(|i| {
                let scale = if i % 3 == 0 { 0.02 } else { 1.0 };
                std::array::from_fn(|_| (uniform(&mut random) as f32 - 0.5) * scale)
            })
            .collect();
        positions.extend([[0.3, 0.3, 0.3]; 200]);
        positions.extend((0..200).map(|i| [i as f32 / 200.0, 0.25, 0.5]));
        let map = map_of(&positions);
        for k in [1, 2, 17, 100, 500] {
            let mut finder = NearestPhotons::new(&map);
            for step in 0..300 {
                let jump = f64::from(step / 50) * 0.13;
                let place = DVec3::new(-0.5 + f64::from(step % 50) * 0.02, jump - 0.3, 0.3 - jump);
                let q = place.as_vec3().to_array();
                let mut exact: Vec<f32> = positions.iter().map(|&p| distance(p, q)).collect();
                exact.sort_by(f32::total_cmp);
                let nearest = finder.find(place, k_of(k), 10.0);
                assert!(nearest.complete && nearest.photons.len() == k);
                let expected = exact[k - 1].max(RADIUS_FLOOR);
                assert!((nearest.radius - expected).abs() <= 1e-5 * expected, "k {k} at {place}");
                let inside = nearest
                    .photons
                    .iter()
                    .filter(|n| n.distance_squared.sqrt() <= expected * (1.0 + 1e-5));
                assert_eq!(inside.count(), k);
                let mut ids: Vec<u32> = nearest.photons.iter().map(|n| n.photon).collect();
                ids.sort_unstable();
                ids.dedup();
                assert_eq!(ids.len(), k, "no photon twice");
            }
        }
    }

    #[test]
    fn few_photons_and_small_limits_fill_the_largest_ball() {
        for count in 0..4 {
            let positions: Vec<[f32; 3]> = (0..count).map(|i| [i as f32 * 0.1, 0.0, 0.0]).collect();
            let map = map_of(&positions);
            let mut finder = NearestPhotons::new(&map);
            let nearest = finder.find(DVec3::ZERO, k_of(4), 0.5);
            assert!(!nearest.complete);
            assert_eq!(nearest.photons.len(), count);
            assert_eq!(nearest.radius, 0.5);
            let huge = finder.find(DVec3::ZERO, k_of(usize::MAX), 0.15);
            assert_eq!(huge.photons.len(), count.min(2));
        }
    }

    #[test]
    fn coincident_photons_have_a_finite_radius_and_bounded_cost() {
        let map = map_of(&vec![[0.25, 0.5, -0.125]; 200_000]);
        let mut finder = NearestPhotons::new(&map);
        let nearest = finder.find(DVec3::new(0.25, 0.5, -0.125), k_of(50), 1.0);
        assert_eq!(nearest.photons.len(), 50);
        assert_eq!(nearest.radius, RADIUS_FLOOR);
    }

    #[test]
    fn photons_that_are_not_finite_are_left_out() {
        let mut positions = vec![[0.1, 0.2, 0.3]; 40];
        positions.extend([[f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 0.0]]);
        assert_eq!(map_of(&positions).len(), 40);
    }
}
