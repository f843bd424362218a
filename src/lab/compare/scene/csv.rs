//! A comparison in a scene as CSV: points and pixels in one table, nothing where a column says nothing of a row.

use super::request::SceneTable;
use super::row::{PixelRow, PointRow};
use crate::lab::compare::saving::Saving;
use crate::lab::csv::{CsvTable, number};

const COLUMNS: &str = "target,emission,k,n,runs,samples,bias,std_error,reference_std_error,low_95,high_95,\
                       bias_k_minus_half,bias_k_minus_1,smoothing_bias,smoothing_std_error,total_bias,\
                       total_std_error,local_bias,variance,variance_std_error,variance_ratio,\
                       variance_ratio_std_error,squared_error,rel_rmse";

const TIME_COLUMNS: &str = ",seconds,efficiency,seconds_ratio";

impl SceneTable {
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
        let cost = |name: &str| self.costs.iter().find(|cost| cost.emission == name);
        for row in &self.points {
            let seconds = cost(row.emission).and_then(|cost| cost.seconds_per_map);
            let saved = seconds_saved(&self.point_savings, row.emission, row.k);
            table.add(&point_cells(row), &[seconds, row.efficiency, saved].map(number));
        }
        for row in &self.pixels {
            let seconds = cost(row.emission).and_then(|cost| cost.seconds_per_image);
            let saved = seconds_saved(&self.pixel_savings, row.emission, row.k);
            table.add(&pixel_cells(row), &[seconds, row.efficiency, saved].map(number));
        }
        table.text
    }
}

fn seconds_saved(savings: &[Saving], emission: &str, k: u64) -> Option<f64> {
    savings.iter().find(|saving| (saving.emission, saving.k) == (emission, k))?.seconds
}

fn point_cells(row: &PointRow) -> [String; 24] {
    let real = |value: f64| number(Some(value));
    [
        "points".to_owned(),
        row.emission.to_owned(),
        row.k.to_string(),
        row.n.to_string(),
        row.runs.to_string(),
        row.places.to_string(),
        real(row.intrinsic_bias),
        real(row.std_error),
        real(row.reference_std_error),
        real(row.low_95),
        real(row.high_95),
        real(row.intrinsic_bias_k_minus_half),
        real(row.intrinsic_bias_k_minus_1),
        real(row.smoothing_bias),
        real(row.smoothing_std_error),
        real(row.total_bias),
        real(row.total_std_error),
        String::new(),
        real(row.variance),
        real(row.variance_std_error),
        number(row.variance_ratio),
        number(row.variance_ratio_std_error),
        real(row.squared_error),
        real(row.squared_error.sqrt()),
    ]
}

fn pixel_cells(row: &PixelRow) -> [String; 24] {
    let real = |value: f64| number(Some(value));
    let none = String::new;
    [
        "pixels".to_owned(),
        row.emission.to_owned(),
        row.k.to_string(),
        row.n.to_string(),
        row.runs.to_string(),
        row.pixels.to_string(),
        real(row.bias),
        real(row.std_error),
        real(row.reference_std_error),
        real(row.low_95),
        real(row.high_95),
        none(),
        none(),
        none(),
        none(),
        none(),
        none(),
        real(row.local_bias),
        real(row.variance),
        real(row.variance_std_error),
        number(row.variance_ratio),
        number(row.variance_ratio_std_error),
        real(row.squared_error),
        real(row.rel_rmse),
    ]
}
