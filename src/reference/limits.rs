//! When a reference is good enough.

/// Samples a pixel before its variance is believed in.
const FEWEST_FOR_ERROR: u64 = 16;

/// Most samples a pixel between two looks at the limits.
const LARGEST_PASS: u64 = 16;

/// What ends a reference: whichever comes first. Without any it goes on until it is cancelled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Samples a pixel, at least 2: fewer have no variance.
    pub samples: Option<u64>,
    /// Wall-clock time \[s\]. The first pass, of 2 samples a pixel, is always made.
    pub seconds: Option<f64>,
    /// Estimated relative error of the image, as [`Progress::relative_error`] has it.
    pub relative_error: Option<f64>,
}

/// How far a reference is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Samples a pixel so far.
    pub samples: u64,
    /// Wall-clock time so far \[s\].
    pub seconds: f64,
    /// Root of the mean variance of all pixels and channels, over their mean; 0 for a black image.
    pub relative_error: f64,
    /// Share of the work that is done, as far as can be told; 1 where a limit is reached.
    pub share_done: f64,
}

impl Limits {
    /// Samples a pixel of the next pass: an eighth of what there is, so that no time is wasted on looking nor on
    /// samples beyond the limit. It depends on the samples alone, and so does where an error ends the image.
    pub(super) fn next_pass(&self, samples: u64) -> u64 {
        let pass = (samples / 8).clamp(if samples == 0 { 2 } else { 1 }, LARGEST_PASS);
        self.samples.map_or(pass, |limit| pass.min(limit.max(2).saturating_sub(samples)))
    }

    /// The share of the work that is done.
    pub(super) fn share_done(&self, samples: u64, seconds: f64, relative_error: f64) -> f64 {
        let by_samples = self.samples.map(|limit| samples as f64 / limit.max(2) as f64);
        // A pass that would end too late is not begun.
        let pass = seconds * self.next_pass(samples) as f64 / samples.max(1) as f64;
        let by_time = self
            .seconds
            .map(|limit| if seconds + pass > limit { 1.0 } else { (seconds / limit).min(1.0) });
        // The error falls with the root of the samples.
        let by_error = self.relative_error.map(|limit| {
            let share = (limit / relative_error).powi(2).min(1.0);
            if samples < FEWEST_FOR_ERROR {
                share.min(samples as f64 / FEWEST_FOR_ERROR as f64)
            } else {
                share
            }
        });
        let shares = [by_samples, by_time, by_error];
        shares.into_iter().flatten().fold(0.0, f64::max).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_grow_and_end_at_the_limit() {
        let limits = Limits { samples: Some(1000), ..Limits::default() };
        let (mut samples, mut passes) = (0, Vec::new());
        while limits.share_done(samples, 0.0, 1.0) < 1.0 {
            passes.push(limits.next_pass(samples));
            samples += limits.next_pass(samples);
        }
        assert_eq!(samples, 1000);
        assert_eq!(passes[..9], [2, 1, 1, 1, 1, 1, 1, 1, 1]);
        assert_eq!(passes.iter().max(), Some(&16));
        assert_eq!(Limits { samples: Some(1), ..limits }.next_pass(0), 2);
    }

    #[test]
    fn whichever_limit_comes_first_ends_it() {
        let limits = Limits { samples: Some(100), seconds: Some(10.0), relative_error: Some(0.01) };
        assert_eq!(limits.share_done(50, 1.0, 0.02), 0.5);
        assert_eq!(limits.share_done(100, 1.0, 0.1), 1.0);
        assert_eq!(limits.share_done(90, 9.95, 0.1), 1.0);
        assert_eq!(limits.share_done(20, 1.0, 0.009), 1.0);
        assert_eq!(limits.share_done(8, 1.0, 0.009), 0.5, "too few to know");
        assert_eq!(Limits::default().share_done(1 << 40, 1e9, 0.0), 0.0);
        // A black image has an error of 0; so may one whose light no path has found yet.
        let by_error = Limits { relative_error: Some(0.01), ..Limits::default() };
        assert_eq!(by_error.share_done(2, 0.1, 0.0), 0.125);
        assert_eq!(by_error.share_done(16, 0.1, 0.0), 1.0);
    }
}
