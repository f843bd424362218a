//! One entry of the brick index: a uniform density, a graded block, or a child, in 32 bits.
//!
//! Densities are finite and not negative, so the sign bit of a uniform density is free to tell the
//! kinds apart.

/// A packed [`Node`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot(u32);

/// What fills a node of the index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Node {
    /// The same density at every point of the node.
    Uniform(f32),
    /// Constant voxels that blend into other constants across the node's upper faces: number of the
    /// graded block.
    Graded(usize),
    /// Number of the node's table of bricks, or of the brick's values.
    Child(usize),
}

const CHILD: u32 = 0x8000_0000;
const GRADED: u32 = 0xC000_0000;
const NUMBER: u32 = 0x3FFF_FFFF;

/// The largest number that fits in a slot.
pub(super) const MAX_CHILDREN: usize = NUMBER as usize;

impl Slot {
    /// No density.
    pub(super) const EMPTY: Self = Self(0);

    /// The same density everywhere; it must be finite and not negative.
    pub(super) fn uniform(density: f32) -> Self {
        Self(density.to_bits() & !CHILD)
    }

    /// The child of this number, at most [`MAX_CHILDREN`].
    pub(super) fn child(number: usize) -> Self {
        Self(CHILD | (number as u32 & NUMBER))
    }

    /// The graded block of this number, at most [`MAX_CHILDREN`].
    pub(super) fn graded(number: usize) -> Self {
        Self(GRADED | (number as u32 & NUMBER))
    }

    /// Unpacks.
    #[inline]
    pub(super) fn node(self) -> Node {
        if self.0 & CHILD == 0 {
            Node::Uniform(f32::from_bits(self.0))
        } else if self.0 & GRADED == CHILD {
            Node::Child((self.0 & NUMBER) as usize)
        } else {
            Node::Graded((self.0 & NUMBER) as usize)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_unpack_to_what_was_packed() {
        for density in [0.0, -0.0, 1e-45, 1.0, f32::MAX] {
            assert_eq!(Slot::uniform(density).node(), Node::Uniform(density.abs()));
        }
        for number in [0, 1, (1 << 30) - 1] {
            assert_eq!(Slot::child(number).node(), Node::Child(number));
            assert_eq!(Slot::graded(number).node(), Node::Graded(number));
        }
        assert_eq!(Slot::EMPTY, Slot::uniform(0.0));
    }
}
