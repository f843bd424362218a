//! The progress bar of a reference: nothing where stderr is piped or quiet is asked for.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use photonvdb::reference::{PassObserver, Progress};

/// Steps of the whole bar.
const STEPS: f64 = 1e4;

/// Shows how far a reference is and passes Ctrl-C on to it.
pub struct Bar {
    bar: ProgressBar,
    interrupted: Arc<AtomicBool>,
}

impl Bar {
    /// For a reference that ends once `interrupted` is true.
    pub fn new(quiet: bool, interrupted: Arc<AtomicBool>) -> Self {
        // `stderr` draws nothing where it is no terminal.
        let target =
            if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let style = ProgressStyle::with_template("{msg} [{wide_bar}] {percent:>3}% {eta:>4}");
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> ");
        let bar = ProgressBar::with_draw_target(Some(STEPS as u64), target).with_style(style);
        Self { bar, interrupted }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl PassObserver for Bar {
    fn pass_done(&self, progress: &Progress) {
        let Progress { samples, relative_error, share_done, .. } = progress;
        self.bar.set_message(format!("{samples} spp, error {relative_error:.4}"));
        self.bar.set_position((share_done * STEPS) as u64);
    }

    fn cancelled(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}
