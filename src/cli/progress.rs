//! Progress bars, one a stage, and pictures in between: on a terminal; bars not where quiet is asked for.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{PoisonError, RwLock};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use photonvdb::files::WriteFailure;
use photonvdb::film::Film;
use photonvdb::render::{ErrorEstimate, Observer, RenderOptions, Stage};

use super::console::say;
use super::terminal_picture::TerminalPicture;

/// Shows the stages of a render and passes Ctrl-C on to it.
pub struct Progress {
    bar: RwLock<ProgressBar>,
    pass: AtomicU32,
    passes: u32,
    /// What the passes so far say of the error.
    error: RwLock<Option<ErrorEstimate>>,
    quiet: bool,
    interrupted: Arc<AtomicBool>,
    /// Shown after passes.
    picture: Option<TerminalPicture>,
}

impl Progress {
    /// For a render that goes on after so many passes, and ends by its options, or once `interrupted` is true.
    pub fn new(
        options: &RenderOptions,
        passes_done: u32,
        quiet: bool,
        interrupted: Arc<AtomicBool>,
    ) -> Self {
        let bar = RwLock::new(ProgressBar::hidden());
        let (pass, passes) = (AtomicU32::new(passes_done + 1), options.passes);
        Self { bar, pass, passes, error: RwLock::new(None), quiet, interrupted, picture: None }
    }

    /// The same with pictures in the terminal, if they are asked for.
    pub fn with_pictures(self, are_asked_for: bool) -> Self {
        Self { picture: are_asked_for.then(TerminalPicture::default), ..self }
    }

    /// Shows the picture that is done.
    pub fn show_finished(&self, film: &Film) {
        self.picture.iter().for_each(|picture| picture.show(film));
    }

    fn start_bar(&self, stage: Stage, total: u64) -> ProgressBar {
        // `stderr` draws nothing where it is no terminal.
        let target =
            if self.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let pass = self.pass.load(Ordering::Relaxed);
        let error = *self.error.read().unwrap_or_else(PoisonError::into_inner);
        let error = error.map_or(String::new(), |e| format!("error {:.1} % ", 100.0 * e.total()));
        let prefix = match self.passes {
            1 => String::new(),
            u32::MAX => format!("pass {pass} {error}"),
            passes => format!("pass {pass}/{passes} {error}"),
        };
        let name = match stage {
            Stage::Trace => "trace",
            Stage::Build => "build",
            Stage::Gather => "gather",
        };
        let style =
            ProgressStyle::with_template("{prefix}{msg:6} [{wide_bar}] {percent:>3}% {eta:>4}");
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> ");
        ProgressBar::with_draw_target(Some(total), target)
            .with_style(style)
            .with_prefix(prefix)
            .with_message(name)
    }
}

impl Observer for Progress {
    fn stage_started(&self, stage: Stage, total: u64) {
        *self.bar.write().unwrap_or_else(PoisonError::into_inner) = self.start_bar(stage, total);
    }

    fn advanced(&self, steps: u64) {
        self.bar.read().unwrap_or_else(PoisonError::into_inner).inc(steps);
    }

    fn stage_finished(&self, _: Stage) {
        self.bar.read().unwrap_or_else(PoisonError::into_inner).finish_and_clear();
    }

    fn pass_finished(&self, _: u32, error: Option<ErrorEstimate>) {
        self.pass.fetch_add(1, Ordering::Relaxed);
        *self.error.write().unwrap_or_else(PoisonError::into_inner) = error;
    }

    fn image(&self, film: &Film) {
        self.picture.iter().for_each(|picture| picture.show_unfinished(film));
    }

    fn checkpoint_failed(&self, failure: &WriteFailure) {
        // What was asked for did not happen: that is said even where quiet is asked for.
        say(&format!("warning: the pass is not kept: {failure}"));
    }

    fn cancelled(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}
