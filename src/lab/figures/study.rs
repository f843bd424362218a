//! The experiments behind the figures.

use crate::emission::EmissionKind;
use crate::lab::bias::{BiasRequest, BiasRow, BiasTable, ExperimentCost};
use crate::lab::compare::{AnalyticScene, CompareRequest, CompareTable};
use crate::lab::constant::Constant;
use crate::lab::error::LabError;
use crate::lab::experiment::Method;
use crate::lab::model::Model;
use crate::lab::plot::Series;

/// Repetitions of the thesis's experiments on a line, times ten.
const LINE_TRIALS: u64 = 100_000;
/// Those in two and three dimensions, times ten.
const SPACE_TRIALS: u64 = 10_000;

/// Photons emitted as for a render: those a map, maps, and queries of a map.
const EMISSION_PHOTONS: u64 = 100_000;
const EMISSION_RUNS: u64 = 64;
const EMISSION_QUERIES: u64 = 500;
const EMISSION_KS: [u64; 8] = [3, 5, 7, 10, 20, 50, 100, 200];

/// What came of the simulation of one model.
#[derive(Clone, Debug)]
pub struct Study {
    table: BiasTable,
}

/// All experiments of the figures.
#[derive(Clone, Debug)]
pub struct Studies {
    pub(super) random: Study,
    pub(super) first_even: Study,
    pub(super) first_odd: Study,
    pub(super) line_even: Study,
    pub(super) line_odd: Study,
    pub(super) basic_2d: Study,
    pub(super) order_2d: Study,
    pub(super) basic_3d: Study,
    pub(super) order_3d: Study,
    pub(super) order_volume: Study,
    pub(super) jittered: [Study; 3],
    /// Photons emitted as for a render.
    pub(super) emission: CompareTable,
}

impl Studies {
    /// Runs all experiments with this seed, `scale` times as long. `progress` hears of each before it runs.
    ///
    /// # Errors
    /// One cannot be made.
    pub fn run(
        seed: u64,
        scale: f64,
        mut progress: impl FnMut(&'static str),
    ) -> Result<Self, LabError> {
        let mut study = |model: Model, n: u64, last_k: u64, trials: u64| {
            let trials = ((trials as f64 * scale) as u64).max(2);
            Study::run(model, n, last_k, trials, seed, &mut progress)
        };
        let grid = |dimension| {
            let model = Model::Jittered(dimension);
            (model, model.nearest_count(model.photons_needed(200).max(1000)))
        };
        let mut jittered = |dimension| {
            let (model, n) = grid(dimension);
            study(model, n, 200, 2 * SPACE_TRIALS)
        };
        let grids = [jittered(1)?, jittered(2)?, jittered(3)?];
        let photons = CompareRequest {
            scene: AnalyticScene::PointAbsorbing,
            emissions: vec![EmissionKind::Random, EmissionKind::Stratified],
            ks: EMISSION_KS.to_vec(),
            n: EMISSION_PHOTONS,
            runs: ((EMISSION_RUNS as f64 * scale) as u64).max(2),
            queries: EMISSION_QUERIES,
            seed,
        };
        Ok(Self {
            random: study(Model::Random(1), 100_000, 200, LINE_TRIALS)?,
            first_even: study(Model::FirstApproximation, 100_000, 200, LINE_TRIALS)?,
            first_odd: study(Model::FirstApproximation, 100_001, 200, LINE_TRIALS)?,
            line_even: study(Model::Stratified, 100_000, 200, LINE_TRIALS)?,
            line_odd: study(Model::Stratified, 100_001, 200, LINE_TRIALS)?,
            basic_2d: study(Model::Basic(2), 1000, 200, SPACE_TRIALS)?,
            order_2d: study(Model::Order(2), 1000, 100, SPACE_TRIALS)?,
            basic_3d: study(Model::Basic(3), 1000, 200, SPACE_TRIALS)?,
            order_3d: study(Model::Order(3), 1000, 200, SPACE_TRIALS)?,
            order_volume: study(Model::OrderVolume(3), 1000, 200, SPACE_TRIALS)?,
            jittered: grids,
            emission: {
                progress(photons.scene.name());
                photons.tabulate(|| None, || ())?
            },
        })
    }

    /// What the experiments cost.
    pub fn costs(&self) -> Vec<ExperimentCost> {
        self.all().into_iter().flat_map(|study| study.table.experiments.clone()).collect()
    }

    fn all(&self) -> [&Study; 13] {
        let [a, b, c] = &self.jittered;
        [
            &self.random,
            &self.first_even,
            &self.first_odd,
            &self.line_even,
            &self.line_odd,
            &self.basic_2d,
            &self.order_2d,
            &self.basic_3d,
            &self.order_3d,
            &self.order_volume,
            a,
            b,
            c,
        ]
    }
}

impl Study {
    fn run(
        model: Model,
        n: u64,
        last_k: u64,
        trials: u64,
        seed: u64,
        progress: &mut impl FnMut(&'static str),
    ) -> Result<Self, LabError> {
        let request = BiasRequest {
            models: vec![model],
            n: Some(n),
            ks: (2..=last_k).collect(),
            constants: Constant::ALL.to_vec(),
            trials,
            method: Method::Fast,
            seed,
        };
        Ok(Self { table: request.tabulate(progress)? })
    }

    /// The rows of one constant, by k.
    pub(super) fn rows(&self, constant: Constant) -> impl Iterator<Item = &BiasRow> + Clone {
        self.table.rows.iter().filter(move |row| row.divisor == constant.name())
    }

    /// The relative error of a constant.
    pub(super) fn bias(&self, constant: Constant, label: impl Into<String>) -> Series {
        let rows = self.rows(constant);
        Series {
            label: label.into(),
            line: rows.clone().filter_map(|row| Some((row.k as f64, row.exact_bias?))).collect(),
            points: rows
                .filter_map(|row| Some((row.k as f64, row.measured_bias?, row.std_error?)))
                .collect(),
        }
    }

    /// Theory alone.
    pub(super) fn exact_bias(&self, constant: Constant, label: impl Into<String>) -> Series {
        Series { points: Vec::new(), ..self.bias(constant, label) }
    }

    /// Variance of the estimator.
    pub(super) fn variance(&self, constant: Constant, label: impl Into<String>) -> Series {
        let rows = self.rows(constant);
        Series {
            label: label.into(),
            line: rows
                .clone()
                .filter_map(|row| Some((row.k as f64, row.exact_variance?)))
                .collect(),
            points: rows
                .filter_map(|row| {
                    Some((row.k as f64, row.measured_variance?, row.variance_std_error?))
                })
                .collect(),
        }
    }
}
