//! A comparison as CSV: all but times, so that equal requests give equal bytes.

use super::request::CompareTable;
use super::row::CompareRow;
use crate::lab::csv::number;

impl CompareTable {
    /// The rows as CSV, a header first; numbers have 17 significant digits.
    pub fn to_csv(&self) -> String {
        self.lines(|_| Vec::new())
    }

    /// The same with what times say, too: of no two runs are these the same.
    pub fn to_csv_with_times(&self) -> String {
        self.lines(|row| {
            let cost = self.costs.iter().find(|cost| cost.emission == row.emission);
            let saving = self.savings.iter().find(|s| (s.emission, s.k) == (row.emission, row.k));
            vec![
                ("seconds_per_map", number(cost.and_then(|cost| cost.seconds_per_map))),
                ("efficiency", number(row.efficiency)),
                ("seconds_ratio", number(saving.and_then(|saving| saving.seconds))),
            ]
        })
    }

    fn lines(&self, times: impl Fn(&CompareRow) -> Vec<(&'static str, String)>) -> String {
        let mut text = String::new();
        for row in &self.rows {
            let mut cells = cells(row);
            cells.extend(times(row));
            if text.is_empty() {
                text += &line(cells.iter().map(|(name, _)| *name));
            }
            text += &line(cells.iter().map(|(_, value)| value.as_str()));
        }
        text
    }
}

fn line<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    cells.collect::<Vec<_>>().join(",") + "\n"
}

/// The columns of a row, by name.
fn cells(row: &CompareRow) -> Vec<(&'static str, String)> {
    let real = |value: f64| number(Some(value));
    vec![
        ("scene", row.scene.to_owned()),
        ("emission", row.emission.to_owned()),
        ("k", row.k.to_string()),
        ("n", row.n.to_string()),
        ("runs", row.runs.to_string()),
        ("queries", row.queries.to_string()),
        ("intrinsic_bias", real(row.intrinsic_bias)),
        ("std_error", real(row.std_error)),
        ("low_95", real(row.low_95)),
        ("high_95", real(row.high_95)),
        ("intrinsic_bias_k_minus_half", real(row.intrinsic_bias_k_minus_half)),
        ("intrinsic_bias_k_minus_1", real(row.intrinsic_bias_k_minus_1)),
        ("intrinsic_bias_calibrated", real(row.intrinsic_bias_calibrated)),
        ("calibrated_k", real(row.calibrated_k)),
        ("calibrated_removed", real(row.calibrated_removed)),
        ("law_bias", real(row.law_bias)),
        ("law_z", real(row.law_z)),
        ("count_law_bias", real(row.count_law_bias)),
        ("count_law_z", real(row.count_law_z)),
        ("count_variance", real(row.count_variance)),
        ("count_exponent", real(row.count_exponent)),
        ("reduction", real(row.reduction)),
        ("reduction_std_error", real(row.reduction_std_error)),
        ("smoothing_bias_exact", real(row.smoothing_bias_exact)),
        ("smoothing_bias", real(row.smoothing_bias)),
        ("smoothing_std_error", real(row.smoothing_std_error)),
        ("total_bias", real(row.total_bias)),
        ("total_std_error", real(row.total_std_error)),
        ("variance", real(row.variance)),
        ("variance_std_error", real(row.variance_std_error)),
        ("variance_within_maps", real(row.variance_within_maps)),
        ("variance_between_maps", real(row.variance_between_maps)),
        ("law_variance", real(row.law_variance)),
        ("variance_ratio", number(row.variance_ratio)),
        ("variance_ratio_std_error", number(row.variance_ratio_std_error)),
        ("squared_error", real(row.squared_error)),
        ("photon_ratio", real(row.photon_ratio)),
    ]
}
