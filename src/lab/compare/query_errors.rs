//! What k-nearest estimates get wrong at the queries of one map.

use std::num::NonZeroUsize;

use super::analytic::AnalyticScene;
use super::photon_maps::AskedMap;
use crate::lab::error::LabError;
use crate::lab::experiment::Moments;
use crate::map::NearestPhotons;
use crate::math::{DVec3, Random};

/// Counts are taken in two balls about that of k photons, this factor apart each, to see how their variance grows.
pub(super) const COUNT_STEP: f64 = 1.25;

/// Errors of the estimate from k photons, in one map or several.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct QueryErrors {
    /// k / u - 1; where photons differ in power, power found over power expected - 1.
    pub(super) intrinsic: Moments,
    /// Ball mean over value - 1.
    pub(super) smoothing: Moments,
    /// Power found / (V p) - 1.
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

/// A photon near a query.
#[derive(Clone, Copy, Debug)]
struct FoundPhoton {
    /// \[m\]
    distance: f64,
    /// \[W\]
    power: f64,
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
        map: &AskedMap,
        count: u64,
        random: &mut Random,
    ) -> Result<Vec<QueryErrors>, LabError> {
        let mut finder = NearestPhotons::new(&map.photons);
        let mut errors = vec![QueryErrors::default(); self.ks.len()];
        let mut around = Vec::new();
        for _ in 0..count {
            let place = self.scene.sample_query(random);
            self.look_around(place, &mut finder, &mut around);
            for (&k, errors) in self.ks.iter().zip(&mut errors) {
                self.add(place, k, map.mean_power, &around, errors)
                    .ok_or_else(|| self.too_few(k))?;
            }
        }
        Ok(errors)
    }

    /// All photons that the largest k needs, and some beyond, the nearest first.
    fn look_around(
        &self,
        place: DVec3,
        finder: &mut NearestPhotons<'_>,
        around: &mut Vec<FoundPhoton>,
    ) {
        let largest = self.ks.last().copied().unwrap_or(1);
        let wanted = NonZeroUsize::new(photons_sought(largest) as usize);
        let map = finder.map();
        let unit = map.frame().unit;
        let found = finder.find(place, wanted.unwrap_or(NonZeroUsize::MIN), self.reach);
        around.clear();
        around.extend(found.iter().map(|(photon, square)| FoundPhoton {
            distance: f64::from(square).sqrt() * unit,
            power: f64::from(map.power(photon)[0]),
        }));
        around.sort_unstable_by(|a, b| {
            a.distance.total_cmp(&b.distance).then(a.power.total_cmp(&b.power))
        });
    }

    fn add(
        &self,
        place: DVec3,
        k: u64,
        mean_power: f64,
        around: &[FoundPhoton],
        errors: &mut QueryErrors,
    ) -> Option<()> {
        let scene = self.scene;
        let nearest = around.get(..k as usize)?;
        let radius = nearest.last()?.distance;
        let power: f64 = nearest.iter().map(|photon| photon.power).sum();
        errors.intrinsic.add(power / scene.ball_power(place, radius) - 1.0);
        errors.smoothing.add(scene.smoothing(place, radius));
        let expected = scene.ball_volume(place, radius) * scene.power_density(place);
        errors.total.add(power / expected - 1.0);
        for (step, counts) in [1.0 / COUNT_STEP, COUNT_STEP].into_iter().zip(&mut errors.counts) {
            let expected = step * k as f64;
            let radius = scene.ball_radius(place, expected * mean_power)?;
            let count = around.partition_point(|photon| photon.distance < radius);
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
