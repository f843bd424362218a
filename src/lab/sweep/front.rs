//! The Pareto front: what nothing else beats in both time and error.

/// Whether each (seconds, error) is on the front: no other is as good in both and better in one. What is not finite is
/// never on it.
pub fn pareto_front(points: &[(f64, f64)]) -> Vec<bool> {
    let is_finite = |&(seconds, error): &(f64, f64)| seconds.is_finite() && error.is_finite();
    let beats = |a: &(f64, f64), b: &(f64, f64)| a.0 <= b.0 && a.1 <= b.1 && a != b;
    let finite = || points.iter().filter(|point| is_finite(point));
    let on_front = |point| is_finite(point) && !finite().any(|other| beats(other, point));
    points.iter().map(on_front).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_nothing_beats() {
        let points = [
            (1.0, 0.5),
            (2.0, 0.2),
            // Beaten in both, in time alone, in error alone.
            (3.0, 0.3),
            (2.5, 0.2),
            (1.0, 0.6),
            // Equals stand side by side.
            (4.0, 0.1),
            (4.0, 0.1),
            // Between two of the front, above their line, and still on it.
            (1.5, 0.45),
            (f64::NAN, 0.01),
            (0.5, f64::INFINITY),
        ];
        let front = [true, true, false, false, false, true, true, true, false, false];
        assert_eq!(pareto_front(&points), front);
        assert_eq!(pareto_front(&[(1.0, 1.0)]), [true]);
        assert!(pareto_front(&[]).is_empty());
    }
}
