//! Rows of a comparison in a scene: of one way of emission at points, and in pixels.

use serde::Serialize;

use super::pixels::PixelSamples;
use super::points::PointSamples;
use super::request::SceneComparison;
use crate::emission::EmissionKind;
use crate::lab::compare::law::student_quantile;
use crate::lab::compare::request::emission_name;
use crate::lab::compare::row::Sample;
use crate::scene::Scene;

/// One way of emission and one k, at places of the scene. Biases and variances are relative.
#[derive(Clone, Debug, Serialize)]
pub struct PointRow {
    /// Name of the way of emission.
    pub emission: &'static str,
    /// Photons of the estimate.
    pub k: u64,
    /// Photons emitted a map.
    pub n: u64,
    /// Independent maps.
    pub runs: u64,
    /// Places.
    pub places: u64,
    /// Power of the k nearest photons over the power expected in their ball, less 1, in the mean.
    pub intrinsic_bias: f64,
    /// Its standard error, from the means of maps.
    pub std_error: f64,
    /// Standard error of what is expected, the same for all ways.
    pub reference_std_error: f64,
    /// Lower end of the confidence interval of 95 %, by both errors.
    pub low_95: f64,
    /// Upper end.
    pub high_95: f64,
    /// The same bias with k - 1/2 in the place of k.
    pub intrinsic_bias_k_minus_half: f64,
    /// With k - 1.
    pub intrinsic_bias_k_minus_1: f64,
    /// Density expected in the ball over that expected in the inner ball, which stands for the point, less 1.
    pub smoothing_bias: f64,
    /// Its standard error.
    pub smoothing_std_error: f64,
    /// Power density estimated over that of the inner ball, less 1: what a reading of the map sees.
    pub total_bias: f64,
    /// Its standard error.
    pub total_std_error: f64,
    /// Variance of intrinsic errors over all places of all maps.
    pub variance: f64,
    /// Its standard error.
    pub variance_std_error: f64,
    /// Variance of random emission over this one; `None` where random emission was not measured.
    pub variance_ratio: Option<f64>,
    /// Its standard error, the two taken as independent.
    pub variance_ratio_std_error: Option<f64>,
    /// Mean squared intrinsic error.
    pub squared_error: f64,
    /// That of random emission over this one.
    pub error_ratio: Option<f64>,
    /// 1 / (squared error x processor time of a map \[s\]); `None` where the system does not tell the time.
    pub efficiency: Option<f64>,
}

/// One way of emission, in pixels, with the scene's own k and divisor. Figures of single pixels are relative to their own
/// light in the reference, or to a tenth of the mean's where they are darker.
#[derive(Clone, Debug, Serialize)]
pub struct PixelRow {
    /// Name of the way of emission.
    pub emission: &'static str,
    /// Photons of the estimate: the scene's.
    pub k: u64,
    /// Photons emitted an image.
    pub n: u64,
    /// Independent images.
    pub runs: u64,
    /// Pixels of an image.
    pub pixels: u64,
    /// Mean of all pixels over that of the reference, less 1.
    pub bias: f64,
    /// Its standard error, from the images.
    pub std_error: f64,
    /// Standard error of the reference's mean.
    pub reference_std_error: f64,
    /// Lower end of the confidence interval of 95 %, by both errors.
    pub low_95: f64,
    /// Upper end.
    pub high_95: f64,
    /// Root mean squared bias of single pixels: what does not average out over the image. Chance is taken off.
    pub local_bias: f64,
    /// Variance of a pixel.
    pub variance: f64,
    /// Its standard error.
    pub variance_std_error: f64,
    /// Variance of random emission over this one; `None` where random emission was not measured.
    pub variance_ratio: Option<f64>,
    /// Its standard error, the two taken as independent.
    pub variance_ratio_std_error: Option<f64>,
    /// Mean squared error of a pixel of one image, the reference's own noise taken off.
    pub squared_error: f64,
    /// Root of the mean squared error over all pixels, relative to the mean of the reference, as `render --reference` tells it.
    pub rel_rmse: f64,
    /// 1 / (squared error x processor time of an image \[s\]); `None` where the system does not tell the time.
    pub efficiency: Option<f64>,
}

/// A figure with its standard error.
type Measured = (f64, f64);

impl PointRow {
    /// All rows, emission by emission.
    pub(super) fn table(request: &SceneComparison, ks: &[u64], points: &PointSamples) -> Vec<Self> {
        let mut rows = Vec::new();
        for (index, &kind) in request.emissions.iter().enumerate() {
            for (at, &k) in ks.iter().enumerate() {
                let samples: Vec<&Sample> = points.samples.iter().map(|of| &of[at]).collect();
                let random = random_index(request).map(|index| samples[index]);
                let mut row = Self::new(request, kind, k, samples[index], random);
                row.add_reference(mean_std_error(&samples), request.runs);
                let seconds = points.seconds[index];
                row.efficiency = seconds.map(|seconds| 1.0 / (row.squared_error * seconds));
                rows.push(row);
            }
        }
        rows
    }

