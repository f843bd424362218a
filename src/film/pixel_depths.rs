//! How deep a pixel looks into the medium.

/// Depths of a pixel, as sums that can be averaged over rays and passes: distances from the camera, along the rays \[m\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelDepths {
    /// Mean over rays of the distance at which the transmittance is one half; 0 counts for rays on which it never is.
    pub half_distance: f64,
    /// Share of the rays on which it is.
    pub half_share: f64,
    /// Mean over rays of the integral of distance times transmittance times sigma_s.
    pub scatter_distance: f64,
    /// The same without the distance.
    pub scatter_weight: f64,
}

impl PixelDepths {
    /// Distance at which half of the light is lost, mean over the rays on which it is; infinite where it is on none.
    pub fn half(&self) -> f64 {
        quotient(self.half_distance, self.half_share)
    }

    /// Mean distance of the first scattering that the camera sees; infinite where nothing scatters.
    pub fn scatter(&self) -> f64 {
        quotient(self.scatter_distance, self.scatter_weight)
    }

    /// Makes this, a mean, one in which another has that share.
    pub(super) fn move_towards(&mut self, other: &Self, share: f64) {
        let towards = |mean: &mut f64, value: f64| *mean += (value - *mean) * share;
        towards(&mut self.half_distance, other.half_distance);
        towards(&mut self.half_share, other.half_share);
        towards(&mut self.scatter_distance, other.scatter_distance);
        towards(&mut self.scatter_weight, other.scatter_weight);
    }

    /// Adds a share of another.
    pub fn add(&mut self, other: &Self, share: f64) {
        self.half_distance += other.half_distance * share;
        self.half_share += other.half_share * share;
        self.scatter_distance += other.scatter_distance * share;
        self.scatter_weight += other.scatter_weight * share;
    }
}

fn quotient(sum: f64, weight: f64) -> f64 {
    if weight > 0.0 { sum / weight } else { f64::INFINITY }
}
