//! Running sums of an estimator's deviations, and what follows from them: mean, variance, their errors.

/// Sums of powers of deviations from the true value, which lie close enough to the mean for nothing to cancel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    count: u64,
    sums: [f64; 4],
}

impl Moments {
    /// Adds a deviation, estimate - truth.
    #[inline]
    pub fn add(&mut self, deviation: f64) {
        self.count += 1;
        let mut power = 1.0;
        for sum in &mut self.sums {
            power *= deviation;
            *sum += power;
        }
    }

    /// The moments of both samples together.
    pub fn merge(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            sums: std::array::from_fn(|power| self.sums[power] + other.sums[power]),
        }
    }

    /// Size of the sample.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Mean deviation: the bias.
    pub fn bias(&self) -> f64 {
        self.sums[0] / self.count as f64
    }

    /// Variance of the sample's population, unbiased; 0 of a sample of one.
    pub fn variance(&self) -> f64 {
        let count = self.count as f64;
        let squares = self.sums[1] - self.sums[0] * self.bias();
        if self.count > 1 { (squares / (count - 1.0)).max(0.0) } else { 0.0 }
    }

    /// Standard error of the mean.
    pub fn std_error(&self) -> f64 {
        (self.variance() / self.count as f64).sqrt()
    }

    /// Standard error of the variance, from the fourth central moment.
    pub fn variance_std_error(&self) -> f64 {
        let count = self.count as f64;
        let [m1, m2, m3, m4] = self.sums.map(|sum| sum / count);
        let fourth = m4 - 4.0 * m3 * m1 + 6.0 * m2 * m1 * m1 - 3.0 * m1.powi(4);
        ((fourth - self.variance().powi(2)).max(0.0) / count).sqrt()
    }

    /// Mean squared deviation from the truth.
    pub fn mean_squared_error(&self) -> f64 {
        self.sums[1] / self.count as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_sample_has_the_moments_of_its_formulae() {
        let sample = [0.5, -0.25, 0.75, 0.0];
        let mut moments = Moments::default();
        let mut halves = [Moments::default(); 2];
        for (index, &deviation) in sample.iter().enumerate() {
            moments.add(deviation);
            halves[index / 2].add(deviation);
        }
        let variance = sample.map(|d| (d - 0.25_f64).powi(2)).iter().sum::<f64>() / 3.0;
        let fourth = sample.map(|d| (d - 0.25_f64).powi(4)).iter().sum::<f64>() / 4.0;
        assert_eq!(moments.bias(), 0.25);
        assert!((moments.variance() - variance).abs() < 1e-15);
        assert!((moments.std_error() - (variance / 4.0).sqrt()).abs() < 1e-15);
        let expected = ((fourth - variance * variance).max(0.0) / 4.0).sqrt();
        assert!((moments.variance_std_error() - expected).abs() < 1e-15);
        assert_eq!(halves[0].merge(halves[1]), moments);
    }
}
