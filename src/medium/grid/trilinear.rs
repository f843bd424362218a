//! Trilinear interpolation in one voxel cell.
//!
//! f(w) = sum over corners of c_ijk w_x^i (1-w_x)^(1-i) ..., the eight corners of a cell being the voxel
//! values at its integer corners (OpenVDB's BoxSampler). Along a straight line f is a cubic polynomial.

use super::cubic::Cubic;

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

/// The values on the line from `weight` - `half` to `weight` + `half`: the Taylor series at its middle, which
/// ends after the third order.
#[inline(always)]
pub(super) fn along(corners: &Corners, weight: [f64; 3], half: [f64; 3]) -> Cubic {
    let [x, y, z] = weight;
    let [hx, hy, hz] = half;
    let c = corners;
    // Derivatives in x and values at x, at the corners of the (y, z) square.
    let dx = [c[4] - c[0], c[5] - c[1], c[6] - c[2], c[7] - c[3]];
    let v = [c[0] + x * dx[0], c[1] + x * dx[1], c[2] + x * dx[2], c[3] + x * dx[3]];
    // Derivatives in y, values and derivatives in x at y, at both ends of z.
    let dy = [v[2] - v[0], v[3] - v[1]];
    let w = [v[0] + y * dy[0], v[1] + y * dy[1]];
    let dxy = [dx[2] - dx[0], dx[3] - dx[1]];
    let dx = [dx[0] + y * dxy[0], dx[1] + y * dxy[1]];
    let (dz, dxz, dyz, dxyz) = (w[1] - w[0], dx[1] - dx[0], dy[1] - dy[0], dxy[1] - dxy[0]);
    Cubic {
        middle: w[0] + z * dz,
        slope: hx * (dx[0] + z * dxz) + hy * (dy[0] + z * dyz) + hz * dz,
        bend: hx * hy * (dxy[0] + z * dxyz) + hz * (hx * dxz + hy * dyz),
        twist: hx * hy * hz * dxyz,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_the_values_of_the_cell() {
        let corners = [0.5, 1.5, 2.0, 0.0, 3.0, 0.25, 0.0, 5.0];
        let (weight, half) = ([0.4, 0.55, 0.3], [0.35, -0.2, 0.25]);
        let line = along(&corners, weight, half);
        for step in -4..=4 {
            let s = 0.25 * f64::from(step);
            let point = std::array::from_fn(|axis| weight[axis] + s * half[axis]);
            let value = line.middle + s * (line.slope + s * (line.bend + s * line.twist));
            assert!((value - blend(&corners, point)).abs() < 1e-14);
        }
    }
}
