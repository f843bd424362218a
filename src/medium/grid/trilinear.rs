//! Trilinear interpolation in one voxel cell.
//!
//! f(w) = sum over corners of c_ijk w_x^i (1-w_x)^(1-i) ..., the eight corners of a cell being the voxel
//! values at its integer corners (OpenVDB's BoxSampler). Along a straight line f is a cubic polynomial.

/// The eight values at a cell's corners; corner (x, y, z) is number 4x + 2y + z.
pub(super) type Corners = [f64; 8];

/// The value at `weight` in \[0, 1\]^3 of the cell.
#[inline(always)]
pub(super) fn blend(corners: &Corners, weight: [f64; 3]) -> f64 {
    let [x, y, z] = weight;
    let c = corners;
    let c0 = c[0] + x * (c[4] - c[0]);
    let c1 = c[1] + x * (c[5] - c[1]);
    let c2 = c[2] + x * (c[6] - c[2]);
    let c3 = c[3] + x * (c[7] - c[3]);
    let d0 = c0 + y * (c2 - c0);
    let d1 = c1 + y * (c3 - c1);
    d0 + z * (d1 - d0)
}

/// Coefficient of w_x w_y w_z: what makes a line's polynomial cubic.
#[inline(always)]
pub(super) fn triple_coefficient(c: &Corners) -> f64 {
    ((c[7] - c[6]) - (c[5] - c[4])) - ((c[3] - c[2]) - (c[1] - c[0]))
}
