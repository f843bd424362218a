//! The search for the k nearest photons in the tree.
//!
//! All photons within a bound are gathered and the k nearest told from them. Any bound with k photons or more within holds the
//! k nearest, so that the only question is how many more it holds. Along a ray the k-th distance grows no faster than the ray
//! moves, r_k(q) <= r_k(p) + |q - p|, and seldom by more than counts vary from ball to ball: the search begins with a little
//! more than the last radius, and falls back on the bound. Without a last one, the k-th distance among the photons of the
//! nearest node that holds k is a bound.
//!
//! Rounded squared distances to a box are not above those to any photon in it, as both round in the same order; no photon is
//! lost to rounding.

use crate::map::RADIUS_FLOOR;
use crate::map::candidates::Candidates;
use crate::map::lanes::{Block, LANES, Lanes, Task};
use crate::map::wide_tree::{Leaf, Node, WideTree};

/// Levels of a tree of 2^32 photons.
const MOST_LEVELS: usize = 8;

/// Candidates beyond which those that are too far are dropped, besides `CROWD_RATIO` k.
const CROWD: usize = 256;
const CROWD_RATIO: usize = 4;

/// Beyond this many last radii the last one says too little.
const WARM_RATIO: f32 = 2.0;

/// A bound of this many last radii holds not so many photons more as to look for a better one.
const RETRY_RATIO: f32 = 1.35;

/// The last query answered.
#[derive(Clone, Copy, Debug)]
pub(super) struct LastQuery {
    pub(super) query: [f32; 3],
    pub(super) k: usize,
    /// Distance of its k-th photon.
    pub(super) radius: f32,
}

/// A query.
pub(super) struct Search<'s> {
    pub(super) tree: &'s WideTree,
    pub(super) query: [f32; 3],
    /// How many photons to find; from 1 on.
    pub(super) k: usize,
    /// None farther than this.
    pub(super) limit: f32,
    pub(super) last: Option<LastQuery>,
    /// The answer.
    pub(super) candidates: &'s mut Candidates,
}

impl Task for Search<'_> {
    /// Whether k were found: then the farthest comes last. Otherwise all within the limit are.
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) -> bool {
        let limit = self.limit * self.limit;
        let bound = match self.last {
            Some(last) => self.bound_from(last),
            None => None,
        };
        let mut reach = match bound {
            Some((_, likely)) => likely * likely,
            None => lanes.call(
                #[inline(always)]
                || self.bound_from_tree(lanes),
            ),
        };
        reach = self.gather(lanes, reach.min(limit));
        if self.candidates.count < self.k && reach < limit {
            reach = match (bound, self.last) {
                (Some((certain, _)), Some(last)) if certain <= last.radius * RETRY_RATIO => {
                    certain * certain
                }
                _ => lanes.call(
                    #[inline(always)]
                    || self.bound_from_tree(lanes),
                ),
            };
            reach = lanes.call(
                #[inline(always)]
                || self.gather(lanes, reach.min(limit)),
            );
        }
        if self.candidates.count < self.k {
            return false;
        }
        let kth = self.candidates.kth(lanes, self.k, reach);
        let farthest = self.candidates.keep(lanes, self.k, kth);
        let end = self.k - 1;
        self.candidates.squares.swap(farthest, end);
        self.candidates.photons.swap(farthest, end);
        true
    }
}

