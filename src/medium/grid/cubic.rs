//! The density along a piece of a ray as a polynomial, its integral, and where the integral reaches a target.
//!
//! Along a straight line a trilinear density is f(u) = a + b u + c u^2 + d u^3, u in \[0, 1\]. Simpson's rule
//! (f(0) + 4 f(1/2) + f(1)) / 6 integrates it exactly, whatever d is.

/// A density over u in \[0, 1\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::medium) struct Cubic {
    /// Values at u = 0, 1/2 and 1.
    pub(in crate::medium) values: [f64; 3],
    /// Coefficient of u^3; 0 makes it the quadratic through the three values.
    pub(in crate::medium) third: f64,
}

impl Cubic {
    /// The same density everywhere.
    #[inline]
    pub(in crate::medium) fn constant(density: f64) -> Self {
        Self { values: [density; 3], third: 0.0 }
    }

    /// The integral over \[0, 1\].
    #[inline(always)]
    pub(in crate::medium) fn integral(&self) -> f64 {
        let [start, middle, end] = self.values;
        (start + 4.0 * middle + end) * (1.0 / 6.0)
    }

    /// Coefficients a, b, c, d.
    fn coefficients(&self) -> [f64; 4] {
        let [start, middle, end] = self.values;
        let (rise, half_rise) = (end - start - self.third, middle - start - self.third / 8.0);
        [start, 4.0 * half_rise - rise, 2.0 * rise - 4.0 * half_rise, self.third]
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
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
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
    const EXAMPLE: Cubic = Cubic { values: [2.0, 3.375, 4.0], third: -1.0 };

    #[test]
    fn a_cubic_integrates_exactly() {
        assert!((EXAMPLE.integral() - 3.25).abs() < 1e-15);
        for u in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let exact = 2.0 * u + 1.5 * u * u - 0.25 * u * u * u * u;
            assert!((EXAMPLE.integral_to(u) - exact).abs() < 1e-15);
        }
    }

    #[test]
    fn inversion_undoes_the_integral() {
        let rising = Cubic { values: [0.0, 0.5, 1.0], third: 0.0 };
        let late = Cubic { values: [0.0, 0.125, 1.0], third: 1.0 };
        let early = Cubic { values: [1.0, 0.125, 0.0], third: -1.0 };
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
            let cubic = Cubic { values: [2.0, 3.375, 4.0].map(|v| v * scale), third: -scale };
            assert!((cubic.invert(cubic.integral_to(0.3)) - 0.3).abs() < 1e-14);
        }
    }
}
