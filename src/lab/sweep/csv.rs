//! A sweep as CSV: nothing where a column says nothing of a row.

use super::request::SweepTable;
use super::row::SweepRow;
use crate::lab::csv::{CsvTable, number};

const COLUMNS: &str = "mode,photons,emission,k,divisor,cells,samples,target_error,runs,error,error_std_error,bias,bias_high,\
                       mean_bias,mean_bias_std_error,noise,variance,estimated_error";

const TIME_COLUMNS: &str = ",cpu_seconds,efficiency,front";

impl SweepTable {
    /// The rows as CSV, a header first; numbers have 17 significant digits. Equal requests give equal bytes.
    pub fn to_csv(&self) -> String {
        self.lines(false)
    }

    /// The same with what times say, too: of no two runs are these the same.
    pub fn to_csv_with_times(&self) -> String {
        self.lines(true)
    }

    fn lines(&self, timed: bool) -> String {
        let mut table = CsvTable::new(COLUMNS, TIME_COLUMNS, timed);
        for row in &self.rows {
            let front = u8::from(row.is_on_front).to_string();
            table.add(&cells(row), &[number(row.cpu_seconds), number(row.efficiency), front]);
        }
        table.text
    }
}

fn cells(row: &SweepRow) -> [String; 18] {
    let real = |value: f64| number(Some(value));
    let word = |value: Option<&str>| value.unwrap_or_default().to_owned();
    let count = |value: Option<u64>| value.map_or(String::new(), |value| value.to_string());
    [
        row.mode.to_owned(),
        count(row.photons),
        word(row.emission),
        count(row.k.map(|k| k as u64)),
        word(row.divisor),
        count(row.cells.map(|cells| cells as u64)),
        count(row.samples),
        number(row.target_error),
        row.runs.to_string(),
        real(row.error),
        real(row.error_std_error),
        real(row.bias),
        number(row.bias_high),
        real(row.mean_bias),
        real(row.mean_bias_std_error),
        real(row.noise),
        real(row.variance),
        number(row.estimated_error),
    ]
}
