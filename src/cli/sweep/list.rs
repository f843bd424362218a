//! Lists of values to sweep over, separated by commas; `none`, or nothing, is an empty one.

use crate::cli::count::{parse_count, parse_positive};

/// Values in the order given, each once.
#[derive(Clone, Debug, PartialEq)]
pub struct List<T>(pub Vec<T>);

/// Parses whole numbers like `1e4,1e5`.
pub fn parse_counts(text: &str) -> Result<List<u64>, String> {
    parse_list(text, parse_count)
}

/// Parses numbers of paths a pixel, at least 2 each.
pub fn parse_paths(text: &str) -> Result<List<u64>, String> {
    parse_list(text, parse_path_count)
}

/// Parses numbers above 0.
pub fn parse_errors(text: &str) -> Result<List<f64>, String> {
    parse_list(text, parse_positive)
}

/// Parses a number of paths a pixel.
pub fn parse_path_count(text: &str) -> Result<u64, String> {
    match parse_count(text)? {
        1 => Err("one path a pixel tells nothing of its variance; take 2 or more".into()),
        count => Ok(count),
    }
}

fn parse_list<T: PartialEq>(
    text: &str,
    parse: impl Fn(&str) -> Result<T, String>,
) -> Result<List<T>, String> {
    let mut values = Vec::new();
    if !["", "none"].contains(&text) {
        for part in text.split(',') {
            let value = parse(part)?;
            if !values.contains(&value) {
                values.push(value);
            }
        }
    }
    Ok(List(values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_hold_each_value_once() {
        assert_eq!(parse_counts("1e4,100,1_0000"), Ok(List(vec![10_000, 100])));
        assert_eq!(parse_errors("0.05,1"), Ok(List(vec![0.05, 1.0])));
        assert_eq!((parse_paths(""), parse_paths("none")), (Ok(List(vec![])), Ok(List(vec![]))));
        assert!(parse_paths("4,1").is_err());
        for text in ["4,", "a", "0", "4,none", "-1"] {
            assert!(parse_counts(text).is_err() && parse_errors(text).is_err(), "{text}");
        }
    }
}
