//! Against brute force and against kiddo, with every processor's instructions.

use super::*;
use crate::map::Columns;
use crate::math::{Stream, uniform};
use crate::trace::{MapFrame, Photon};
use proptest::prelude::*;

const FRAME: MapFrame = MapFrame { origin: DVec3::ZERO, unit: 1.0 };

fn map_in(frame: MapFrame, positions: &[[f32; 3]]) -> PhotonMap {
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
    PhotonMap::build(&photons, frame, Columns::default()).unwrap()
}

fn map_of(positions: &[[f32; 3]]) -> PhotonMap {
    map_in(FRAME, positions)
}

fn k_of(k: usize) -> NonZeroUsize {
    NonZeroUsize::new(k).unwrap()
}

fn square(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [x, y, z] = std::array::from_fn(|axis| a[axis] - b[axis]);
    x * x + y * y + z * z
}

/// The k nearest within a limit, in the order promised.
fn brute_force(map: &PhotonMap, query: [f32; 3], k: usize, limit: f32) -> Vec<(u32, f32)> {
    let squares = (0..map.len() as u32).map(|i| (i, square(map.tree.position(i), query)));
    let mut near: Vec<(u32, f32)> = squares.filter(|&(_, s)| s <= limit * limit).collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    let farthest = near.get(k.wrapping_sub(1)).copied();
    near.truncate(k);
    near.sort_by_key(|&(photon, _)| photon);
    if let Some(at) = farthest.and_then(|last| near.iter().position(|&found| found == last)) {
        near.swap(at, k - 1);
    }
    near
}

/// Finders for all instructions there are.
fn finders(map: &PhotonMap) -> Vec<NearestPhotons<'_>> {
    Instructions::all().into_iter().map(|each| NearestPhotons::with(map, each)).collect()
}

/// Asks all finders one after another, each with its own memory of the last query.
fn check(finders: &mut [NearestPhotons<'_>], place: DVec3, k: usize, limit: f32) {
    let map = finders[0].map();
    let query = map.frame.to_map(place);
    let reach = (f64::from(limit) / map.frame.unit) as f32;
    let reach = reach.min(MOST_REACH);
    let exact = brute_force(map, query, k, reach);
    for finder in finders {
        let found = finder.find(place, k_of(k), f64::from(limit));
        let pairs: Vec<(u32, f32)> = found.iter().collect();
        assert_eq!(pairs, exact, "k {k} at {place} within {limit}");
        assert_eq!(found.complete, exact.len() == k);
        let radius = if found.complete { exact[k - 1].1.sqrt() } else { reach };
        assert_eq!(found.radius, radius.max(RADIUS_FLOOR));
    }
}

/// A cloud with a dense clump, coincident photons, and some on a lattice, where distances tie.
fn motley() -> Vec<[f32; 3]> {
    let mut random = Stream::Experiment.random(7, 0);
    let mut positions: Vec<[f32; 3]> = (0..3000)
        .map(|i| {
            let scale = if i % 3 == 0 { 0.02 } else { 1.0 };
            std::array::from_fn(|_| (uniform(&mut random) as f32 - 0.5) * scale)
        })
        .collect();
    positions.extend([[0.25, 0.25, 0.25]; 300]);
    let lattice = |i: u16, shift: u16| f32::from(i >> shift & 7) / 16.0;
    positions.extend((0..512).map(|i| [lattice(i, 0), -lattice(i, 3), -lattice(i, 6)]));
    positions
}

/// Lines of close queries, jumps between them, queries on photons, on ties and outside the cloud.
#[test]
fn photons_and_their_order_are_those_of_brute_force() {
    let map = map_of(&motley());
    for k in [1, 2, 17, 50, 200, 500, 4000] {
        for limit in [10.0, 0.06] {
            let mut finders = finders(&map);
            for step in 0..150 {
                let jump = f64::from(step / 30) * 0.13;
                let along = f64::from(step % 30);
                let place = DVec3::new(-0.5 + along * 0.02, jump - 0.3, 0.3 - jump);
                check(&mut finders, place, k, limit);
            }
            for step in 0..40 {
                let along = f64::from(step) / 32.0;
                check(&mut finders, DVec3::new(along, -0.125, -0.25), k, limit);
                check(&mut finders, DVec3::splat(3.0 - along), k, limit);
            }
        }
    }
}

/// The answers do not depend on what was asked before, with other k and limits between.
#[test]
fn answers_do_not_depend_on_the_last_query() {
    let map = map_of(&motley());
    let mut random = Stream::Experiment.random(8, 0);
    let mut finders = finders(&map);
    let mut place = DVec3::ZERO;
    for step in 0..2000 {
        let size = [0.003, 0.03, 0.4][step % 3];
        let move_by = std::array::from_fn(|_| size * (uniform(&mut random) - 0.5));
        place = (place + DVec3::from_array(move_by)).clamp(DVec3::splat(-0.7), DVec3::splat(0.7));
        let k = [8, 8, 8, 50, 200][step % 5];
        check(&mut finders, place, k, if step % 7 == 0 { 0.05 } else { 10.0 });
    }
}

/// The photons of the tree that is public: same distances, and same photons where none tie.
#[test]
fn photons_are_those_of_kiddo() {
    let mut random = Stream::Experiment.random(9, 0);
    let positions: Vec<[f32; 3]> =
        (0..20_000).map(|_| std::array::from_fn(|_| uniform(&mut random) as f32)).collect();
    let map = map_of(&positions);
    let stored: Vec<[f32; 3]> = (0..map.len() as u32).map(|i| map.tree.position(i)).collect();
    let tree: kiddo::ImmutableKdTree<f32, 3> =
        kiddo::ImmutableKdTree::new_from_slice(&stored).unwrap();
    let mut finders = finders(&map);
    for step in 0..400 {
        let place = DVec3::new(f64::from(step % 20) * 0.05, 0.3, f64::from(step / 20) * 0.05);
        let query = place.as_vec3().to_array();
        let k = [10, 50, 200][step as usize % 3];
        let nearest =
            tree.query(&query).nearest_n::<kiddo::SquaredEuclidean<f32>>(k_of(k)).execute();
        let mut exact: Vec<(u32, u32)> =
            nearest.iter().map(|n| (n.item, n.distance.to_bits())).collect();
        exact.sort_unstable();
        for finder in &mut finders {
            let found = finder.find(place, k_of(k), 10.0);
            let mut pairs: Vec<(u32, u32)> =
                found.iter().map(|(photon, square)| (photon, square.to_bits())).collect();
            pairs.sort_unstable();
            assert_eq!(pairs, exact);
        }
    }
}

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        -1.0_f32..1.0,
        (-2_i8..3).prop_map(f32::from),
        Just(0.0),
        Just(-0.0),
        -1e-20_f32..1e-20,
        -1e17_f32..1e17,
        -3e38_f32..3e38,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Coordinates of all sizes, many of them equal; k beyond what there is; any limit.
    #[test]
    fn any_photons_are_found_as_by_brute_force(
        distinct in prop::collection::vec(prop::array::uniform3(coordinate()), 1..80),
        copies in 1_usize..40, scale in -60_i32..60,
        queries in prop::collection::vec((prop::array::uniform3(coordinate()), 0_usize..3), 1..12),
        k in prop_oneof![1_usize..4, 1_usize..300, Just(usize::MAX)],
        limit in prop_oneof![0.0_f32..2.0, 0.0_f32..1e20, Just(f32::INFINITY)],
    ) {
        let scale = 2.0_f32.powi(scale);
        let positions: Vec<[f32; 3]> =
            distinct.iter().cycle().take(distinct.len() * copies).map(|p| p.map(|x| x * scale)).collect();
        let map = map_of(&positions);
        let mut finders = finders(&map);
        for (query, on) in queries {
            // On a photon, near the last query, or anywhere.
            let place = match on {
                0 => DVec3::from_array(distinct[0].map(|x| f64::from(x * scale))),
                1 => DVec3::from_array(query.map(|x| 1e-3 * f64::from(x))),
                _ => DVec3::from_array(query.map(|x| f64::from(x * scale))),
            };
            check(&mut finders, place, k, limit);
        }
    }

    /// A map in its own frame: metres away and of any size.
    #[test]
    fn frames_of_any_scale_find_the_same(
        unit in prop_oneof![1e-12_f64..1e-9, 0.1_f64..10.0, 1e9_f64..1e12], origin in prop::array::uniform3(-1e6_f64..1e6),
        place in prop::array::uniform3(-1.0_f64..1.0), k in 1_usize..100,
    ) {
        let frame = MapFrame { origin: DVec3::from_array(origin), unit };
        let map = map_in(frame, &motley());
        let place = DVec3::from_array(origin) + DVec3::from_array(place) * unit;
        check(&mut finders(&map), place, k, f32::INFINITY);
    }
}