    fn new(
        request: &SceneComparison,
        kind: EmissionKind,
        k: u64,
        sample: &Sample,
        random: Option<&Sample>,
    ) -> Self {
        let count = k as f64;
        let intrinsic = sample.over_maps(|map| map.intrinsic.bias());
        let bias = intrinsic.bias();
        let instead_of_k = |divisor: f64| divisor / count * (1.0 + bias) - 1.0;
        let smoothing = sample.over_maps(|map| map.smoothing.bias());
        let total = sample.over_maps(|map| map.total.bias());
        let variance = sample.variance();
        let ratio = random.map(|random| ratio(random.variance(), variance));
        let squared =
            |sample: &Sample| sample.over_maps(|map| map.intrinsic.mean_squared_error()).bias();
        let squared_error = squared(sample);
        Self {
            emission: emission_name(kind),
            k,
            n: request.n,
            runs: request.runs,
            places: request.queries,
            intrinsic_bias: bias,
            std_error: intrinsic.std_error(),
            reference_std_error: 0.0,
            low_95: bias,
            high_95: bias,
            intrinsic_bias_k_minus_half: instead_of_k(count - 0.5),
            intrinsic_bias_k_minus_1: instead_of_k(count - 1.0),
            smoothing_bias: smoothing.bias(),
            smoothing_std_error: smoothing.std_error(),
            total_bias: total.bias(),
            total_std_error: total.std_error(),
            variance: variance.0,
            variance_std_error: variance.1,
            variance_ratio: ratio.map(|(ratio, _)| ratio),
            variance_ratio_std_error: ratio.map(|(_, error)| error),
            squared_error,
            error_ratio: random.map(|random| squared(random) / squared_error),
            efficiency: None,
        }
    }

    fn add_reference(&mut self, std_error: f64, runs: u64) {
        self.reference_std_error = std_error;
        let half_width = student_quantile(runs as f64 - 1.0) * self.std_error.hypot(std_error);
        self.low_95 = self.intrinsic_bias - half_width;
        self.high_95 = self.intrinsic_bias + half_width;
    }
}

impl PixelRow {
    /// All rows.
    pub(super) fn table(
        request: &SceneComparison,
        scene: &Scene,
        images: &PixelSamples,
    ) -> Vec<Self> {
        let variance = |index: usize| {
            let variance = &images.figures[index].variance;
            (variance.bias(), variance.std_error())
        };
        let random = random_index(request).map(variance);
        let reference_std_error = images.reference.std_error;
        let kinds = request.emissions.iter().enumerate();
        kinds
            .map(|(index, &kind)| {
                let figures = &images.figures[index];
                let (bias, std_error) = (figures.bias.bias(), figures.bias.std_error());
                let both = std_error.hypot(reference_std_error);
                let half_width = student_quantile(request.runs as f64 - 1.0) * both;
                let ratio = random.map(|random| ratio(random, variance(index)));
                let squared_error = figures.squared_error;
                let seconds = images.seconds[index];
                Self {
                    emission: emission_name(kind),
                    k: scene.estimate.k as u64,
                    n: request.n,
                    runs: request.runs,
                    pixels: (scene.camera.width * scene.camera.height) as u64,
                    bias,
                    std_error,
                    reference_std_error,
                    low_95: bias - half_width,
                    high_95: bias + half_width,
                    local_bias: figures.local_bias_squared.sqrt(),
                    variance: variance(index).0,
                    variance_std_error: variance(index).1,
                    variance_ratio: ratio.map(|(ratio, _)| ratio),
                    variance_ratio_std_error: ratio.map(|(_, error)| error),
                    squared_error,
                    rel_rmse: figures.mean_squared_error.sqrt(),
                    efficiency: seconds.map(|seconds| 1.0 / (squared_error * seconds)),
                }
            })
            .collect()
    }
}

fn random_index(request: &SceneComparison) -> Option<usize> {
    request.emissions.iter().position(|&kind| kind == EmissionKind::Random)
}

/// Standard error of the mean of all ways, which the power expected is read from.
fn mean_std_error(samples: &[&Sample]) -> f64 {
    let errors = samples.iter().map(|s| s.over_maps(|map| map.intrinsic.bias()).std_error());
    errors.map(|error| error * error).sum::<f64>().sqrt() / samples.len() as f64
}

/// a / b of two independent figures.
fn ratio(a: Measured, b: Measured) -> Measured {
    let ratio = a.0 / b.0;
    (ratio, ratio * (a.1 / a.0).hypot(b.1 / b.0))
}
