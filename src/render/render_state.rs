//! What a render holds between two passes: with it and the scene every later pass is the same, byte for byte.

use crate::film::Film;
use crate::render::RenderReport;
use crate::render::error_estimate::{ErrorProbes, fewest_passes};
use crate::render::regression::first_radius;

/// A render between two passes. Read from a file it continues where it was written ([`RenderState::load`]).
#[derive(Clone, Debug)]
pub struct RenderState {
    /// Passes begun, with those that a finer lattice replaced.
    pub(super) begun: u32,
    /// Cells of the lattice along its longest side; 0 where light is gathered from the k nearest photons.
    pub(super) resolution: usize,
    /// Passes at which the error is measured next.
    pub(super) next_measure: u32,
    /// Radius of the filter that was best when the error was measured last, or is tried first \[pixels\].
    pub(super) filter_radius: usize,
    /// Wall-clock time spent on it \[s\].
    pub(super) seconds: f64,
    /// The mean of the passes.
    pub(super) film: Film,
    pub(super) probes: ErrorProbes,
    pub(super) report: RenderReport,
}

impl RenderState {
    /// No pass yet of a film of that size.
    pub(super) fn new(film: Film, resolution: usize) -> Self {
        Self {
            begun: 0,
            resolution,
            next_measure: fewest_passes(film.pixels.len()),
            filter_radius: first_radius(film.width, film.height),
            seconds: 0.0,
            probes: ErrorProbes::new(film.width, film.height),
            film,
            report: RenderReport::default(),
        }
    }

    /// Forgets the image and keeps the account of what it took.
    pub(super) fn restart_film(&mut self) {
        self.film.clear();
        self.probes = ErrorProbes::new(self.film.width, self.film.height);
        self.next_measure = fewest_passes(self.film.pixels.len());
        self.report.passes_done = 0;
        self.report.error = None;
    }

    /// Passes that the image is the mean of.
    pub fn passes_done(&self) -> u32 {
        self.report.passes_done
    }

    /// Wall-clock time spent on it \[s\], over all runs.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }
}
