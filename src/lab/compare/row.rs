//! One row of a comparison: what the maps of one way of emission say of one k.

use serde::Serialize;

use super::law::{bias_from_counts, random_error, random_k, student_quantile};
use super::query_errors::{COUNT_STEP, QueryErrors};
use super::request::{CompareRequest, emission_name};
use crate::emission::EmissionKind;
use crate::estimate::CountLaw;
use crate::lab::experiment::Moments;
use crate::lab::jitter::JitterLaw;

/// One way of emission and one k. Biases and variances are relative to the true power density.
#[derive(Clone, Debug, Serialize)]
pub struct CompareRow {
    /// Name of the scene.
    pub scene: &'static str,
    /// Name of the way of emission.
    pub emission: &'static str,
    /// Photons of the estimate.
    pub k: u64,
    /// Photons emitted a map.
    pub n: u64,
    /// Independent maps.
    pub runs: u64,
    /// Queries a map.
    pub queries: u64,
    /// Mean of k / u - 1; where photons differ in power, of power found over power expected - 1.
    pub intrinsic_bias: f64,
    /// Its standard error, from the means of maps.
    pub std_error: f64,
    /// Lower end of its confidence interval of 95 %.
    pub low_95: f64,
    /// Upper end.
    pub high_95: f64,
    /// The same bias with k - 1/2 in the place of k; its standard error is (k - 1/2) / k times that of k.
    pub intrinsic_bias_k_minus_half: f64,
    /// With k - 1.
    pub intrinsic_bias_k_minus_1: f64,
    /// With the constant that the counts of the other half of the maps say.
    pub intrinsic_bias_calibrated: f64,
    /// That constant: what k photons count as.
    pub calibrated_k: f64,
    /// The share of the bias of k that it removes.
    pub calibrated_removed: f64,
    /// What theory says of photons that collide once: 1 / (k - 1) of random emission, otherwise the law of one photon a
    /// cubic cell.
    pub law_bias: f64,
    /// (measured - law) / standard error.
    pub law_z: f64,
    /// What theory says, given how the number of photons in balls about k varies in these very maps.
    pub count_law_bias: f64,
    /// (measured - that) / standard error.
    pub count_law_z: f64,
    /// Variance of the number of photons in a ball where k are expected.
    pub count_variance: f64,
    /// The power of k with which it grows: 1 of independent photons, 2/3 of one a cell.
    pub count_exponent: f64,
    /// By how much the bias is smaller than 1 / (k - 1), as a share of that.
    pub reduction: f64,
    /// Its standard error.
    pub reduction_std_error: f64,
    /// Ball mean over value - 1, exact, for a query in the middle of all and the ball where k are expected.
    pub smoothing_bias_exact: f64,
    /// Its mean over the balls of all queries.
    pub smoothing_bias: f64,
    /// Standard error.
    pub smoothing_std_error: f64,
    /// Mean of k / (n V p) - 1.
    pub total_bias: f64,
    /// Its standard error.
    pub total_std_error: f64,
    /// Variance of k / u over all queries of all maps.
    pub variance: f64,
    /// Its standard error.
    pub variance_std_error: f64,
    /// Its part within maps.
    pub variance_within_maps: f64,
    /// Its part between maps: that of their means, less what the queries' own number leaves. May be below 0 by chance.
    pub variance_between_maps: f64,
    /// The variance that theory says.
    pub law_variance: f64,
    /// Variance of random emission over this one; `None` where random emission was not measured.
    pub variance_ratio: Option<f64>,
    /// Its standard error, the two taken as independent.
    pub variance_ratio_std_error: Option<f64>,
    /// Mean of (k / u - 1)^2.
    pub squared_error: f64,
    /// How many times as many photons random emission needs for this squared error in the same ball.
    pub photon_ratio: f64,
    /// 1 / (squared error x processor time of a map \[s\]); `None` where the system does not tell the time.
    pub efficiency: Option<f64>,
}

/// The maps of one way of emission, for one k.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    maps: Vec<QueryErrors>,
    all: QueryErrors,
}

impl Sample {
    pub(super) fn of(maps: impl Iterator<Item = QueryErrors>) -> Self {
        let maps: Vec<QueryErrors> = maps.collect();
        let all = maps.iter().copied().fold(QueryErrors::default(), QueryErrors::merge);
        Self { maps, all }
    }

    /// One figure a map.
    pub(super) fn over_maps(&self, figure: impl Fn(&QueryErrors) -> f64) -> Moments {
        let mut moments = Moments::default();
        self.maps.iter().for_each(|map| moments.add(figure(map)));
        moments
    }

