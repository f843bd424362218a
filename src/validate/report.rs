//! The table that a validation comes to.

use serde::Serialize;

/// What became of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// As it should be.
    Pass,
    /// Not as it should be.
    Fail,
    /// Too few photons come there to tell.
    Rare,
}

/// One quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What kind of question it answers.
    pub group: &'static str,
    /// What is measured.
    pub quantity: String,
    /// The exact answer.
    pub exact: f64,
    /// What was measured: the mean of all batches.
    pub measured: f64,
    /// Standard error of that mean; 0 where there is no noise.
    pub std_error: f64,
    /// How far off the mean may be without counting: the bias of kernels, or rounding.
    pub bias_allowed: f64,
    /// What is beyond the bias allowed, in standard errors; nothing where there is no noise.
    pub z: Option<f64>,
    /// Whether it took a second, larger measurement to tell.
    pub again: bool,
    /// What became of it.
    pub verdict: Verdict,
}

impl Row {
    /// A quantity without noise, which may be off by `tolerance`.
    pub(super) fn exact(
        group: &'static str,
        quantity: impl Into<String>,
        exact: f64,
        measured: f64,
        tolerance: f64,
    ) -> Self {
        let holds = measured == exact || (measured - exact).abs() <= tolerance;
        let verdict = if holds { Verdict::Pass } else { Verdict::Fail };
        Self {
            group,
            quantity: quantity.into(),
            exact,
            measured,
            std_error: 0.0,
            bias_allowed: tolerance,
            z: None,
            again: false,
            verdict,
        }
    }

    /// A statement that holds or does not.
    pub(super) fn holds(group: &'static str, quantity: impl Into<String>, holds: bool) -> Self {
        Self::exact(group, quantity, 1.0, f64::from(u8::from(holds)), 0.0)
    }
}

/// All quantities.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// One a quantity, by group.
    pub rows: Vec<Row>,
}

impl Report {
    /// Quantities with a verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.rows.iter().filter(|row| row.verdict == verdict).count()
    }

    /// Whether nothing failed, and something passed.
    pub fn passes(&self) -> bool {
        self.count(Verdict::Fail) == 0 && self.count(Verdict::Pass) > 0
    }
}
