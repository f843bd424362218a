//! What a way of emission saves over the random one: photons and processor time to the same error.

use serde::Serialize;

/// Photons and seconds that random emission needs for the error of this one, over those that this one needs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Saving {
    /// Name of the way of emission.
    pub emission: &'static str,
    /// Photons of the estimate.
    pub k: u64,
    /// Of photons, in the same ball.
    pub photons: f64,
    /// Of processor time; `None` where the system does not tell it. A map's time is taken to grow as its photons.
    pub seconds: Option<f64>,
}

impl Saving {
    /// Of one way of emission over another, that takes `photons` times as many photons to the same error. Times are those
    /// of maps of equally many photons, this one's and the other's \[s\].
    pub(super) fn new(
        emission: &'static str,
        k: u64,
        photons: f64,
        seconds: Option<f64>,
        other_seconds: Option<f64>,
    ) -> Self {
        let slower = other_seconds.zip(seconds).map(|(other, own)| other / own);
        Self { emission, k, photons, seconds: slower.map(|slower| photons * slower) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_count_how_long_photons_take() {
        let saving = Saving::new("stratified", 50, 4.5, Some(1.1), Some(1.0));
        assert!(saving.seconds.is_some_and(|seconds| (seconds - 4.5 / 1.1).abs() < 1e-15));
        assert_eq!(Saving::new("sobol", 2, 3.0, None, Some(1.0)).seconds, None);
    }
}
