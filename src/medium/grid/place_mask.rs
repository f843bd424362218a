//! A set of the 16^3 places of bricks in a region, as bits.

/// Places in a region.
pub(super) const PLACE_COUNT: usize = 4096;
const WORDS: usize = PLACE_COUNT / 64;
/// Words a layer of x.
const LAYER: usize = 4;

/// A set of places; place (x, y, z) is number 256x + 16y + z, and bit `number % 64` of word `number / 64`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PlaceMask([u64; WORDS]);

impl PlaceMask {
    /// No place.
    pub(super) const EMPTY: Self = Self([0; WORDS]);

    /// Adds a place.
    pub(super) fn insert(&mut self, place: usize) {
        self.0[place >> 6] |= 1 << (place & 63);
    }

    /// Adds the places of another set.
    pub(super) fn unite(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(word, other)| *word |= other);
    }

    /// Keeps the places for which `keeps` holds.
    pub(super) fn retain(&mut self, keeps: impl Fn(usize) -> bool) {
        let mut kept = Self::EMPTY;
        self.places().filter(|&place| keeps(place)).for_each(|place| kept.insert(place));
        *self = kept;
    }

    /// Whether there is no place.
    pub(super) fn is_empty(&self) -> bool {
        self.0 == [0; WORDS]
    }

    /// Number of places.
    pub(super) fn len(&self) -> usize {
        self.0.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// The places in ascending order.
    pub(super) fn places(&self) -> impl Iterator<Item = usize> {
        self.0.iter().enumerate().flat_map(|(number, &word)| {
            std::iter::successors((word != 0).then_some(word), |rest| {
                let rest = rest & (rest - 1);
                (rest != 0).then_some(rest)
            })
            .map(move |rest| number << 6 | rest.trailing_zeros() as usize)
        })
    }

    /// Whether a place is in the set, and how many lower ones of its word are.
    pub(super) fn find(&self, place: usize) -> (bool, usize) {
        let (word, bit) = (self.0[place >> 6], 1 << (place & 63));
        (word & bit != 0, (word & (bit - 1)).count_ones() as usize)
    }

    /// How many places there are in the words before each.
    pub(super) fn ranks(&self) -> [u16; WORDS] {
        let mut before = 0;
        self.0.map(|word| {
            let rank = before;
            before += word.count_ones() as u16;
            rank
        })
    }

    /// Every place moved down by one on an axis: those that stay in the region, and those that leave it for
    /// the lower neighbour, in whose numbers they are.
    pub(super) fn lowered(&self, axis: usize) -> (Self, Self) {
        let (mut inner, mut outer) = (Self::EMPTY, Self::EMPTY);
        for (number, &word) in self.0.iter().enumerate() {
            match axis {
                0 if number >= LAYER => inner.0[number - LAYER] = word,
                0 => outer.0[WORDS - LAYER + number] = word,
                // Four rows of y a word.
                1 => {
                    inner.0[number] |= word >> 16;
                    let target = if number % LAYER == 0 { &mut outer } else { &mut inner };
                    target.0[(number + LAYER - 1) % LAYER + number / LAYER * LAYER] |= word << 48;
                }
                _ => {
                    inner.0[number] = word >> 1 & 0x7fff_7fff_7fff_7fff;
                    outer.0[number] = word << 15 & 0x8000_8000_8000_8000;
                }
            }
        }
        (inner, outer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_lowered_into_their_region_or_its_neighbour() {
        for place in [[0, 0, 0], [15, 15, 15], [3, 4, 5], [1, 0, 15], [0, 3, 0], [7, 8, 0]] {
            let number = |[x, y, z]: [usize; 3]| x << 8 | y << 4 | z;
            let mut mask = PlaceMask::EMPTY;
            mask.insert(number(place));
            for axis in 0..3 {
                let mut expected = place;
                expected[axis] = (place[axis] + 15) % 16;
                let (inner, outer) = mask.lowered(axis);
                let (full, empty) = if place[axis] == 0 { (outer, inner) } else { (inner, outer) };
                assert_eq!(full.places().collect::<Vec<_>>(), [number(expected)], "{place:?}");
                assert!(empty.is_empty(), "{place:?}");
            }
        }
    }

    #[test]
    fn places_are_found_by_rank() {
        let mut mask = PlaceMask::EMPTY;
        let places = [0, 5, 63, 64, 1000, 1001, 4095];
        places.into_iter().for_each(|place| mask.insert(place));
        let ranks = mask.ranks();
        for (rank, place) in places.into_iter().enumerate() {
            let (is_in, before) = mask.find(place);
            assert_eq!((is_in, usize::from(ranks[place >> 6]) + before), (true, rank));
        }
        assert!(!mask.find(6).0);
        assert_eq!((mask.len(), mask.places().count()), (7, 7));
        mask.retain(|place| place > 999);
        assert_eq!(mask.places().collect::<Vec<_>>(), [1000, 1001, 4095]);
    }
}
