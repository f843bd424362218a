//! One photon in each cell of a line, the query at random: the one jittered grid with an exact law.
//!
//! The interval of expected count u around the query cuts two cells and holds the others whole. Averaged over the
//! query, P(N(u) >= k) is the distribution function of the sum of three uniform numbers at u - (k - 2), so that for
//! k >= 2
//!
//! u_(k) = k - 2 + U_1 + U_2 + U_3 = c + w, c = k - 1/2,
//!
//! with w symmetric, E\[w^2i\] = (2 (3/2)^(2i+3) - 6 (1/2)^(2i+3)) / ((2i+1) (2i+2) (2i+3)).

/// Terms below this share of their sum no longer change it.
const NEGLIGIBLE: f64 = 1e-18;

/// What 1/u_(k) is on average.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct InverseMoments {
    /// E\[c/u\] - 1, c = k - 1/2.
    pub half_bias: f64,
    /// Var\[c/u\].
    pub half_variance: f64,
}

/// The moments of c/u_(k), k >= 2.
pub(super) fn inverse_moments(k: u64) -> InverseMoments {
    if k == 2 {
        // The series does not converge where u reaches 0: differences of u^2/2 ln u, of which 1/u is the third
        // derivative, and of -u ln u, likewise of 1/u^2.
        let (ln2, ln3) = (std::f64::consts::LN_2, 3_f64.ln());
        let (first, second) = (4.5 * ln3 - 6.0 * ln2, 6.0 * ln2 - 3.0 * ln3);
        return InverseMoments {
            half_bias: 1.5 * first - 1.0,
            half_variance: 2.25 * (second - first * first),
        };
    }
    let inverse = 1.0 / (k as f64 - 0.5);
    let (mut outer, mut inner) = (2.0 * 1.5_f64.powi(3), 6.0 * 0.5_f64.powi(3));
    let (mut sum, mut weighted) = (0.0, 0.0);
    for i in (1..).map(f64::from) {
        outer *= (1.5 * inverse).powi(2);
        inner *= (0.5 * inverse).powi(2);
        let order = 2.0 * i;
        let term = (outer - inner) / ((order + 1.0) * (order + 2.0) * (order + 3.0));
        sum += term;
        weighted += (order - 1.0) * term;
        if term * order <= NEGLIGIBLE * sum {
            break;
        }
    }
    InverseMoments { half_bias: sum, half_variance: weighted - sum * sum }
}
