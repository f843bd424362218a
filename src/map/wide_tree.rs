//! The tree over photon positions: leaves of sixteen photons, sixteen children to a node, and of each child the tight box.
//!
//! A leaf's photons and a node's boxes are as many as [`Lanes`](super::lanes::Lanes) look at together, and boxes that are tight
//! let a search pass by empty space, which planes that split do not. Photons are kept in the order of the tree, so that a leaf
//! is sixteen in a row: node i of a level has the nodes 16 i to 16 i + 15 of the level below, and no pointers. Every
//! node but the last of its level is full. Each cut is across the longest side of what it cuts.

use rayon::prelude::*;

use crate::map::lanes::{Block, LANES};

/// A place and which photon is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record {
    pub(super) position: [f32; 3],
    pub(super) photon: u32,
}

/// Sixteen positions, by axis. Where there are fewer photons, they are infinitely far.
pub(super) type Leaf = [Block<f32>; 3];

/// The boxes of sixteen children, by axis. Where there are fewer, nothing is in them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) low: [Block<f32>; 3],
    pub(super) high: [Block<f32>; 3],
}

/// Photon positions in the order of the tree.
#[derive(Debug)]
pub(super) struct WideTree {
    pub(super) leaves: Vec<Leaf>,
    /// From those over leaves up to the root. There is a root if there is a photon.
    pub(super) levels: Vec<Vec<Node>>,
    pub(super) photon_count: usize,
}

/// Photons that are worth a task of their own.
const TASK: usize = 16_384;

impl WideTree {
    /// Builds the tree and puts the photons in its order, which depends on nothing but them: equal places in the order of photons.
    pub(super) fn build(records: &mut [Record]) -> Self {
        arrange(records);
        let leaves: Vec<Leaf> = records.par_chunks(LANES).map(leaf).collect();
        let mut levels: Vec<Vec<Node>> = Vec::new();
        let mut boxes: Vec<[[f32; 3]; 2]> = records.par_chunks(LANES).map(box_of).collect();
        while !boxes.is_empty() {
            levels.push(boxes.par_chunks(LANES).map(Node::over).collect());
            if boxes.len() <= LANES {
                break;
            }
            boxes = boxes.par_chunks(LANES).map(joined).collect();
        }
        Self { leaves, levels, photon_count: records.len() }
    }

    /// Place of a photon.
    #[inline]
    pub(super) fn position(&self, photon: u32) -> [f32; 3] {
        let leaf = &self.leaves[photon as usize / LANES];
        leaf.each_ref().map(|axis| axis.0[photon as usize % LANES])
    }

    /// Bytes a photon takes here.
    pub(super) fn bytes_per_photon(&self) -> usize {
        (size_of::<Leaf>() + size_of::<Node>() / LANES) / LANES
    }
}

impl Node {
    fn over(children: &[[[f32; 3]; 2]]) -> Self {
        let side = |end: usize, axis: usize, none: f32| {
            Block(std::array::from_fn(|lane| children.get(lane).map_or(none, |b| b[end][axis])))
        };
        Self {
            low: std::array::from_fn(|axis| side(0, axis, f32::INFINITY)),
            high: std::array::from_fn(|axis| side(1, axis, f32::NEG_INFINITY)),
        }
    }
}

/// Cuts photons into halves of whole nodes, down to leaves.
fn arrange(records: &mut [Record]) {
    let count = records.len();
    if count <= LANES {
        records.sort_unstable_by_key(|record| record.photon);
        return;
    }
    let mut child = LANES;
    while child * LANES < count {
        child *= LANES;
    }
    let left = count.div_ceil(child).div_ceil(2) * child;
    let [low, high] = box_of(records);
    let axis = (0..3).fold(0, |widest, axis| {
        if high[axis] - low[axis] > high[widest] - low[widest] { axis } else { widest }
    });
    records.select_nth_unstable_by(left, |a, b| {
        let by_place = a.position[axis].total_cmp(&b.position[axis]);
        by_place.then(a.photon.cmp(&b.photon))
    });
    let (before, after) = records.split_at_mut(left);
    if count > TASK {
        rayon::join(|| arrange(before), || arrange(after));
    } else {
        arrange(before);
        arrange(after);
    }
}

fn leaf(records: &[Record]) -> Leaf {
    std::array::from_fn(|axis| {
        Block(std::array::from_fn(|lane| {
            records.get(lane).map_or(f32::INFINITY, |record| record.position[axis])
        }))
    })
}

fn box_of(records: &[Record]) -> [[f32; 3]; 2] {
    let none = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    records.iter().fold(none, |[low, high], record| {
        let at = record.position;
        [
            std::array::from_fn(|axis| low[axis].min(at[axis])),
            std::array::from_fn(|axis| high[axis].max(at[axis])),
        ]
    })
}

fn joined(boxes: &[[[f32; 3]; 2]]) -> [[f32; 3]; 2] {
    let none = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    boxes.iter().fold(none, |[low, high], [other_low, other_high]| {
        [
            std::array::from_fn(|axis| low[axis].min(other_low[axis])),
            std::array::from_fn(|axis| high[axis].max(other_high[axis])),
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Stream, uniform};

    fn cloud(count: usize) -> Vec<Record> {
        let mut random = Stream::Experiment.random(21, 0);
        (0..count)
            .map(|photon| Record {
                position: std::array::from_fn(|_| (8.0 * uniform(&mut random)).floor() as f32),
                photon: photon as u32,
            })
            .collect()
    }

    /// Every photon is in the tree once, in the boxes of all nodes above it, and the boxes touch what they hold.
    #[test]
    fn boxes_are_tight() {
        for count in [0, 1, 15, 16, 17, 255, 256, 257, 4095, 4097, 40_000] {
            let mut records = cloud(count);
            let tree = WideTree::build(&mut records);
            let mut photons: Vec<u32> = records.iter().map(|record| record.photon).collect();
            photons.sort_unstable();
            assert!(photons.iter().enumerate().all(|(i, &photon)| i == photon as usize));
            assert_eq!(tree.levels.last().map_or(0, Vec::len), count.min(1));
            let mut held = LANES;
            for level in &tree.levels {
                for (child, records) in records.chunks(held).enumerate() {
                    let (node, lane) = (&level[child / LANES], child % LANES);
                    let side = |sides: &[Block<f32>; 3]| sides.each_ref().map(|axis| axis.0[lane]);
                    assert_eq!([side(&node.low), side(&node.high)], box_of(records));
                }
                held *= LANES;
            }
            for (i, record) in records.iter().enumerate() {
                assert_eq!(tree.position(i as u32), record.position);
            }
        }
    }

    /// The order is that of one thread.
    #[test]
    fn the_order_does_not_depend_on_threads() {
        let order = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut records = cloud(100_000);
            pool.install(|| WideTree::build(&mut records));
            records.iter().map(|record| record.photon).collect::<Vec<u32>>()
        };
        assert_eq!(order(1), order(3));
    }
}
