//! The unbiased numerator, from how the number of photons in a ball of fixed radius varies.
//!
//! Let N(u) be the number of photons in the ball where u are expected, V(u) its variance. The k-th photon lies beyond
//! that ball where N(u) < k, so that the law of u_k, and with it E\[1/u_k\], is that of N. Only whole numbers occur; read
//! half-way between two of them, at t = k - 1/2, an expansion in the moments of N about u gives
//!
//! E\[1/u_k\] = 1/t - ((V - 1/12) t^-2)' / 2 + (m_3 t^-2)'' / 6 - (m_4 t^-2)''' / 24 + ...
//!
//! with m_3 and m_4 the third and fourth central moments and derivatives by t; 1/12 is what whole numbers add to a
//! variance. Let V grow as u^p about k. Of cells, shells and the like it is the surface of the ball that makes V, and as
//! many photons too few as too many, m_3 = 0; of photons independent or in clumps it is the inside, m_3 = V^2 / u as of
//! clumps of V / u. In space the one has p = 2/3 and the other p = 1; between them m_3 = b V^2 / u, b = 3p - 2, and 0 below.
//! With m_4 = 3 V^2 the constant c = 1 / E\[1/u_k\] becomes
//!
//! c = t - (1 - p/2) v + (1/12 - q v^2) / t,      v = V(t) / t,
//! q = b (2p-3)(2p-4)/6 - (2p-2)(2p-3)(2p-4)/8 - (1-p/2)^2.
//!
//! For independent photons, V = u, this is k - 1 exactly; for one photon in each of concentric shells, where V = 1/6 on
//! average, k - 1/2 - 1/(12 t), right to the third term; in cubic cells it leaves 1 % of the bias of k from k = 3 on. Its first two
//! terms alone are the law that E\[k/u_k\] = k / (k - 1/2 - V/k + V'/2).

/// How the number of photons in balls varies, about the ball where k are expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CountLaw {
    /// Variance of the number where k photons are expected.
    pub variance: f64,
    /// The power of the expected number with which it grows: 1 of independent photons, 2/3 of one a cell in space.
    pub exponent: f64,
}

impl CountLaw {
    /// The law that passes through the variances where `k / step` and `k step` photons are expected.
    pub fn through(variances: [f64; 2], step: f64) -> Self {
        let [fewer, more] = variances;
        Self { variance: (fewer * more).sqrt(), exponent: (more / fewer).ln() / (2.0 * step.ln()) }
    }

    /// The c for which c / u_k has no bias, for k from 2 on. It is kept between (k - 1) / 2, below which photons lie in
    /// clumps beyond what the law tells of, and k.
    pub fn constant(self, k: f64) -> f64 {
        let t = k - 0.5;
        let p = self.exponent;
        let ratio = self.variance / k * (t / k).powf(p - 1.0);
        let first = 1.0 - 0.5 * p;
        let (a, b, c) = (2.0 * p - 2.0, 2.0 * p - 3.0, 2.0 * p - 4.0);
        let inside = (3.0 * p - 2.0).max(0.0);
        let second = inside * b * c / 6.0 - a * b * c / 8.0 - first * first;
        let constant = t - first * ratio + (1.0 / 12.0 - second * ratio * ratio) / t;
        constant.clamp(0.5 * (k - 1.0), k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn independent_photons_count_as_one_less() {
        for k in [2.0, 3.0, 10.0, 1e6] {
            let c = CountLaw { variance: k, exponent: 1.0 }.constant(k);
            assert!((c - (k - 1.0)).abs() < 1e-14 * k, "{k}: {c}");
        }
    }

    /// One photon a shell: c = 1 / ln(k / (k - 1)).
    #[test]
    fn shells_are_met_to_the_third_order() {
        for k in [5.0_f64, 10.0, 100.0] {
            let c = CountLaw { variance: 1.0 / 6.0, exponent: 0.0 }.constant(k);
            let exact = 1.0 / (k / (k - 1.0)).ln();
            assert!((c - exact).abs() < 0.1 / (k * k), "{k}: {c} {exact}");
        }
    }

    /// One photon a cubic cell, V = 0.8 u^(2/3): against k / 1.3922, 1.1884, 1.0793 and 1.0358, as simulated with standard
    /// errors of 0.0014, 0.0007, 0.0004 and 0.0002.
    #[test]
    fn cubic_cells_are_met_from_few_photons_on() {
        for (k, mean, error) in [
            (3.0, 1.3922, 0.005),
            (5.0, 1.1884, 0.003),
            (10.0, 1.0793, 0.001),
            (20.0, 1.0358, 0.0005),
        ] {
            let k: f64 = k;
            let counts = CountLaw { variance: 0.8 * k.powf(2.0 / 3.0), exponent: 2.0 / 3.0 };
            let c = counts.constant(k);
            assert!((k / c - mean).abs() < error, "{k}: {c}, mean {}", k / c);
        }
    }

    #[test]
    fn a_power_is_found_from_two_of_its_values() {
        let law = CountLaw::through([2.0, 2.0 * 2.25_f64.powf(0.7)], 1.5);
        assert!((law.exponent - 0.7).abs() < 1e-14);
        assert!((law.variance - 2.0 * 1.5_f64.powf(0.7)).abs() < 1e-14);
    }

    #[test]
    fn clumps_and_none_at_all_stay_within_bounds() {
        assert_eq!(CountLaw { variance: 1e4, exponent: 1.0 }.constant(10.0), 4.5);
        assert!(CountLaw { variance: 0.0, exponent: 1.0 }.constant(10.0) < 10.0);
    }
}
