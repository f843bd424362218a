//! Names by which readers tell grids apart.

use std::collections::{HashMap, HashSet};

use crate::medium::vdb::descriptor::SEPARATOR;

/// For each name one that no other grid has, as the OpenVDB library forms it: a name that comes more
/// than once, or is empty, gets a number.
pub(super) fn unique_names(names: &[&str]) -> Vec<String> {
    let mut counts: HashMap<&str, usize> = HashMap::new();
    names.iter().for_each(|name| *counts.entry(name).or_default() += 1);
    let mut taken = HashSet::new();
    // The next number of each name: numbers before it are taken.
    let mut numbers: HashMap<&str, usize> = HashMap::new();
    names
        .iter()
        .map(|&name| {
            let is_numbered = name.is_empty() || counts.get(name) != Some(&1);
            let mut unique = name.to_owned();
            if is_numbered || taken.contains(&unique) {
                let number = numbers.entry(name).or_insert(usize::from(!is_numbered));
                unique = format!("{name}{SEPARATOR}{number}");
                *number += 1;
            }
            taken.insert(unique.clone());
            unique
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_repeat_are_numbered_from_the_first() {
        let names = unique_names(&["density", "heat", "density", "", "density", ""]);
        let expected =
            ["density\u{1e}0", "heat", "density\u{1e}1", "\u{1e}0", "density\u{1e}2", "\u{1e}1"];
        assert_eq!(names, expected);
    }
}
