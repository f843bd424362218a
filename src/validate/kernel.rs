//! Densities at a place of a line from points about it.
//!
//! K(x) = 3/8 (3 - 5 x^2) on \[-1, 1\] has no second moment: what it reads is off by 0.0036 w^4 f'''' for a half-width w, where
//! counting in a bin would be off by w^2 f'' / 6. At an end of the line, 4 - 6 x on \[0, 1\] reads every straight line exactly.

/// Weight of a point at `position` in the density at `place`, from both sides within `width`.
pub(super) fn centered(position: f64, place: f64, width: f64) -> f64 {
    let x = (position - place) / width;
    if x.abs() < 1.0 { 0.375 * (3.0 - 5.0 * x * x) / width } else { 0.0 }
}

/// Weight of a point so far inside an end of the line in the density at that end.
pub(super) fn at_end(inside: f64, width: f64) -> f64 {
    let x = inside / width;
    if x < 1.0 { (4.0 - 6.0 * x) / width } else { 0.0 }
}
