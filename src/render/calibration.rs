//! The divisor `calibrated`: the numerator without bias, measured from photons like those of the map.
//!
//! [`CountLaw`] asks for the variance V of the number N of photons in the balls of estimates. Photons are emitted
//! independently of each other, each in its stratum, so that N = sum_i N_i over emitted photons and
//!
//! V = sum_i E\[N_i^2\] - (E N_i)^2 = u + sum_i E\[N_i (N_i - 1)\] - sum_i E\[N_i N'_i\],
//!
//! with N'_i the same photon drawn anew in its stratum: pairs of collisions in one ball, those of one path less those of
//! a path and its twin. Siblings raise V above that of independent photons, as in thick media; twins lower it, as they
//! meet where strata are smaller than the ball. A pair at distance s shares a share
//! 1 - (3/2) x + x^3 / 2, x = s / 2r, of the balls of radius r that hold one of them. A few thousand photons of the emission drawn twice
//! thus tell V of the whole map, at the radii that its own k-th photons have, and far more precisely than counts in
//! balls of as many photons would.
//!
//! Points of a Sobol sequence depend on each other: strata of as many photons stand in for them. They vary more than the
//! points do, so that c comes out low: about a point light by a fifth of the bias of `k`.

use std::num::NonZeroUsize;

use rayon::prelude::*;

use crate::emission::Emission;
use crate::estimate::CountLaw;
use crate::map::{NearestPhotons, PhotonMap};
use crate::math::{Random, Stream, uniform};
use crate::medium::{Extinction, Medium};
use crate::trace::{Photon, TraceSettings, trace_paths};

/// Emitted photons drawn anew, twice each; fewer where there are fewer.
const PAIR_COUNT: u64 = 4096;

/// Independent groups of them, from which the standard error comes.
const GROUP_COUNT: u64 = 32;

/// Collisions of a path about which pairs are sought.
const PLACES_PER_PATH: usize = 4;

/// V is read in balls so many times smaller and larger than that of k photons.
const STEP: f64 = 1.5;

/// The least V / u that is told from 0.
const LEAST_RATIO: f64 = 1e-3;

/// A numerator as measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// What k equal photons count as.
    pub constant: f64,
    /// Its standard error.
    pub std_error: f64,
    /// How the number of photons in the ball of k varies.
    pub law: CountLaw,
}

/// Photons to calibrate with, and the map that is read.
pub(super) struct Calibrator<'a, E> {
    /// Independent photons, as many as the map's.
    pub(super) emission: &'a Emission<'a>,
    pub(super) medium: &'a Medium,
    pub(super) extinction: &'a E,
    pub(super) settings: TraceSettings,
    pub(super) map: &'a PhotonMap,
    /// Photons of an estimate.
    pub(super) k: NonZeroUsize,
    /// Largest radius of a query \[m\].
    pub(super) max_radius: f64,
}

