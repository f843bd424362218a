//! Quantities that one run of the renderer gives together, measured in independent batches.

use rayon::prelude::*;

use super::error::ValidateError;
use super::report::{Row, Verdict};
use crate::math::Stream;

/// Independent batches behind every standard error: of fewer, one in ten errors would be too small by a quarter.
const BATCHES: u64 = 32;

/// Below, a z-score passes.
const PASSING_Z: f64 = 4.0;

/// From here on a z-score fails at once.
const FAILING_Z: f64 = 6.0;

/// How many times the photons of the first measurement the second one takes.
const AGAIN: u64 = 4;

/// Spread of batches, relative to their mean, that is but rounding: photons are kept in single precision.
const ROUNDING: f64 = 1e-6;

/// What a batch is to do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Batch {
    /// Of all its random numbers.
    pub seed: u64,
    /// Photons, rays or flights to take.
    pub count: u64,
}

/// A quantity to measure.
#[derive(Clone, Debug)]
pub(super) struct Quantity {
    name: String,
    exact: f64,
    bias_allowed: f64,
    is_rare: bool,
}

impl Quantity {
    /// A quantity that is measured without bias.
    pub fn new(name: impl Into<String>, exact: f64) -> Self {
        Self { name: name.into(), exact, bias_allowed: 0.0, is_rare: false }
    }

    /// The same, read by a kernel that may be off by a share of it.
    pub fn within(self, share: f64) -> Self {
        let bias_allowed = share * self.exact.abs();
        Self { bias_allowed, ..self }
    }

    /// The same, give or take so much.
    pub fn give_or_take(self, bias_allowed: f64) -> Self {
        Self { bias_allowed, ..self }
    }

    /// The same, left out if no more photons are expected to tell of it than this.
    pub fn seen_by(self, expected: f64) -> Self {
        Self { is_rare: expected < 1000.0, ..self }
    }
}

type Measure<'a> = Box<dyn Fn(Batch) -> Result<Vec<f64>, ValidateError> + Sync + 'a>;

/// Quantities measured together.
pub(super) struct Check<'a> {
    group: &'static str,
    quantities: Vec<Quantity>,
    count: u64,
    measure: Measure<'a>,
}

impl<'a> Check<'a> {
    /// A check whose batches of `count` photons give a figure for each quantity.
    pub fn new(
        group: &'static str,
        quantities: Vec<Quantity>,
        count: u64,
        measure: impl Fn(Batch) -> Result<Vec<f64>, ValidateError> + Sync + 'a,
    ) -> Self {
        Self { group, quantities, count, measure: Box::new(measure) }
    }

    /// Photons that all batches take together.
    pub fn total(count: u64) -> f64 {
        (BATCHES * count) as f64
    }

    /// Measures every quantity; those in doubt twice.
    pub fn rows(&self, seed: u64) -> Result<Vec<Row>, ValidateError> {
        let mut rows = self.attempt(seed, self.count)?;
        let in_doubt = |row: &Row| row.z.is_some_and(|z| (PASSING_Z..FAILING_Z).contains(&z.abs()));
        if rows.iter().any(in_doubt) {
            let again = self.attempt(Stream::Scramble.hash(seed, 0), AGAIN * self.count)?;
            for (row, second) in rows.iter_mut().zip(again) {
                if in_doubt(row) {
                    *row = Row { again: true, ..second };
                }
            }
        }
        Ok(rows)
    }

    fn attempt(&self, seed: u64, count: u64) -> Result<Vec<Row>, ValidateError> {
        // Checks of the same scene must not share photons: their errors would be one.
        let own = self.quantities.iter().flat_map(|quantity| quantity.name.bytes());
        let own = own.fold(seed, |hash, byte| Stream::Experiment.hash(hash, u64::from(byte)));
        let batch = |index| Batch { seed: Stream::Experiment.hash(own, index), count };
        let figures: Vec<Vec<f64>> = (0..BATCHES)
            .into_par_iter()
            .map(|index| (self.measure)(batch(index)))
            .collect::<Result<_, _>>()?;
        let column = |n: usize| figures.iter().map(move |row| row.get(n).copied());
        let quantities = self.quantities.iter().enumerate();
        Ok(quantities.map(|(n, quantity)| self.row(quantity, column(n))).collect())
    }

    fn row(&self, quantity: &Quantity, figures: impl Iterator<Item = Option<f64>>) -> Row {
        let figures: Vec<f64> = figures.map(|figure| figure.unwrap_or(f64::NAN)).collect();
        let Quantity { name, exact, bias_allowed, is_rare } = quantity.clone();
        let count = figures.len() as f64;
        let mean = figures.iter().sum::<f64>() / count;
        let spread: f64 = figures.iter().map(|figure| (figure - mean).powi(2)).sum();
        let std_error = (spread / (count - 1.0) / count).sqrt();
        let rounding = ROUNDING * exact.abs();
        let off = mean - exact;
        let beyond = (off.abs() - bias_allowed.max(rounding)).max(0.0).copysign(off);
        let z = if std_error > 0.0 { Some(beyond / std_error) } else { None };
        let holds = match z {
            // Where every batch gives the same but for rounding, so must the mean.
            _ if beyond == 0.0 => true,
            Some(z) => z.abs() < PASSING_Z,
            None => false,
        };
        let verdict = match (is_rare, holds) {
            (true, _) => Verdict::Rare,
            (false, true) => Verdict::Pass,
            (false, false) => Verdict::Fail,
        };
        let group = self.group;
        Row {
            group,
            quantity: name,
            exact,
            measured: mean,
            std_error,
            bias_allowed,
            z,
            again: false,
            verdict,
        }
    }
}
