//! The shells of the stratified models: how many photons lie in each, and how.

use crate::lab::model::{Model, Shell};

/// A shell and its photons. Measures are expected photon counts u; radii are u^(1/power).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PhotonShell {
    /// Where it begins, radius.
    pub inner: f64,
    /// Where it ends, radius.
    pub outer: f64,
    /// Photons in it.
    pub count: u64,
    /// u = radius^power: photons are uniform in the radius, which for power 1 is u itself.
    pub power: i32,
}

impl PhotonShell {
    fn new(begin: u64, end: u64, power: i32) -> Self {
        let radius = |u: u64| (u as f64).powf(1.0 / f64::from(power));
        Self { inner: radius(begin), outer: radius(end), count: end - begin, power }
    }

    /// u of a photon at the fraction `at` of the way from the inner radius to the outer one.
    #[inline]
    pub(super) fn measure(&self, at: f64) -> f64 {
        (self.inner + (self.outer - self.inner) * at).powi(self.power)
    }
}

/// The shell that holds the k-th photon, and which of its photons that is, from 1 on; none for models without
/// shells.
pub(super) fn shell_of(model: Model, n: u64, k: u64) -> Option<(PhotonShell, u64)> {
    let triangular = Shell::of(k);
    let order = |power| {
        let begin = triangular.end - triangular.x;
        (PhotonShell::new(begin, triangular.end, power), triangular.place)
    };
    match model {
        // Mirrored at the query, parts lie in pairs, after half a part of one photon where n is odd.
        Model::Stratified if !n.is_multiple_of(2) && k == 1 => Some((PhotonShell::new(0, 1, 1), 1)),
        Model::Stratified if n.is_multiple_of(2) == k.is_multiple_of(2) => {
            Some((PhotonShell::new(k - 2, k, 1), 2))
        }
        Model::Stratified => Some((PhotonShell::new(k - 1, k + 1, 1), 1)),
        Model::Basic(_) => Some((PhotonShell::new(k - 1, k, 1), 1)),
        Model::Order(dimension) => Some(order(dimension as i32)),
        Model::OrderVolume(_) => Some(order(1)),
        Model::Random(_) | Model::FirstApproximation | Model::FixedRadius | Model::Jittered(_) => {
            None
        }
    }
}
