//! Bias tables: exact and measured mean and variance of every model, constant and k asked for.

use serde::{Serialize, Serializer};

use super::constant::Constant;
use super::error::LabError;
use super::experiment::{Experiment, Measured, Method, Moments};
use super::model::{Law, Model, law};

/// What to tabulate.
#[derive(Clone, Debug)]
pub struct BiasRequest {
    /// Models, in the order of the table.
    pub models: Vec<Model>,
    /// Photons; by default 1000, or as many as the k need.
    pub n: Option<u64>,
    /// Which nearest photon defines the ball.
    pub ks: Vec<u64>,
    /// Estimators.
    pub constants: Vec<Constant>,
    /// Repetitions of each experiment, 0 for exact values alone.
    pub trials: u64,
    /// How photons are drawn.
    pub method: Method,
    /// Seed of the experiments.
    pub seed: u64,
}

/// One row of the table. `None`: not known, or not asked for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BiasRow {
    /// Name of the model.
    pub model: &'static str,
    /// Name of the constant.
    pub divisor: &'static str,
    /// Photons.
    pub n: u64,
    /// Which of them defines the ball.
    pub k: u64,
    /// The numerator c.
    pub c: Option<f64>,
    /// Exact mean; the truth is 1.
    #[serde(serialize_with = "number_or_word")]
    pub exact_mean: Option<f64>,
    /// Exact mean - 1, to full relative accuracy.
    #[serde(serialize_with = "number_or_word")]
    pub exact_bias: Option<f64>,
    /// Exact variance.
    #[serde(serialize_with = "number_or_word")]
    pub exact_variance: Option<f64>,
    /// Repetitions.
    pub trials: u64,
    /// Mean of the trials.
    pub measured_mean: Option<f64>,
    /// That mean - 1.
    pub measured_bias: Option<f64>,
    /// Standard error of the mean, from the trials' own variance.
    pub std_error: Option<f64>,
    /// Variance of the trials.
    pub measured_variance: Option<f64>,
    /// (measured - exact) / standard error, that of the exact variance where it is finite.
    pub z: Option<f64>,
    /// Standard error of the measured variance.
    pub variance_std_error: Option<f64>,
    /// 1 / (mean squared error of a trial x seconds a trial): how much is learnt a second. It depends on the machine, and
    /// is not in the CSV.
    pub efficiency: Option<f64>,
}

/// JSON has no infinite numbers: a word stands for them, as in the CSV.
fn number_or_word<S: Serializer>(value: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    match value {
        Some(infinite) if infinite.is_infinite() => serializer.collect_str(infinite),
        value => value.serialize(serializer),
    }
}

/// What an experiment cost and was worth.
#[derive(Clone, Debug, Serialize)]
pub struct ExperimentCost {
    /// Name of the model.
    pub model: &'static str,
    /// Photons.
    pub n: u64,
    /// Repetitions, each giving every k at once.
    pub trials: u64,
    /// Processor time of all threads \[s\].
    pub seconds: f64,
}

/// The rows, model by model, constant by constant, k by k, and what their experiments cost.
#[derive(Clone, Debug, Serialize)]
pub struct BiasTable {
    /// Exact and measured values.
    pub rows: Vec<BiasRow>,
    /// One for each model that was simulated.
    pub experiments: Vec<ExperimentCost>,
}

/// Photons by default.
const DEFAULT_N: u64 = 1000;

