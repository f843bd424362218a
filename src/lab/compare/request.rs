//! A comparison: every way of emission, as many maps as runs, every k.

use rayon::prelude::*;
use serde::Serialize;

use super::analytic::AnalyticScene;
use super::photon_maps::PhotonMaps;
use super::query_errors::{COUNT_STEP, Queries, QueryErrors, photons_sought};
use super::row::{CompareRow, Sample};
use super::saving::Saving;
use crate::emission::EmissionKind;
use crate::lab::error::LabError;
use crate::math::Stream;

/// Queries that one task makes.
const SHARE: u64 = 16;

/// The balls of queries reach so much farther than those expected to hold the photons sought.
const MARGIN: f64 = 1.3;

/// What is compared.
#[derive(Clone, Debug)]
pub struct CompareRequest {
    /// Where.
    pub scene: AnalyticScene,
    /// Ways of emission; ratios are to the random one, if it is among them.
    pub emissions: Vec<EmissionKind>,
    /// Photons of the estimate: 2 or more; from 3 on the variance of random emission is finite.
    pub ks: Vec<u64>,
    /// Photons emitted a map.
    pub n: u64,
    /// Maps of each way of emission: at least 2.
    pub runs: u64,
    /// Queries a map.
    pub queries: u64,
    /// Seed of everything.
    pub seed: u64,
}

/// The rows, emission by emission, k by k, and what they cost.
#[derive(Clone, Debug, Serialize)]
pub struct CompareTable {
    /// What was measured.
    pub rows: Vec<CompareRow>,
    /// One for each way of emission.
    pub costs: Vec<EmissionCost>,
    /// What they save over random emission, if that was measured: way by way, k by k.
    pub savings: Vec<Saving>,
}

/// What the maps of one way of emission cost.
#[derive(Clone, Debug, Serialize)]
pub struct EmissionCost {
    /// Name of the way of emission.
    pub emission: &'static str,
    /// Processor time of a map, from emission to the last query \[s\]; `None` where the system does not tell.
    pub seconds_per_map: Option<f64>,
}

impl CompareRequest {
    /// Measures everything. `processor_seconds` tells the processor time of the process so far; `advanced` hears of each
    /// map that is done.
    ///
    /// # Errors
    /// A k is below 2, there are too few photons for one, or a map cannot be built.
    pub fn tabulate(
        &self,
        processor_seconds: impl Fn() -> Option<f64>,
        mut advanced: impl FnMut(),
    ) -> Result<CompareTable, LabError> {
        let mut ks = self.ks.clone();
        ks.sort_unstable();
        ks.dedup();
        let reach = self.reach(&ks)?;
        let mut samples: Vec<(EmissionKind, Vec<Sample>)> = Vec::new();
        let mut costs = Vec::new();
        for &kind in &self.emissions {
            let started = processor_seconds();
            let maps = self.measure(kind, &ks, reach, &mut advanced)?;
            let seconds = started.zip(processor_seconds()).map(|(start, end)| end - start);
            costs.push(EmissionCost {
                emission: emission_name(kind),
                seconds_per_map: seconds.map(|seconds| seconds / self.runs as f64),
            });
            let of_k = |index: usize| Sample::of(maps.iter().map(|errors| errors[index]));
            samples.push((kind, (0..ks.len()).map(of_k).collect()));
        }
        let random = samples.iter().find(|(kind, _)| *kind == EmissionKind::Random);
        let mut rows = Vec::new();
        for ((kind, samples), cost) in samples.iter().zip(&costs) {
            for (index, (&k, sample)) in ks.iter().zip(samples).enumerate() {
                let random = random.map(|(_, samples)| &samples[index]);
                let seconds = cost.seconds_per_map;
                rows.push(CompareRow::new(self, *kind, k, sample, random, seconds));
            }
        }
        let savings = savings(&rows, &costs);
        Ok(CompareTable { rows, costs, savings })
    }

    /// How far queries look \[m\], where balls stay clear of lights and of faces that are in the way.
    fn reach(&self, ks: &[u64]) -> Result<f64, LabError> {
        let largest = ks.last().copied().unwrap_or(1);
        if let Some(&k) = ks.first().filter(|&&k| k < 2) {
            return Err(LabError::InfiniteMean { k });
        }
        if largest > self.n {
            return Err(LabError::BallTooLarge { k: largest, n: self.n });
        }
        let sought = COUNT_STEP * photons_sought(largest) as f64;
        let power = sought * self.scene.largest_power(self.n);
        let radius = self.scene.ball_radius(self.scene.hardest_query(), power);
        radius
            .map(|radius| MARGIN * radius)
            .filter(|&radius| radius < self.scene.reach_limit())
            .ok_or(LabError::BallTooLarge { k: largest, n: self.n })
    }

    /// Errors of each map and k.
    fn measure(
        &self,
        kind: EmissionKind,
        ks: &[u64],
        reach: f64,
        advanced: &mut impl FnMut(),
    ) -> Result<Vec<Vec<QueryErrors>>, LabError> {
        let maps = PhotonMaps::new(self.scene, kind, self.n, reach);
        let queries = Queries { scene: self.scene, photon_count: self.n, ks, reach };
        let seed = Stream::Experiment.hash(self.seed, kind as u64);
        // One map at a time, its photons and queries in parallel, keeps the memory that of a single map.
        (0..self.runs)
            .map(|run| {
                let map = maps.map(Stream::Experiment.hash(seed, run))?;
                let shares = (0..self.queries.div_ceil(SHARE)).into_par_iter().map(|share| {
                    let count = SHARE.min(self.queries - share * SHARE);
                    // The same places in the maps of every way of emission.
                    let places = Stream::Experiment.hash(self.seed ^ run.rotate_left(32), share);
                    queries.run(&map, count, &mut Stream::Experiment.random(places, run))
                });
                let shares: Vec<Vec<QueryErrors>> = shares.collect::<Result<_, _>>()?;
                advanced();
                Ok(merged(shares, ks.len()))
            })
            .collect()
    }
}

/// Photons are compared by what independent ones would need, of which both ways are so many times better.
fn savings(rows: &[CompareRow], costs: &[EmissionCost]) -> Vec<Saving> {
    let random = emission_name(EmissionKind::Random);
    let seconds_of = |name| {
        let cost = costs.iter().find(|cost| cost.emission == name);
        cost.and_then(|cost| cost.seconds_per_map)
    };
    let others = rows.iter().filter(|row| row.emission != random);
    others
        .filter_map(|row| {
            let other = rows.iter().find(|other| other.emission == random && other.k == row.k)?;
            let photons = row.photon_ratio / other.photon_ratio;
            let (seconds, of_random) = (seconds_of(row.emission), seconds_of(random));
            Some(Saving::new(row.emission, row.k, photons, seconds, of_random))
        })
        .collect()
}

fn merged(shares: Vec<Vec<QueryErrors>>, count: usize) -> Vec<QueryErrors> {
    shares.into_iter().fold(vec![QueryErrors::default(); count], |sum, share| {
        sum.into_iter().zip(share).map(|(sum, share)| sum.merge(share)).collect()
    })
}

/// As on the command line.
pub(in crate::lab) fn emission_name(kind: EmissionKind) -> &'static str {
    match kind {
        EmissionKind::Random => "random",
        EmissionKind::Stratified => "stratified",
        EmissionKind::Sobol => "sobol",
    }
}
