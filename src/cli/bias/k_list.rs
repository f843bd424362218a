//! Lists of k as people write them: `2..200`, `10,50,100`, `2..20,50,1e6`.

use crate::cli::count::parse_count;

/// More k than a table has use for.
const MOST: u64 = 1_000_000;

/// Parses a list of whole numbers and ranges, both ends included.
pub fn parse_k_list(text: &str) -> Result<KList, String> {
    let mut ks = Vec::new();
    for part in text.split(',') {
        let (first, last) = match part.split_once("..") {
            Some((first, last)) => {
                (parse_count(first)?, parse_count(last.trim_start_matches('='))?)
            }
            None => {
                let k = parse_count(part)?;
                (k, k)
            }
        };
        if first > last {
            return Err(format!("`{part}` begins after its end"));
        }
        if last - first >= MOST {
            return Err(format!("`{part}` has more than {MOST} values; name fewer"));
        }
        ks.extend(first..=last);
    }
    Ok(KList(ks))
}

/// Whole numbers, in the order given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KList(pub Vec<u64>);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_numbers_mix() {
        let parsed = |text| parse_k_list(text).map(|list| list.0);
        assert_eq!(parsed("2..5"), Ok(vec![2, 3, 4, 5]));
        assert_eq!(parsed("2..=3,10,1e12"), Ok(vec![2, 3, 10, 1_000_000_000_000]));
        for text in ["", "5..2", "0", "2..", "a", "1..1e12"] {
            assert!(parsed(text).is_err(), "{text}");
        }
    }
}