#[test]
fn all_within_a_distance_are_found() {
    let map = map_of(&motley());
    for mut finder in finders(&map) {
        for radius in [0.0, 0.01, 0.3, 1e30] {
            let place = DVec3::new(0.25, 0.25, 0.25);
            let query = place.as_vec3().to_array();
            let exact = brute_force(&map, query, usize::MAX, (radius as f32).min(MOST_REACH));
            let found: Vec<(u32, f32)> = finder.within(place, radius).iter().collect();
            assert_eq!(found, exact);
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
fn queries_that_are_no_place_find_nothing() {
    let map = map_of(&motley());
    for mut finder in finders(&map) {
        for place in [DVec3::NAN, DVec3::INFINITY, DVec3::new(0.0, f64::NEG_INFINITY, 0.0)] {
            finder.find(DVec3::ZERO, k_of(5), 1.0);
            let nearest = finder.find(place, k_of(5), 1.0);
            assert!(nearest.photons.is_empty() && !nearest.complete);
        }
        assert!(finder.find(DVec3::ZERO, k_of(5), 1.0).complete);
    }
}

#[test]
fn coincident_photons_have_a_finite_radius_and_bounded_memory() {
    let map = map_of(&vec![[0.25, 0.5, -0.125]; 200_000]);
    let mut finder = NearestPhotons::new(&map);
    let place = DVec3::new(0.25, 0.5, -0.125);
    for _ in 0..2 {
        let nearest = finder.find(place, k_of(50), 1.0);
        assert_eq!(nearest.photons, (0..50).collect::<Vec<u32>>());
        assert_eq!(nearest.radius, RADIUS_FLOOR);
    }
    assert!(finder.candidates.squares.len() < 1000);
}

#[test]
fn photons_that_are_not_finite_are_left_out() {
    let mut positions = vec![[0.1, 0.2, 0.3]; 40];
    positions.extend([[f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 0.0]]);
    assert_eq!(map_of(&positions).len(), 40);
}
