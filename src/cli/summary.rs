//! What a render says to people, on stderr.

use photonvdb::render::{CalibrationFigures, PhotonCounts, RenderReport, StageSeconds};
use photonvdb::scene::{Plan, Scene};
use photonvdb::trace::PowerBalance;

use super::console::say;
use super::render::args::RenderArguments;
use super::report::{Comparison, Report, Seconds, is_stdout};

/// Speaks unless told to be quiet.
#[derive(Clone, Copy)]
pub struct Summary {
    pub quiet: bool,
}

impl Summary {
    /// What was mended on loading, and what is going to be done.
    pub fn plan(self, scene: &Scene, plan: &Plan) {
        for warning in &scene.warnings {
            self.line(&format!("warning: {warning}"));
        }
        self.line(&plan.to_string());
    }

    /// Flags that change nothing, and what they are for.
    pub fn idle_flags(self, flags: &[(&str, &str)]) {
        for (flag, purpose) in flags {
            self.line(&format!("warning: {flag} changes nothing here: it is for {purpose}"));
        }
    }

    /// What a checkpoint holds.
    pub fn resumed(self, passes: u32, seconds: f64) {
        self.line(&format!("going on after {passes} passes and {seconds:.1} s"));
    }

    /// That the render was asked to end.
    pub fn interrupted(self, passes_done: u32) {
        self.line(&format!("ended after pass {passes_done}"));
    }

    /// What it took, and what came of it.
    pub fn report(self, made: &RenderReport, report: &Report, max_order: u32) {
        let figures = &report.figures;
        self.times(&report.seconds, &figures.photons);
        figures.calibration.iter().for_each(|calibration| self.calibration(calibration));
        self.power(&figures.power, max_order);
        self.error(made);
        report.comparison.iter().for_each(|comparison| self.comparison(comparison));
    }

    /// How far the image is from the truth, by its own account.
    fn error(self, made: &RenderReport) {
        let Some(error) = made.error else { return };
        let percent = |share: f64| format!("{:.2} %", 100.0 * share);
        let filter = match made.filter_radius {
            0 => String::new(),
            radius => format!("; multiple scattering filtered over {radius} pixels"),
        };
        self.line(&format!(
            "{} passes: estimated error {} of the mean (noise {}, bias {}){filter}",
            made.passes_done,
            percent(error.total()),
            percent(error.noise),
            percent(error.bias)
        ));
    }

    /// Where the time went.
    fn times(self, seconds: &Seconds, photons: &PhotonCounts) {
        let Seconds { load, stages, write, total } = seconds;
        let StageSeconds { trace, build, calibrate, gather } = stages;
        let calibrate = match *calibrate {
            0.0 => String::new(),
            seconds => format!("calibrate {seconds:.2}, "),
        };
        self.line(&format!(
            "{total:.2} s: load {load:.2}, trace {trace:.2}, build {build:.2}, {calibrate}gather {gather:.2}, write {write:.2}"
        ));
        let speed = photons.emitted as f64 / trace.max(f64::MIN_POSITIVE);
        // A lattice stores none, and has no need to say so.
        let stored = match photons.stored {
            0 => String::new(),
            stored => format!(", {stored} stored"),
        };
        let emitted = photons.emitted;
        self.line(&format!("{emitted} photons emitted{stored}, {} a second", rounded(speed)));
    }

    /// What the divisor was measured to be.
    fn calibration(self, calibration: &CalibrationFigures) {
        let CalibrationFigures { k, constant, std_error, .. } = calibration;
        self.line(&format!(
            "divisor calibrated: {k} photons count as {constant:.3} +- {std_error:.3}"
        ));
    }

    /// That no light was sent, or that photons were cut off at the last order followed, if it shows.
    fn power(self, power: &PowerBalance, max_order: u32) {
        let [emitted, truncated] = [power.emitted, power.truncated].map(|rgb| rgb.element_sum());
        if emitted == 0.0 {
            self.line(
                "warning: no light falls on the medium: every light is dark or shines past it",
            );
        }
        let share = truncated / emitted;
        if share > 1e-3 {
            let percent = 100.0 * share;
            self.line(&format!(
                "warning: {percent:.1} % of the power was cut at photons.max_order = {max_order}; raise it"
            ));
        }
    }

    /// How far the image is from its reference.
    fn comparison(self, comparison: &Comparison) {
        self.line(&format!(
            "against {}: mean {:.4} of the reference, relative RMSE {:.4}, {:.4} in blocks of 16",
            comparison.reference.display(),
            comparison.mean_ratio,
            comparison.rel_rmse,
            comparison.block_rel_rms
        ));
    }

    /// What was written.
    pub fn written(self, arguments: &RenderArguments) {
        let report = arguments.report.as_ref().filter(|path| !is_stdout(path));
        let checkpoint = arguments.checkpoint.as_ref();
        let files = [Some(&arguments.output), arguments.preview.as_ref(), checkpoint, report];
        let names: Vec<_> =
            files.into_iter().flatten().map(|path| path.display().to_string()).collect();
        self.line(&format!("wrote {}", names.join(", ")));
    }

    fn line(self, text: &str) {
        if !self.quiet {
            say(text);
        }
    }
}

/// A speed for people: `812`, `35 thousand` or `1.2 million`.
fn rounded(value: f64) -> String {
    match value {
        _ if value >= 1e6 => format!("{:.1} million", value / 1e6),
        _ if value >= 1e4 => format!("{:.0} thousand", value / 1e3),
        _ => format!("{value:.0}"),
    }
}