impl Search<'_> {
    /// A distance that certainly holds k photons, and one that likely does, where the last query is near enough.
    #[inline(always)]
    fn bound_from(&self, last: LastQuery) -> Option<(f32, f32)> {
        let ([x, y, z], [last_x, last_y, last_z]) = (self.query, last.query);
        let (x, y, z) = (x - last_x, y - last_y, z - last_z);
        let moved = (x * x + y * y + z * z).sqrt();
        // A few steps of rounding more.
        let certain = (last.radius + moved) * (1.0 + 1e-5) + f32::MIN_POSITIVE;
        let is_near =
            last.k == self.k && last.radius > RADIUS_FLOOR && certain <= last.radius * WARM_RATIO;
        // The k-th distance of balls apart varies by 1 / (3 sqrt(k)), by less where they share photons.
        let likely = last.radius * (1.0 + 0.75 / (self.k as f32).sqrt());
        if is_near { Some((certain, certain.min(likely))) } else { None }
    }

    /// A squared distance that holds k photons, if there are as many: infinite if there are not.
    #[inline(always)]
    fn bound_from_tree<L: Lanes>(&mut self, lanes: L) -> f32 {
        let tree = self.tree;
        if tree.photon_count < self.k {
            return f32::INFINITY;
        }
        let query = splat(lanes, self.query);
        // The photons of a node: from the root to the nearest child that is full as long as those hold k.
        let (mut first, mut size) = (0, LANES.pow(tree.levels.len() as u32 + 1));
        for level in tree.levels.iter().rev() {
            let child_size = size / LANES;
            let full = ((tree.photon_count - first) / child_size).min(LANES);
            let Some(node) = level.get(first / size) else { break };
            if child_size < self.k || full == 0 {
                break;
            }
            let mut squares = [0.0; LANES];
            lanes.compress(box_squares(lanes, node, query), 0xffff, &mut squares);
            let mut nearest = 0;
            for child in 1..full {
                if squares[child] < squares[nearest] {
                    nearest = child;
                }
            }
            first += nearest * child_size;
            size = child_size;
        }
        self.candidates.count = 0;
        let leaves = first / LANES..((first + size).div_ceil(LANES)).min(tree.leaves.len());
        self.candidates.reserve(leaves.len() * LANES);
        let bound = lanes.splat(f32::MAX);
        for (leaf, number) in tree.leaves[leaves.clone()].iter().zip(leaves) {
            let squares = photon_squares(lanes, leaf, query);
            let near = lanes.not_above(squares, bound);
            self.candidates.add(lanes, squares, near, (number * LANES) as u32);
        }
        if self.candidates.count < self.k {
            return f32::INFINITY;
        }
        let ceiling = self.candidates.largest(lanes);
        self.candidates.kth(lanes, self.k, ceiling)
    }

    /// Gathers the photons whose squared distance is not above `reach`, in the order of the tree. Where they crowd, those that
    /// are not among the k nearest are dropped: returns what none of those left is above.
    #[inline(always)]
    fn gather<L: Lanes>(&mut self, lanes: L, reach: f32) -> f32 {
        let tree = self.tree;
        let mut ceiling = reach;
        self.candidates.count = 0;
        let Some(top) = tree.levels.len().checked_sub(1) else { return ceiling };
        let query = splat(lanes, self.query);
        let mut bound = lanes.splat(reach);
        // By level: the node that the search is in, and its children that are yet to be visited.
        let mut nodes = [0; MOST_LEVELS];
        let mut masks = [0_u32; MOST_LEVELS];
        let (mut height, mut node) = (top, 0);
        let mut mask = children_within(lanes, &tree.levels[top], 0, query, bound);
        loop {
            if height == 0 {
                while mask != 0 {
                    let number = node * LANES + mask.trailing_zeros() as usize;
                    mask &= mask - 1;
                    let Some(leaf) = tree.leaves.get(number) else { break };
                    let squares = photon_squares(lanes, leaf, query);
                    let mut near = lanes.not_above(squares, bound);
                    if !self.candidates.has_room() {
                        let kth = lanes.call(
                            #[inline(always)]
                            || self.make_room(lanes, ceiling),
                        );
                        if let Some(kth) = kth {
                            // Those to come are after the k kept in the order of ties.
                            bound = lanes.splat(kth.next_down());
                            ceiling = kth;
                        }
                        near &= lanes.not_above(squares, bound);
                    }
                    self.candidates.add(lanes, squares, near, (number * LANES) as u32);
                }
            }
            while mask == 0 {
                height += 1;
                if height > top {
                    return ceiling;
                }
                (node, mask) = (nodes[height % MOST_LEVELS], masks[height % MOST_LEVELS]);
            }
            let child = node * LANES + mask.trailing_zeros() as usize;
            mask &= mask - 1;
            nodes[height % MOST_LEVELS] = node;
            masks[height % MOST_LEVELS] = mask;
            height -= 1;
            node = child;
            mask = children_within(lanes, &tree.levels[height], node, query, bound);
        }
    }

    /// Makes room for another block: by dropping what is not among the k nearest once there are far more, else by growing.
    /// Returns the k-th squared distance, if it was found. None of those there are is above `ceiling`.
    #[inline(always)]
    fn make_room<L: Lanes>(&mut self, lanes: L, ceiling: f32) -> Option<f32> {
        let count = self.candidates.count;
        let crowd = self.k.saturating_mul(CROWD_RATIO).saturating_add(CROWD);
        if count < crowd {
            self.candidates.reserve((2 * count).min(crowd).max(CROWD));
            return None;
        }
        let kth = self.candidates.kth(lanes, self.k, ceiling);
        self.candidates.keep(lanes, self.k, kth);
        Some(kth)
    }
}

/// A place in every lane.
#[inline(always)]
fn splat<L: Lanes>(lanes: L, [x, y, z]: [f32; 3]) -> [L::Floats; 3] {
    [lanes.splat(x), lanes.splat(y), lanes.splat(z)]
}

#[inline(always)]
fn sum_of_squares<L: Lanes>(lanes: L, [x, y, z]: [L::Floats; 3]) -> L::Floats {
    lanes.add(lanes.add(lanes.mul(x, x), lanes.mul(y, y)), lanes.mul(z, z))
}

/// Squared distances of a leaf's photons.
#[inline(always)]
fn photon_squares<L: Lanes>(lanes: L, [x, y, z]: &Leaf, query: [L::Floats; 3]) -> L::Floats {
    let offset = [
        lanes.sub(lanes.load(x), query[0]),
        lanes.sub(lanes.load(y), query[1]),
        lanes.sub(lanes.load(z), query[2]),
    ];
    sum_of_squares(lanes, offset)
}

/// Squared distances of a node's children: 0 inside.
#[inline(always)]
fn box_squares<L: Lanes>(lanes: L, node: &Node, query: [L::Floats; 3]) -> L::Floats {
    let offset = [
        outside(lanes, &node.low[0], &node.high[0], query[0]),
        outside(lanes, &node.low[1], &node.high[1], query[1]),
        outside(lanes, &node.low[2], &node.high[2], query[2]),
    ];
    sum_of_squares(lanes, offset)
}

/// How far a coordinate is outside intervals: 0 inside.
#[inline(always)]
fn outside<L: Lanes>(lanes: L, low: &Block<f32>, high: &Block<f32>, at: L::Floats) -> L::Floats {
    let below = lanes.sub(lanes.load(low), at);
    let above = lanes.sub(at, lanes.load(high));
    lanes.max(lanes.max(below, above), lanes.splat(0.0))
}

/// Which children of a node are within a squared distance.
#[inline(always)]
fn children_within<L: Lanes>(
    lanes: L,
    level: &[Node],
    node: usize,
    query: [L::Floats; 3],
    bound: L::Floats,
) -> u32 {
    match level.get(node) {
        Some(node) => lanes.not_above(box_squares(lanes, node, query), bound),
        None => 0,
    }
}
