//! What theory says of k / u, and what is read from it.
//!
//! The mean follows from how the number of photons in balls varies: [`CountLaw`].

use crate::estimate::CountLaw;

/// E\[k/u\] - 1 where the number of photons in the ball varies so.
pub(super) fn bias_from_counts(k: f64, counts: CountLaw) -> f64 {
    k / counts.constant(k) - 1.0
}

/// Mean squared error of k / u among independent photons, where u is a gamma variate of shape k; infinite up to k = 2.
pub(super) fn random_error(k: f64) -> f64 {
    if k <= 2.0 {
        return f64::INFINITY;
    }
    (1.0 + k * k / (k - 2.0)) / (k - 1.0).powi(2)
}

/// The k at which independent photons have this mean squared error.
pub(super) fn random_k(error: f64) -> f64 {
    let (mut low, mut high) = (2.0, 4.0);
    while random_error(high) > error && high < 1e15 {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if random_error(middle) > error {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Quantile 0.975 of Student's t with `freedom` degrees of freedom, by Cornish and Fisher's expansion: to 1 % from 6 on, too small
/// below.
pub(in crate::lab) fn student_quantile(freedom: f64) -> f64 {
    let z: f64 = 1.959_963_984_540_054;
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    z + first / freedom + second / (freedom * freedom)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::jitter::JitterLaw;

    #[test]
    fn known_values() {
        let random = CountLaw { variance: 10.0, exponent: 1.0 };
        assert!((bias_from_counts(10.0, random) - 1.0 / 9.0).abs() < 1e-15);
        // The law of cells has the same first two terms.
        let law = JitterLaw::new(3);
        for k in [10.0, 100.0] {
            let jittered = bias_from_counts(k, law.counts(k));
            assert!((jittered / law.bias(k) - 1.0).abs() < 0.02 * (10.0 / k), "{k}: {jittered}");
        }
        for k in [3.0, 17.5, 1e4] {
            assert!((random_k(random_error(k)) / k - 1.0).abs() < 1e-12);
        }
        // Tables: 2.0395 for 31 degrees, 2.262 for 9.
        assert!((student_quantile(31.0) - 2.0395).abs() < 2e-4);
        assert!((student_quantile(9.0) - 2.2622).abs() < 5e-3);
    }
}
