//! What k-nearest estimates get wrong at the queries of one map.

use std::num::NonZeroUsize;

use super::analytic::{AnalyticScene, ball_volume};
use crate::lab::error::LabError;
use crate::lab::experiment::Moments;
use crate::map::{NearestPhotons, PhotonMap};
use crate::math::square_maps::square_to_sphere;
use crate::math::{DVec2, DVec3, Random, uniform};

/// Distances of queries from the light reach so far from 1 m: over several strata, so that no one lattice is measured.
pub(super) const SPREAD: f64 = 0.05;

/// Counts are taken in two balls about that of k photons, this factor apart each, to see how their variance grows.
pub(super) const COUNT_STEP: f64 = 1.25;

/// Errors of the estimate from k photons, in one map or several.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct QueryErrors {
    /// k / u - 1.
    pub(super) intrinsic: Moments,
    /// Ball mean over value - 1.
    pub(super) smoothing: Moments,
    /// k / (n V p) - 1.
    pub(super) total: Moments,
    /// Photons less than expected, in the balls where k / [`COUNT_STEP`] and k [`COUNT_STEP`] are.
    pub(super) counts: [Moments; 2],
}

impl QueryErrors {
    /// The errors of both together.
    pub(super) fn merge(self, other: Self) -> Self {
        Self {
            intrinsic: self.intrinsic.merge(other.intrinsic),
            smoothing: self.smoothing.merge(other.smoothing),
            total: self.total.merge(other.total),
            counts: [self.counts[0].merge(other.counts[0]), self.counts[1].merge(other.counts[1])],
        }
    }
}

/// Queries a map.
pub(super) struct Queries<'a> {
    pub(super) scene: AnalyticScene,
    pub(super) photon_count: u64,
    /// Ascending.
    pub(super) ks: &'a [u64],
    /// No query looks farther \[m\].
    pub(super) reach: f64,
}

impl Queries<'_> {
    /// Errors of each k over `count` queries at random places.
    ///
    /// # Errors
    /// A query finds too few photons.
    pub(super) fn run(
        &self,
        map: &PhotonMap,
        count: u64,
        random: &mut Random,
    ) -> Result<Vec<QueryErrors>, LabError> {
        let mut finder = NearestPhotons::new(map);
        let mut errors = vec![QueryErrors::default(); self.ks.len()];
        let mut distances = Vec::new();
        for _ in 0..count {
            let distance = 1.0 + SPREAD * (2.0 * uniform(random) - 1.0);
            let direction = square_to_sphere(DVec2::new(uniform(random), uniform(random)));
            self.look_around(distance * direction, &mut finder, &mut distances);
            for (&k, errors) in self.ks.iter().zip(&mut errors) {
                self.add(distance, k, &distances, errors).ok_or_else(|| self.too_few(k))?;
            }
        }
        Ok(errors)
    }

    /// Ascending distances of all photons that the largest k needs, and of some beyond \[m\].
    fn look_around(&self, place: DVec3, finder: &mut NearestPhotons<'_>, distances: &mut Vec<f64>) {
        let largest = self.ks.last().copied().unwrap_or(1);
        let wanted = NonZeroUsize::new(photons_sought(largest) as usize);
        let unit = finder.map().frame().unit;
        let found = finder.find(place, wanted.unwrap_or(NonZeroUsize::MIN), self.reach);
        let to_distance = |square: f32| f64::from(square).sqrt() * unit;
        distances.clear();
        distances.extend(found.photons.iter().map(|n| to_distance(n.distance_squared)));
        distances.sort_unstable_by(f64::total_cmp);
    }

    fn add(
        &self,
        distance: f64,
        k: u64,
        distances: &[f64],
        errors: &mut QueryErrors,
    ) -> Option<()> {
        let radius = *distances.get(k as usize - 1)?;
        let photons = self.photon_count as f64;
        let expected = photons * self.scene.ball_power(distance, radius);
        errors.intrinsic.add(k as f64 / expected - 1.0);
        errors.smoothing.add(self.scene.smoothing(distance, radius));
        let at_query = photons * ball_volume(radius) * self.scene.power_density(distance);
        errors.total.add(k as f64 / at_query - 1.0);
        for (step, counts) in [1.0 / COUNT_STEP, COUNT_STEP].into_iter().zip(&mut errors.counts) {
            let expected = step * k as f64;
            let radius = self.scene.ball_radius(distance, expected / photons)?;
            let count = distances.partition_point(|&distance| distance < radius);
            counts.add(count as f64 - expected);
        }
        Some(())
    }

    fn too_few(&self, k: u64) -> LabError {
        LabError::BallTooLarge { k, n: self.photon_count }
    }
}

/// How many photons are looked for, so that balls of fixed radius about the largest k are filled, too: six standard
/// deviations of a Poisson number more.
pub(super) fn photons_sought(largest_k: u64) -> u64 {
    let expected = COUNT_STEP * largest_k as f64;
    (expected + 6.0 * expected.sqrt() + 10.0).ceil() as u64
}
