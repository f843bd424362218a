//! Whole numbers as people write them: `1000000`, `1_000_000` or `1e6`.

/// What no count reaches: 2^64.
const LIMIT: f64 = 18_446_744_073_709_551_616.0;

/// Parses a whole number of at least 1.
pub fn parse_count(text: &str) -> Result<u64, String> {
    let problem =
        || format!("`{text}` is not a whole number from 1 on, like 5000, 1_000_000 or 1e6");
    let digits = text.replace('_', "");
    let count = digits.parse().ok().or_else(|| parse_exponent(&digits)).ok_or_else(problem)?;
    if count == 0 { Err(problem()) } else { Ok(count) }
}

fn parse_exponent(digits: &str) -> Option<u64> {
    let value: f64 = digits.parse().ok()?;
    ((0.0..LIMIT).contains(&value) && value.fract() == 0.0).then_some(value as u64)
}

/// Parses a finite number above 0.
pub fn parse_positive(text: &str) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok();
    let positive = value.filter(|value| *value > 0.0 && value.is_finite());
    positive.ok_or_else(|| format!("`{text}` is not a number above 0"))
}

/// Parses `640x360`.
pub fn parse_resolution(text: &str) -> Result<[u64; 2], String> {
    let sides = text.split_once(['x', 'X']);
    let sides = sides
        .and_then(|(width, height)| Some([parse_count(width).ok()?, parse_count(height).ok()?]));
    sides.ok_or_else(|| {
        format!("`{text}` is not a resolution; write it as WIDTHxHEIGHT, like 640x360")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_in_every_spelling() {
        for (text, count) in [
            ("1", 1),
            ("1000000", 1_000_000),
            ("1_000_000", 1_000_000),
            ("1e6", 1_000_000),
            ("1E6", 1_000_000),
            ("2.5e3", 2_500),
            ("1e18", 1_000_000_000_000_000_000),
            ("18446744073709551615", u64::MAX),
        ] {
            assert_eq!(parse_count(text), Ok(count), "{text}");
        }
    }

    #[test]
    fn what_is_no_count_is_refused() {
        for text in ["", "0", "-1", "1.5", "1e-3", "many", "2e19", "1e300", "inf", "nan", "1 000"] {
            assert!(parse_count(text).is_err(), "{text}");
        }
    }

    #[test]
    fn resolutions() {
        assert_eq!(parse_resolution("640x360"), Ok([640, 360]));
        for text in ["640", "640x", "x360", "640x0", "640*360", "1x2x3"] {
            assert!(parse_resolution(text).is_err(), "{text}");
        }
    }
}