impl<E: Extinction> Calibrator<'_, E> {
    /// Measures; where there are no photons, as if they were independent.
    pub(super) fn calibrate(&self, seed: u64) -> Calibration {
        let seed = Stream::Calibration.hash(seed, 0);
        let groups: Vec<PairSums> =
            (0..GROUP_COUNT).into_par_iter().map(|group| self.measure(group, seed)).collect();
        let all = groups.iter().fold(PairSums::default(), |sum, group| sum.plus(group, 1.0));
        let law = all.law(self.k);
        let k = self.k.get() as f64;
        // Jackknife: each group left out once.
        let others: Vec<f64> =
            groups.iter().map(|group| all.plus(group, -1.0).law(self.k).constant(k)).collect();
        let count = GROUP_COUNT as f64;
        let mean = others.iter().sum::<f64>() / count;
        let squares: f64 = others.iter().map(|other| (other - mean).powi(2)).sum();
        let std_error = ((count - 1.0) / count * squares).sqrt();
        Calibration { constant: law.constant(k), std_error, law }
    }

    fn measure(&self, group: u64, seed: u64) -> PairSums {
        let mut random = Stream::Calibration.random(seed, group);
        let count = self.emission.count();
        let pair_count = PAIR_COUNT.min(count);
        let pairs = pair_count * group / GROUP_COUNT..pair_count * (group + 1) / GROUP_COUNT;
        let index = |pair: u64, random: &mut Random| {
            let place = (pair as f64 + uniform(random)) / pair_count as f64;
            ((place * count as f64) as u64).min(count.saturating_sub(1))
        };
        let indices: Vec<u64> = pairs.map(|pair| index(pair, &mut random)).collect();
        let [paths, twins] = [1, 2].map(|draw| {
            let seed = Stream::Calibration.hash(seed, draw);
            let emitted = indices.iter().map(|&index| self.emission.redrawn(index, seed));
            let frame = self.map.frame();
            trace_paths(emitted, self.medium, self.extinction, frame, self.settings)
        });
        let mut finder = NearestPhotons::new(self.map);
        let mut sums = PairSums::default();
        for (path, twin) in paths.iter().zip(&twins) {
            self.add_pairs(path, twin, &mut finder, &mut random, &mut sums);
            self.add_pairs(twin, path, &mut finder, &mut random, &mut sums);
        }
        sums
    }

    /// Adds the pairs of collisions of a path among themselves and with those of its twin.
    fn add_pairs(
        &self,
        path: &[Photon],
        twin: &[Photon],
        finder: &mut NearestPhotons<'_>,
        random: &mut Random,
        sums: &mut PairSums,
    ) {
        let stride = path.len().div_ceil(PLACES_PER_PATH).max(1);
        let first = (uniform(random) * stride as f64) as usize;
        for photon in path.iter().skip(first).step_by(stride) {
            let place = self.map.frame().to_world(photon.position);
            let ball = finder.find(place, self.k, self.max_radius);
            if !ball.complete {
                continue;
            }
            let radius = f64::from(ball.radius);
            let weight = stride as f64;
            sums.photons += weight;
            for (excess, volume) in sums.excess.iter_mut().zip([1.0 / STEP, STEP]) {
                let reach = 2.0 * radius * volume.cbrt();
                let shared = |other: &Photon| shared_balls(distance(photon, other) / reach);
                // The photon's own share is 1.
                let siblings = path.iter().map(shared).sum::<f64>() - 1.0;
                let twins: f64 = twin.iter().map(shared).sum();
                *excess += weight * (siblings - twins);
            }
        }
    }
}

/// Sums over photons.
#[derive(Clone, Copy, Debug, Default)]
struct PairSums {
    photons: f64,
    /// Pairs in balls smaller and larger than those of k photons: of siblings less of twins.
    excess: [f64; 2],
}

impl PairSums {
    /// These sums and `sign` times others.
    fn plus(&self, other: &Self, sign: f64) -> Self {
        let excess = [0, 1].map(|i| self.excess[i] + sign * other.excess[i]);
        Self { photons: self.photons + sign * other.photons, excess }
    }

    fn law(&self, k: NonZeroUsize) -> CountLaw {
        let k = k.get() as f64;
        let expected = [k / STEP, k * STEP];
        let variance = |i: usize| {
            let ratio = 1.0 + if self.photons > 0.0 { self.excess[i] / self.photons } else { 0.0 };
            expected[i] * ratio.max(LEAST_RATIO)
        };
        CountLaw::through([variance(0), variance(1)], STEP)
    }
}

/// Share of the balls that hold a place which also hold another, at a distance of so many diameters.
fn shared_balls(diameters: f64) -> f64 {
    if diameters < 1.0 { 1.0 - diameters * (1.5 - 0.5 * diameters * diameters) } else { 0.0 }
}

/// In map units.
fn distance(a: &Photon, b: &Photon) -> f64 {
    let axis = |i: usize| f64::from(a.position[i]) - f64::from(b.position[i]);
    (axis(0).powi(2) + axis(1).powi(2) + axis(2).powi(2)).sqrt()
}
