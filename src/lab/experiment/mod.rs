//! Experiments: the models simulated, trial by trial, in parallel.
//!
//! A trial places photons and reads u_(k) for every k at once; k / u_(k) - 1 is its deviation. Trials come in a fixed
//! number of batches, each with its own random stream, whose sums are merged in order: the same bytes whatever the
//! number of threads.

mod direct;
mod fast;
mod fixed_radius;
mod jittered;
mod moments;
mod shells;

pub use moments::Moments;

use rayon::prelude::*;

use super::error::LabError;
use super::model::Model;
use super::thread_clock::ThreadClock;
use crate::math::{Random, Stream};
use direct::DirectDraw;
use fast::FastDraw;

/// Batches of an experiment.
const BATCH_COUNT: u64 = 256;

/// How photons are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Only what the k asked for depend on.
    Fast,
    /// All n, the k-th nearest found among them.
    Direct,
}

/// What is simulated.
#[derive(Clone, Copy, Debug)]
pub struct Experiment<'a> {
    /// Where photons lie.
    pub model: Model,
    /// How many.
    pub n: u64,
    /// Ascending.
    pub ks: &'a [u64],
    /// Repetitions.
    pub trials: u64,
    /// How photons are drawn.
    pub method: Method,
    /// Seed of every random number.
    pub seed: u64,
}

/// What came of an experiment.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Deviations of k / u_(k) from 1, for each k.
    pub moments: Vec<Moments>,
    /// Processor time of all threads \[s\].
    pub seconds: f64,
}

impl Measured {
    fn merge(self, other: Self) -> Self {
        let pairs = self.moments.into_iter().zip(other.moments);
        Self {
            moments: pairs.map(|(sum, batch)| sum.merge(batch)).collect(),
            seconds: self.seconds + other.seconds,
        }
    }
}

impl Experiment<'_> {
    /// Simulates; nothing comes of models without chance.
    ///
    /// # Errors
    /// The model has no k-th of n photons for one of the k.
    pub fn run(&self) -> Result<Option<Measured>, LabError> {
        self.ks.iter().try_for_each(|&k| self.model.check(self.n, k))?;
        if self.ks.is_empty() || self.model == Model::FirstApproximation {
            return Ok(None);
        }
        let batches: Vec<Measured> = (0..BATCH_COUNT)
            .into_par_iter()
            .map(|batch| {
                let clock = ThreadClock::start();
                let moments = self.run_batch(batch);
                Measured { moments, seconds: clock.seconds() }
            })
            .collect();
        Ok(batches.into_iter().reduce(Measured::merge))
    }

    fn run_batch(&self, batch: u64) -> Vec<Moments> {
        let mut moments = vec![Moments::default(); self.ks.len()];
        let Some(mut draw) = Draw::new(self) else { return moments };
        let seed = Stream::Experiment.hash(self.seed, self.stream());
        let mut random = Stream::Experiment.random(seed, batch);
        let mut measures = vec![0.0; self.ks.len()];
        let counts = self.model == Model::FixedRadius;
        let trials = self.trials * (batch + 1) / BATCH_COUNT - self.trials * batch / BATCH_COUNT;
        for _ in 0..trials {
            draw.draw(&mut random, &mut measures);
            for ((moments, &measure), &k) in moments.iter_mut().zip(&measures).zip(self.ks) {
                let (measure, k) = (measure, k as f64);
                moments.add(if counts { measure / k } else { k / measure } - 1.0);
            }
        }
        moments
    }

    /// Tells the random numbers of this experiment from those of others of the same seed.
    fn stream(&self) -> u64 {
        let place = Model::ALL.iter().position(|model| *model == self.model).unwrap_or(0);
        2 * place as u64 + u64::from(self.method == Method::Direct)
    }
}

/// What draws the photons of a trial.
enum Draw {
    Fast(FastDraw),
    Direct(DirectDraw),
}

impl Draw {
    fn new(experiment: &Experiment<'_>) -> Option<Self> {
        let Experiment { model, n, ks, .. } = *experiment;
        match experiment.method {
            Method::Fast => FastDraw::new(model, n, ks).map(Self::Fast),
            Method::Direct => DirectDraw::new(model, n, ks).map(Self::Direct),
        }
    }

    fn draw(&mut self, random: &mut Random, measures: &mut [f64]) {
        match self {
            Self::Fast(fast) => fast.draw(random, measures),
            Self::Direct(direct) => direct.draw(random, measures),
        }
    }
}