    /// Variance of single queries, with its standard error.
    pub(super) fn variance(&self) -> (f64, f64) {
        let mean = self.all.intrinsic.bias();
        let about_mean = self.over_maps(|map| {
            let map = &map.intrinsic;
            map.mean_squared_error() - mean * (2.0 * map.bias() - mean)
        });
        (about_mean.bias(), about_mean.std_error())
    }

    /// How the number of photons varies where k are expected.
    fn counts(&self) -> CountLaw {
        let variances = self.all.counts.map(|counts| counts.mean_squared_error());
        CountLaw::through(variances, COUNT_STEP)
    }

    /// The calibrated constant, and the bias it leaves: measured from every other map, and tried on those between.
    fn calibrated(&self, k: f64) -> (f64, f64) {
        let half = |first: usize| Self::of(self.maps.iter().skip(first).step_by(2).copied());
        let halves = [half(0), half(1)];
        let [even, odd] = halves.each_ref().map(|half| half.counts().constant(k));
        let mean = halves.each_ref().map(|half| 1.0 + half.all.intrinsic.bias());
        (0.5 * (even + odd), 0.5 * (odd * mean[0] + even * mean[1]) / k - 1.0)
    }
}

impl CompareRow {
    pub(super) fn new(
        request: &CompareRequest,
        kind: EmissionKind,
        k: u64,
        sample: &Sample,
        random: Option<&Sample>,
        seconds: Option<f64>,
    ) -> Self {
        let count = k as f64;
        let maps = sample.over_maps(|map| map.intrinsic.bias());
        let (bias, std_error) = (maps.bias(), maps.std_error());
        let half_width = student_quantile(request.runs as f64 - 1.0) * std_error;
        let instead_of_k = |divisor: f64| divisor / count * (1.0 + bias) - 1.0;
        let counts = sample.counts();
        let count_law_bias = bias_from_counts(count, counts);
        let (calibrated_k, calibrated_bias) = sample.calibrated(count);
        let random_bias = 1.0 / (count - 1.0);
        let jittered = JitterLaw::new(3);
        let (law_bias, law_variance) = match kind {
            EmissionKind::Random => (random_bias, random_error(count) - random_bias * random_bias),
            _ => (jittered.bias(count), jittered.variance(count)),
        };
        let smoothing = sample.over_maps(|map| map.smoothing.bias());
        let total = sample.over_maps(|map| map.total.bias());
        let (variance, variance_std_error) = sample.variance();
        let within = sample.over_maps(|map| map.intrinsic.variance()).bias();
        let ratio = random.map(|random| {
            let (of_random, error_of_random) = random.variance();
            let errors = (error_of_random / of_random).hypot(variance_std_error / variance);
            (of_random / variance, of_random / variance * errors)
        });
        let squared_error = sample.all.intrinsic.mean_squared_error();
        let (scene, place) = (request.scene, request.scene.typical_query());
        let exact_radius = scene.ball_radius(place, count * scene.largest_power(request.n));
        Self {
            scene: request.scene.name(),
            emission: emission_name(kind),
            k,
            n: request.n,
            runs: request.runs,
            queries: request.queries,
            intrinsic_bias: bias,
            std_error,
            low_95: bias - half_width,
            high_95: bias + half_width,
            intrinsic_bias_k_minus_half: instead_of_k(count - 0.5),
            intrinsic_bias_k_minus_1: instead_of_k(count - 1.0),
            intrinsic_bias_calibrated: calibrated_bias,
            calibrated_k,
            calibrated_removed: 1.0 - (calibrated_bias / bias).abs(),
            law_bias,
            law_z: (bias - law_bias) / std_error,
            count_law_bias,
            count_law_z: (bias - count_law_bias) / std_error,
            count_variance: counts.variance,
            count_exponent: counts.exponent,
            reduction: 1.0 - bias / random_bias,
            reduction_std_error: std_error / random_bias,
            smoothing_bias_exact: exact_radius
                .map_or(f64::NAN, |radius| scene.smoothing(place, radius)),
            smoothing_bias: smoothing.bias(),
            smoothing_std_error: smoothing.std_error(),
            total_bias: total.bias(),
            total_std_error: total.std_error(),
            variance,
            variance_std_error,
            variance_within_maps: within,
            variance_between_maps: maps.variance() - within / request.queries as f64,
            law_variance,
            variance_ratio: ratio.map(|(ratio, _)| ratio),
            variance_ratio_std_error: ratio.map(|(_, error)| error),
            squared_error,
            photon_ratio: random_k(squared_error) / count,
            efficiency: seconds.map(|seconds| 1.0 / (squared_error * seconds)),
        }
    }
}
