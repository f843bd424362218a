//! Photons counted in an interval of fixed radius around the query, one photon in each of n parts of the line.

use crate::math::{Random, uniform};

/// Photons within the radius at which k are expected, drawn part by part only where the interval ends.
pub(super) fn draw_counts(n: u64, ks: &[u64], random: &mut Random, counts: &mut [f64]) {
    for (&k, count) in ks.iter().zip(counts) {
        *count = k as f64;
        // Otherwise the interval ends between parts.
        if n.is_multiple_of(2) != k.is_multiple_of(2) {
            *count -= 1.0;
            // Of each of the two parts cut in the middle the photon is inside or not.
            *count += (0..2).filter(|_| uniform(random) < 0.5).count() as f64;
        }
    }
}

/// The same, all n photons placed.
pub(super) fn place_and_count(
    n: u64,
    ks: &[u64],
    random: &mut Random,
    distances: &mut Vec<f64>,
    counts: &mut [f64],
) {
    let middle = 0.5 * n as f64;
    distances.clear();
    distances.extend((0..n).map(|part| 2.0 * (part as f64 + uniform(random) - middle).abs()));
    distances.sort_unstable_by(f64::total_cmp);
    for (&k, count) in ks.iter().zip(counts) {
        *count = distances.partition_point(|&distance| distance < k as f64) as f64;
    }
}