impl BiasRequest {
    /// Computes the table. `progress` hears the name of each model before it is simulated.
    ///
    /// # Errors
    /// A model has no k-th of n photons for one of the k, or the experiment would not fit into memory.
    pub fn tabulate(&self, mut progress: impl FnMut(&'static str)) -> Result<BiasTable, LabError> {
        let mut ks = self.ks.clone();
        ks.sort_unstable();
        ks.dedup();
        let mut table = BiasTable { rows: Vec::new(), experiments: Vec::new() };
        for &model in &self.models {
            let n = self.photons(model, &ks);
            let laws = ks.iter().map(|&k| law(model, n, k)).collect::<Result<Vec<_>, _>>()?;
            progress(model.name());
            let measured = self.measure(model, n, &ks, &mut table.experiments)?;
            // A ball of fixed radius has one estimator: its photons over those expected.
            let is_fixed = model == Model::FixedRadius;
            let constants = if is_fixed { &[Constant::K][..] } else { &self.constants };
            for &constant in constants {
                for (index, (&k, law)) in ks.iter().zip(&laws).enumerate() {
                    let moments = measured.as_ref().map(|measured| &measured.moments[index]);
                    let mut row = BiasRow::new(model, constant, n, k, law.as_ref(), moments);
                    row.efficiency = measured.as_ref().and_then(|all| row.efficiency(all.seconds));
                    table.rows.push(row);
                }
            }
        }
        Ok(table)
    }

    /// Photons of a model: those asked for, or as many as the largest k needs.
    fn photons(&self, model: Model, ks: &[u64]) -> u64 {
        let needed = ks.iter().map(|&k| model.photons_needed(k)).max().unwrap_or(1);
        model.nearest_count(self.n.unwrap_or(DEFAULT_N.max(needed)))
    }

    fn measure(
        &self,
        model: Model,
        n: u64,
        ks: &[u64],
        costs: &mut Vec<ExperimentCost>,
    ) -> Result<Option<Measured>, LabError> {
        if self.trials == 0 {
            return Ok(None);
        }
        let (trials, method, seed) = (self.trials, self.method, self.seed);
        let experiment = Experiment { model, n, ks, trials, method, seed };
        let measured = experiment.run()?;
        let cost = |measured: &Measured| ExperimentCost {
            model: model.name(),
            n,
            trials,
            seconds: measured.seconds,
        };
        costs.extend(measured.as_ref().map(cost));
        Ok(measured)
    }
}

impl BiasRow {
    fn new(
        model: Model,
        constant: Constant,
        n: u64,
        k: u64,
        law: Option<&Law>,
        moments: Option<&Moments>,
    ) -> Self {
        let counts = model.count_law(k);
        let c = constant.value(k, law, counts);
        let exact_bias = law.and_then(|law| constant.bias(k, law, counts));
        // A constant has no variance, and nothing to measure.
        let exact_variance = law
            .filter(|law| !matches!(law, Law::Constant { .. }))
            .and_then(|law| constant.variance(k, law, counts));
        let scale = c.map(|c| c / k as f64);
        // c/u - 1 = (c/k) (k/u - 1) + (c/k - 1)
        let measured_bias =
            moments.zip(scale).map(|(moments, scale)| scale * moments.bias() + (scale - 1.0));
        let std_error = moments.zip(scale).map(|(moments, scale)| scale * moments.std_error());
        let measured = |value: fn(&Moments) -> f64| {
            moments.zip(scale).map(|(moments, scale)| scale * scale * value(moments))
        };
        let trials = moments.map_or(0, Moments::count);
        let expected_error = exact_variance
            .filter(|variance| variance.is_finite())
            .map(|variance| (variance / trials as f64).sqrt())
            .or(std_error);
        let z = match (measured_bias, exact_bias, expected_error) {
            (Some(measured), Some(exact), Some(error)) if error > 0.0 && exact.is_finite() => {
                Some((measured - exact) / error)
            }
            _ => None,
        };
        Self {
            model: model.name(),
            divisor: constant.name(),
            n,
            k,
            c,
            exact_mean: exact_bias.map(|bias| 1.0 + bias),
            exact_bias,
            exact_variance,
            trials,
            measured_mean: measured_bias.map(|bias| 1.0 + bias),
            measured_bias,
            std_error,
            measured_variance: measured(Moments::variance),
            z,
            variance_std_error: measured(Moments::variance_std_error),
            efficiency: None,
        }
    }

    /// The efficiency of an experiment that took so long \[s\].
    fn efficiency(&self, seconds: f64) -> Option<f64> {
        let squared_error = self.measured_variance? + self.measured_bias?.powi(2);
        let efficiency = self.trials as f64 / (squared_error * seconds);
        efficiency.is_finite().then_some(efficiency)
    }
}
