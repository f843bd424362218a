//! What is swept, and what comes of it.

use serde::Serialize;

use super::error::SweepError;
use super::front::pareto_front;
use super::row::SweepRow;
use super::setting::SweepSetting;
use super::split::ErrorSplit;
use super::truth::{KnownImage, Truth};
use crate::film::RgbImage;
use crate::math::Stream;
use crate::medium::Bounds;
use crate::reference::{Limits, Unwatched, render_reference};
use crate::render::RenderError;
use crate::scene::{RenderSettings, Scene};

/// Most channels of all pixels of all runs of a setting: 4 bytes each.
const MOST_CHANNELS: u128 = 250_000_000;

/// Seeds of runs and of the reference come from different branches of the sweep's own.
const RUN_BRANCH: u64 = 200;
const REFERENCE_BRANCH: u64 = 201;

/// Settings to be compared.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Ways of making the image, one a row.
    pub settings: Vec<SweepSetting>,
    /// Independent images of each, at least 2.
    pub runs: u64,
    /// Seed of everything. What a row says does not depend on the other rows.
    pub seed: u64,
    /// Paths a pixel of the reference, where none is given.
    pub reference_paths: u64,
}

/// The rows, in the order of the settings, and what they are held against.
#[derive(Clone, Debug, Serialize)]
pub struct SweepTable {
    /// One a setting.
    pub rows: Vec<SweepRow>,
    /// What images are held against.
    pub reference: SweepReference,
}

/// What images are held against.
#[derive(Clone, Debug, Serialize)]
pub struct SweepReference {
    /// \[pixels\]
    pub width: usize,
    /// \[pixels\]
    pub height: usize,
    /// Paths a pixel, where the sweep made it itself.
    pub paths: Option<u64>,
    /// Root mean square of its own noise over its mean, which is taken off; `None` where it is not known.
    pub noise: Option<f64>,
}

impl Sweep {
    /// Renders every setting at the size of the scene's camera and holds it against the reference given, or against one made
    /// by the path tracer. `processor_seconds` tells the time of the process so far; `advanced` hears of each image that is
    /// done: [`Self::step_count`] in all. The scene's settings are left as they were last used.
    ///
    /// # Errors
    /// The scene cannot be rendered, the reference has another size or no light, there are fewer than 2 runs, or more would be kept
    /// than memory allows.
    pub fn tabulate(
        &self,
        scene: &mut Scene,
        reference: Option<&KnownImage>,
        processor_seconds: impl Fn() -> Option<f64>,
        mut advanced: impl FnMut(),
    ) -> Result<SweepTable, SweepError> {
        let [width, height] = [scene.camera.width, scene.camera.height];
        self.check(scene)?;
        let planned = scene.render;
        let made;
        let known = match reference {
            Some(given) => given,
            None => {
                made = self.make_reference(scene)?;
                advanced();
                &made
            }
        };
        let paths = reference.is_none().then_some(self.reference_paths);
        let truth = Truth::new(known, [width, height])?;
        let mut rows = Vec::with_capacity(self.settings.len());
        for setting in &self.settings {
            rows.push(self.measure(
                setting,
                (scene, planned),
                &truth,
                &processor_seconds,
                &mut advanced,
            )?);
        }
        mark_front(&mut rows);
        let noise = known.variance.as_ref().map(|_| truth.variance.sqrt() / truth.mean);
        Ok(SweepTable { rows, reference: SweepReference { width, height, paths, noise } })
    }

    /// Images that are made, the reference among them if none is given.
    pub fn step_count(&self, is_reference_given: bool) -> u64 {
        self.settings.len() as u64 * self.runs + u64::from(!is_reference_given)
    }

    /// What can fail must fail before the work, not after it.
    fn check(&self, scene: &Scene) -> Result<(), SweepError> {
        if matches!(scene.medium.bounds, Bounds::Infinite) {
            return Err(RenderError::InfiniteMedium.into());
        }
        let needs_lattice =
            |setting: &SweepSetting| matches!(setting, SweepSetting::Lattice { .. });
        if scene.medium.shared_phase().is_none() && self.settings.iter().any(needs_lattice) {
            return Err(RenderError::NoLattice.into());
        }
        if self.runs < 2 {
            return Err(SweepError::TooFewRuns { runs: self.runs });
        }
        let channels = 3 * scene.camera.width as u128 * scene.camera.height as u128;
        let values = channels * u128::from(self.runs);
        if values > MOST_CHANNELS {
            return Err(SweepError::TooMuch { values, limit: MOST_CHANNELS });
        }
        Ok(())
    }

    fn make_reference(&self, scene: &mut Scene) -> Result<KnownImage, SweepError> {
        scene.photons.seed = Stream::Experiment.hash(self.seed, REFERENCE_BRANCH);
        let limits = Limits { samples: Some(self.reference_paths), ..Limits::default() };
        let reference = render_reference(scene, &limits, &Unwatched)?;
        Ok(KnownImage::from(&reference.film))
    }

    fn measure(
        &self,
        setting: &SweepSetting,
        (scene, planned): (&mut Scene, RenderSettings),
        truth: &Truth,
        processor_seconds: &impl Fn() -> Option<f64>,
        advanced: &mut impl FnMut(),
    ) -> Result<SweepRow, SweepError> {
        let branch = Stream::Experiment.hash(self.seed, RUN_BRANCH);
        let mut images = Vec::new();
        let (mut seconds, mut estimated) = (Some(0.0), Some(0.0));
        for run in 0..self.runs {
            let started = processor_seconds();
            let made = setting.make(scene, planned, Stream::Experiment.hash(branch, run))?;
            let spent = started.zip(processor_seconds()).map(|(start, end)| end - start);
            seconds = seconds.zip(spent).map(|(sum, spent)| sum + spent);
            estimated = estimated.zip(made.estimated_error).map(|(sum, e)| sum + e * e);
            images.push(RgbImage::from(&made.film).pixels.into_flattened());
            advanced();
        }
        let runs = self.runs as f64;
        let estimated = estimated.map(|squares| (squares / runs).sqrt());
        let split = ErrorSplit::of(&images, truth);
        Ok(SweepRow::new(setting, self.runs, split, estimated, seconds.map(|sum| sum / runs)))
    }
}

fn mark_front(rows: &mut [SweepRow]) {
    let points: Vec<(f64, f64)> =
        rows.iter().map(|row| (row.cpu_seconds.unwrap_or(f64::NAN), row.error)).collect();
    for (row, is_on_front) in rows.iter_mut().zip(pareto_front(&points)) {
        row.is_on_front = is_on_front;
    }
}
