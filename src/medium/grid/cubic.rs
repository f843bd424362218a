//! The density along a piece of a ray as a polynomial, its integral, and where the integral reaches a target.
//!
//! Along a straight line a trilinear density is a cubic polynomial. About the middle of a piece,
//! f(s) = middle + slope s + bend s^2 + twist s^3 with s in \[-1, 1\], whose mean is middle + bend / 3: Simpson's
//! rule, which is exact for cubics. Callers count from the start of the piece: u = (s + 1) / 2 in \[0, 1\].

/// A density along a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::medium) struct Cubic {
    pub(in crate::medium) middle: f64,
    pub(in crate::medium) slope: f64,
    pub(in crate::medium) bend: f64,
    pub(in crate::medium) twist: f64,
}

impl Cubic {
    /// The same density everywhere.
    #[inline]
    pub(in crate::medium) fn constant(density: f64) -> Self {
        Self { middle: density, slope: 0.0, bend: 0.0, twist: 0.0 }
    }

    /// The quadratic through the values at u = 0, 1/2 and 1.
    pub(in crate::medium) fn through([start, middle, end]: [f64; 3]) -> Self {
        let bend = 0.5 * (start + end) - middle;
        Self { middle, slope: 0.5 * (end - start), bend, twist: 0.0 }
    }

    /// The values at u = 0, 1/2 and 1; rounding does not take them below 0.
    #[inline]
    pub(in crate::medium) fn values(&self) -> [f64; 3] {
        let (even, odd) = (self.middle + self.bend, self.slope + self.twist);
        [even - odd, self.middle, even + odd].map(|value| if value > 0.0 { value } else { 0.0 })
    }

    /// The integral over u in \[0, 1\].
    #[inline(always)]
    pub(in crate::medium) fn integral(&self) -> f64 {
        self.middle + self.bend * (1.0 / 3.0)
    }

    /// Coefficients of 1, u, u^2, u^3.
    fn coefficients(&self) -> [f64; 4] {
        let Self { middle, slope, bend, twist } = *self;
        [
            middle - slope + bend - twist,
            2.0 * (slope - 2.0 * bend + 3.0 * twist),
            4.0 * (bend - 3.0 * twist),
            8.0 * twist,
        ]
    }

    /// The integral over \[0, `end`\].
    pub(in crate::medium) fn integral_to(&self, end: f64) -> f64 {
        integral(self.coefficients(), end)
    }

    /// The u at which the integral from 0 reaches `target`, in \[0, 1\]: Newton's method inside a bracket.
    pub(in crate::medium) fn invert(&self, target: f64) -> f64 {
        let total = self.integral();
        if target >= total {
            return 1.0;
        }
        if target <= 0.0 {
            return 0.0;
        }
        let coefficients = self.coefficients();
        let (mut low, mut high) = (0.0, 1.0);
        let mut u = target / total;
        // Bisection alone would take 53 steps; Newton's takes 3 to 6.
        for _ in 0..64 {
            let excess = integral(coefficients, u) - target;
            if excess > 0.0 {
                high = u;
            } else {
                low = u;
            }
            let newton = u - excess / value(coefficients, u);
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            let step = (next - u).abs();
            u = next;
            if step <= 1e-15 || high - low <= f64::EPSILON * high {
                break;
            }
        }
        u
    }
}

fn value([a, b, c, d]: [f64; 4], u: f64) -> f64 {
    a + u * (b + u * (c + u * d))
}

fn integral([a, b, c, d]: [f64; 4], u: f64) -> f64 {
    u * (a + u * (b / 2.0 + u * (c / 3.0 + u * (d / 4.0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (2 - u)(1 + u)^2 = 2 + 3u - u^3; its integral is 2u + 3/2 u^2 - u^4/4.
    const EXAMPLE: Cubic = Cubic { middle: 3.375, slope: 1.125, bend: -0.375, twist: -0.125 };

    #[test]
    fn a_cubic_integrates_exactly() {
        assert_eq!(EXAMPLE.values(), [2.0, 3.375, 4.0]);
        assert!((EXAMPLE.integral() - 3.25).abs() < 1e-15);
        for u in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let exact = 2.0 * u + 1.5 * u * u - 0.25 * u * u * u * u;
            assert!((EXAMPLE.integral_to(u) - exact).abs() < 1e-15);
        }
    }

    #[test]
    fn a_quadratic_goes_through_its_values() {
        let values = [1.0, 0.25, 2.0];
        assert_eq!(Cubic::through(values).values(), values);
        assert!((Cubic::through(values).integral() - 4.0 / 6.0).abs() < 1e-15);
    }

    #[test]
    fn inversion_undoes_the_integral() {
        let rising = Cubic::through([0.0, 0.5, 1.0]);
        // u^3 and (1 - u)^3.
        let late = Cubic { middle: 0.125, slope: 0.375, bend: 0.375, twist: 0.125 };
        let early = Cubic { middle: 0.125, slope: -0.375, bend: 0.375, twist: -0.125 };
        for cubic in [EXAMPLE, rising, late, early, Cubic::constant(3.0)] {
            for step in 0..=1000 {
                let u = f64::from(step) / 1000.0;
                let found = cubic.invert(cubic.integral_to(u));
                let reached = cubic.integral_to(found);
                assert!((reached - cubic.integral_to(u)).abs() <= 4e-15, "{cubic:?} {u}");
            }
        }
        assert_eq!(EXAMPLE.invert(-1.0), 0.0);
        assert_eq!(EXAMPLE.invert(f64::INFINITY), 1.0);
    }

    #[test]
    fn tiny_and_huge_densities_invert_too() {
        for scale in [1e-300, 1e-30, 1e30, 1e300] {
            let cubic = Cubic::through([2.0, 3.375, 4.0].map(|value| value * scale));
            assert!((cubic.invert(cubic.integral_to(0.3)) - 0.3).abs() < 1e-14);
        }
    }
}
