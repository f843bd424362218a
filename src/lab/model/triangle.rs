//! Triangular numbers: shell x of the order models holds x photons, and all shells up to it T_x = x (x + 1) / 2.

/// The shell that holds the k-th photon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shell {
    /// Its number, and the number of its photons.
    pub x: u64,
    /// Which of them is the k-th, from 1 on.
    pub place: u64,
    /// Photons in it and all before it.
    pub end: u64,
}

impl Shell {
    /// The shell of photon k, from 1 on; `k` below 2^60.
    pub fn of(k: u64) -> Self {
        let below = ((8 * k + 1).isqrt() - 1) / 2;
        let x = if triangle(below) == k { below } else { below + 1 };
        let end = triangle(x);
        Self { x, place: x + k - end, end }
    }
}

/// T_x.
pub fn triangle(x: u64) -> u64 {
    x * (x + 1) / 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_photon_is_in_its_shell() {
        let (mut x, mut place) = (1, 1);
        for k in 1..100_000 {
            assert_eq!(Shell::of(k), Shell { x, place, end: triangle(x) }, "{k}");
            place += 1;
            if place > x {
                (x, place) = (x + 1, 1);
            }
        }
    }

    #[test]
    fn large_shells_begin_and_end_where_they_should() {
        for x in [1_000_000, 1_414_213, 1_000_000_000] {
            let end = triangle(x);
            assert_eq!(Shell::of(end), Shell { x, place: x, end });
            assert_eq!(Shell::of(end + 1), Shell { x: x + 1, place: 1, end: triangle(x + 1) });
        }
    }
}
