//! Tables as CSV: numbers with 17 significant digits, `inf` where infinite, nothing where not known.

use super::bias::BiasTable;

const COLUMNS: &str = "model,divisor,n,k,exact_mean,exact_bias,exact_variance,trials,measured_mean,measured_bias,\
                       std_error,measured_variance,z,c,variance_std_error";

const TIME_COLUMNS: &str = ",seconds,efficiency";

impl BiasTable {
    /// The rows as CSV, a header first. The same bytes for the same request, whatever the machine's load.
    pub fn to_csv(&self) -> String {
        self.lines(false)
    }

    /// The same with two columns more: processor time of the model's experiment \[s\], which all its rows share, and
    /// efficiency. No two runs give the same bytes.
    pub fn to_csv_with_times(&self) -> String {
        self.lines(true)
    }

    fn lines(&self, timed: bool) -> String {
        let mut table = CsvTable::new(COLUMNS, TIME_COLUMNS, timed);
        for row in &self.rows {
            let trials = if row.trials > 0 { row.trials.to_string() } else { String::new() };
            let cells = [
                row.model.to_owned(),
                row.divisor.to_owned(),
                row.n.to_string(),
                row.k.to_string(),
                number(row.exact_mean),
                number(row.exact_bias),
                number(row.exact_variance),
                trials,
                number(row.measured_mean),
                number(row.measured_bias),
                number(row.std_error),
                number(row.measured_variance),
                number(row.z),
                number(row.c),
                number(row.variance_std_error),
            ];
            let experiment = self.experiments.iter().find(|cost| cost.model == row.model);
            let seconds = experiment.map(|cost| cost.seconds);
            table.add(&cells, &[number(seconds), number(row.efficiency)]);
        }
        table.text
    }
}

/// A table in the making, with what times say in columns of its own, or without.
pub(super) struct CsvTable {
    pub(super) text: String,
    timed: bool,
}

impl CsvTable {
    /// A header: names with commas between, those of times last.
    pub(super) fn new(columns: &str, time_columns: &str, timed: bool) -> Self {
        let text = columns.to_owned() + if timed { time_columns } else { "" } + "\n";
        Self { text, timed }
    }

    /// A row, as long as the header.
    pub(super) fn add(&mut self, cells: &[String], times: &[String]) {
        self.text += &cells.join(",");
        if self.timed {
            times.iter().for_each(|time| self.text += &format!(",{time}"));
        }
        self.text.push('\n');
    }
}

/// A number that reads back as the same bits.
pub(super) fn number(value: Option<f64>) -> String {
    match value {
        None => String::new(),
        Some(value) if value.is_finite() => format!("{value:.16e}"),
        Some(value) => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_and_infinity_is_a_word() {
        assert_eq!(number(Some(0.1)), "1.0000000000000001e-1");
        assert_eq!(number(Some(f64::INFINITY)), "inf");
        assert_eq!(number(None), "");
        for value in [1.0 / 3.0, -5e-324, f64::MAX, 0.0] {
            assert_eq!(number(Some(value)).parse(), Ok(value));
        }
    }
}
