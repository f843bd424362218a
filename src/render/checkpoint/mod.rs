//! Checkpoints: a render between two passes as a file, so that it goes on to the same bytes after the process has ended.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `photonvc` |
//! | 4 | number of the format |
//! | 4, 8 | lengths of the two parts that follow |
//! | 8, 8 | their hashes |
//! | | the account: JSON, of version, settings and counts |
//! | | the numbers: the film, the halves of the error estimate and the figures of the report ([`columns`]) |
//!
//! All numbers are little-endian. The account is compared with the scene before the numbers are read, and tells how many there
//! may be. The file is written beside its target and renamed: there is the old one or the new one.

mod columns;
mod error;
mod source;

pub use error::CheckpointError;

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::estimate::CountLaw;
use crate::files::WriteFailure;
use crate::film::{Pixel, PixelDepths};
use crate::math::Rgb;
use crate::render::error_estimate::{ErrorProbes, probed_count};
use crate::render::light_groups::{LightGroups, empty_film};
use crate::render::regression::MAX_FILTER_RADIUS;
use crate::render::{
    Calibration, CostlyLayers, ErrorEstimate, Gather, MAX_LATTICE, RenderOptions, RenderReport,
    RenderState, StageSeconds, photons_per_pass,
};
use crate::scene::Scene;
use crate::trace::PowerBalance;
use columns::{Layers, layer_limit, push_layer};
use source::{Source, write_parts};

/// The layers of colours of a pixel, in the order of the file.
const COLORS: [fn(&mut Pixel) -> &mut Rgb; 5] = [
    |pixel| &mut pixel.single_scatter,
    |pixel| &mut pixel.multiple_scatter,
    |pixel| &mut pixel.emission,
    |pixel| &mut pixel.transmittance,
    |pixel| &mut pixel.variance,
];

/// The layers of single numbers.
const SCALARS: [fn(&mut Pixel) -> &mut f64; 3] = [
    |pixel| &mut pixel.photon_count,
    |pixel| &mut pixel.kernel_radius,
    |pixel| &mut pixel.sample_count,
];

/// Figures of the report: four stages, five powers, a calibration, and the time spent.
const FIGURES: usize = 4 + 15 + 4 + 1;

/// What stands before the numbers.
#[derive(Debug, Serialize, Deserialize)]
struct Account {
    version: String,
    settings: Vec<(String, String)>,
    begun: u32,
    passes_done: u32,
    half_counts: [u32; 2],
    lattice: usize,
    next_measure: u32,
    filter_radius: usize,
    /// Noise and bias, as measured last.
    error: Option<[f64; 2]>,
    probed: usize,
    emitted_count: u64,
    stored_count: u64,
    bytes_per_photon: usize,
    is_calibrated: bool,
}

impl RenderState {
    /// Writes the state, with what it needs to be known again, in place of what was at `path`.
    ///
    /// # Errors
    /// The file cannot be written; what was there is untouched.
    pub fn save(
        &self,
        path: &Path,
        scene: &Scene,
        options: &RenderOptions,
    ) -> Result<(), WriteFailure> {
        let account = serde_json::to_vec(&self.account(scene, options))
            .map_err(|error| WriteFailure { path: path.to_path_buf(), source: error.into() })?;
        write_parts(path, &account, &self.numbers())
    }

    /// Reads a state that [`RenderState::save`] wrote, for a scene and options that it can go on with: equal in everything that
    /// later passes depend on. Passes, target error and time may differ, as they only say when to end.
    ///
    /// # Errors
    /// The file is not there, is not a whole checkpoint, or is one of another render.
    pub fn load(
        path: &Path,
        scene: &Scene,
        options: &RenderOptions,
    ) -> Result<Self, CheckpointError> {
        let mut source = Source::open(path)?;
        let account: Account = serde_json::from_slice(&source.read_account()?)
            .map_err(|_| source.damaged("its account cannot be read"))?;
        account.check(path, scene, options)?;
        let numbers = source.read_numbers(account.longest_numbers(scene, options))?;
        let state = account.into_state(&numbers, scene, options);
        state.ok_or_else(|| source.damaged("its numbers contradict each other"))
    }

    fn account(&self, scene: &Scene, options: &RenderOptions) -> Account {
        let Self { report, probes, .. } = self;
        Account {
            version: env!("CARGO_PKG_VERSION").to_string(),
            settings: settings(scene, options),
            begun: self.begun,
            passes_done: report.passes_done,
            half_counts: probes.counts,
            lattice: self.resolution,
            next_measure: self.next_measure,
            filter_radius: self.filter_radius,
            error: report.error.map(|error| [error.noise, error.bias]),
            probed: probes.differences.len(),
            emitted_count: report.emitted_count,
            stored_count: report.stored_count,
            bytes_per_photon: report.bytes_per_photon,
            is_calibrated: report.calibration.is_some(),
        }
    }

    fn numbers(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let pixels = &self.film.pixels;
        for color in COLORS {
            push_layer(&mut bytes, pixels.iter().map(|pixel| color(&mut pixel.clone()).to_array()));
        }
        for scalar in SCALARS {
            push_layer(&mut bytes, pixels.iter().map(|pixel| [*scalar(&mut pixel.clone())]));
        }
        if let Some(depths) = &self.film.depths {
            push_layer(&mut bytes, depths.iter().map(depth_numbers));
        }
        for light in &self.film.lights {
            push_layer(&mut bytes, light.radiance.iter().map(|radiance| radiance.to_array()));
        }
        for half in self.probes.halves.iter().chain(&self.probes.multiples) {
            push_layer(&mut bytes, half.iter().map(|radiance| radiance.to_array()));
        }
        push_layer(&mut bytes, self.probes.differences.iter().copied());
        push_layer(&mut bytes, std::iter::once(self.figures()));
        bytes
    }

    fn figures(&self) -> [f64; FIGURES] {
        let RenderReport { seconds, power, calibration, .. } = &self.report;
        let mut figures = vec![seconds.trace, seconds.build, seconds.gather, seconds.calibrate];
        for flow in [power.emitted, power.absorbed, power.escaped, power.truncated, power.resampled]
        {
            figures.extend(flow.to_array());
        }
        let none = Calibration {
            constant: 0.0,
            std_error: 0.0,
            law: CountLaw { variance: 0.0, exponent: 0.0 },
        };
        let Calibration { constant, std_error, law } = calibration.unwrap_or(none);
        figures.extend([constant, std_error, law.variance, law.exponent, self.seconds]);
        std::array::from_fn(|index| figures.get(index).copied().unwrap_or(0.0))
    }
}

fn depth_numbers(depths: &PixelDepths) -> [f64; 4] {
    let &PixelDepths { half_distance, half_share, scatter_distance, scatter_weight } = depths;
    [half_distance, half_share, scatter_distance, scatter_weight]
}

fn depths_of(numbers: [f64; 4]) -> PixelDepths {
    let [half_distance, half_share, scatter_distance, scatter_weight] = numbers;
    PixelDepths { half_distance, half_share, scatter_distance, scatter_weight }
}

/// Everything that passes depend on, each under a name to tell people: what is likeliest to be mistyped first, and the hash of
/// all that has no name last.
fn settings(scene: &Scene, options: &RenderOptions) -> Vec<(String, String)> {
    let mut settings = scene.settings();
    let is_limited = options.has_limit();
    settings.push(("photons a pass".into(), photons_per_pass(scene, options).to_string()));
    settings.push(("--target-error or --time-budget given".into(), is_limited.to_string()));
    let CostlyLayers { depths, lights } = options.layers;
    settings.push(("--layers depth".into(), depths.to_string()));
    settings.push(("--layers lights".into(), lights.to_string()));
    settings.push((SCENE_HASH.into(), format!("{:016x}", scene.hash)));
    settings
}

const SCENE_HASH: &str = "scene hash";

impl Account {
    /// Refuses what is of another render.
    fn check(
        &self,
        path: &Path,
        scene: &Scene,
        options: &RenderOptions,
    ) -> Result<(), CheckpointError> {
        let path = path.to_path_buf();
        let own = env!("CARGO_PKG_VERSION");
        if self.version != own {
            return Err(CheckpointError::OtherVersion { path, found: self.version.clone(), own });
        }
        let own_settings = settings(scene, options);
        let value_in = |settings: &[(String, String)], name: &str| {
            let found = settings.iter().find(|(other, _)| other == name);
            found.map_or_else(|| "its default".to_string(), |(_, value)| value.clone())
        };
        // Keys that are left out at their default may stand on one side only; the scene's hash comes last.
        let names = self.settings.iter().chain(&own_settings).map(|(name, _)| name.as_str());
        let named = names.filter(|name| *name != SCENE_HASH).collect::<Vec<_>>();
        for name in named.into_iter().chain([SCENE_HASH]) {
            let found = value_in(&self.settings, name);
            let asked = value_in(&own_settings, name);
            if found != asked {
                return Err(match name == SCENE_HASH {
                    true => CheckpointError::OtherScene { path, found, asked },
                    false => {
                        CheckpointError::OtherSetting { path, name: name.into(), found, asked }
                    }
                });
            }
        }
        let (found, asked) = (self.passes_done, options.passes);
        match found > asked {
            true => Err(CheckpointError::TooManyPasses { path, found, asked }),
            false => Ok(()),
        }
    }

    /// The most bytes that the numbers may take.
    fn longest_numbers(&self, scene: &Scene, options: &RenderOptions) -> u64 {
        let pixels = scene.camera.width * scene.camera.height;
        let lights = LightGroups::of(scene, options).names.len();
        let colors = COLORS.len() + lights + 2 * self.half_counts.len();
        colors as u64 * layer_limit(3, pixels)
            + SCALARS.len() as u64 * layer_limit(1, pixels)
            + layer_limit(2, pixels)
            + layer_limit(4, pixels)
            + layer_limit(FIGURES, 1)
    }

    /// The state, if account and numbers fit each other.
    fn into_state(
        self,
        numbers: &[u8],
        scene: &Scene,
        options: &RenderOptions,
    ) -> Option<RenderState> {
        let (width, height) = (scene.camera.width, scene.camera.height);
        let is_lattice = scene.render.gather != Gather::Knn;
        let lattices = if is_lattice { 2..=MAX_LATTICE } else { 0..=0 };
        let probed = if is_lattice { probed_count(width, height) } else { 0 };
        let [even, odd] = self.half_counts;
        let fits = lattices.contains(&self.lattice)
            && self.probed == probed
            && even.checked_add(odd) == Some(self.passes_done)
            && (1..=self.begun).contains(&self.passes_done)
            && (options.has_limit() || self.begun == self.passes_done)
            && self.begun < u32::MAX / 2
            && self.filter_radius <= MAX_FILTER_RADIUS
            && self.emitted_count.max(self.stored_count) < u64::MAX / 2;
        if !fits {
            return None;
        }
        let mut layers = Layers { rest: numbers };
        let mut film = empty_film(scene, options);
        let count = film.pixels.len();
        for color in COLORS {
            let values = layers.next::<3>(count)?;
            film.pixels.iter_mut().zip(values).for_each(|(p, v)| *color(p) = v.into());
        }
        for scalar in SCALARS {
            let values = layers.next::<1>(count)?;
            film.pixels.iter_mut().zip(values).for_each(|(p, [v])| *scalar(p) = v);
        }
        if let Some(depths) = &mut film.depths {
            *depths = layers.next::<4>(count)?.into_iter().map(depths_of).collect();
        }
        for light in &mut film.lights {
            light.radiance = layers.next::<3>(count)?.into_iter().map(Rgb::from).collect();
        }
        let mut half = || Some(layers.next::<3>(count)?.into_iter().map(Rgb::from).collect());
        let (halves, multiples) = ([half()?, half()?], [half()?, half()?]);
        let differences = layers.next::<2>(self.probed)?;
        let probes = ErrorProbes { halves, multiples, counts: self.half_counts, differences };
        let figures = layers.next::<FIGURES>(1)?.pop()?;
        let seconds = figures[FIGURES - 1];
        let is_time = seconds.is_finite() && seconds >= 0.0;
        (layers.rest.is_empty() && is_time).then(|| RenderState {
            begun: self.begun,
            resolution: self.lattice,
            next_measure: self.next_measure,
            filter_radius: self.filter_radius,
            seconds,
            film,
            report: self.report(&figures),
            probes,
        })
    }

    fn report(&self, figures: &[f64; FIGURES]) -> RenderReport {
        let flow = |number: usize| Rgb::from_slice(&figures[4 + 3 * number..]);
        let [constant, std_error, variance, exponent] =
            std::array::from_fn(|index| figures[19 + index]);
        let calibration = Calibration { constant, std_error, law: CountLaw { variance, exponent } };
        RenderReport {
            emitted_count: self.emitted_count,
            stored_count: self.stored_count,
            bytes_per_photon: self.bytes_per_photon,
            power: PowerBalance {
                emitted: flow(0),
                absorbed: flow(1),
                escaped: flow(2),
                truncated: flow(3),
                resampled: flow(4),
            },
            seconds: StageSeconds {
                trace: figures[0],
                build: figures[1],
                gather: figures[2],
                calibrate: figures[3],
            },
            calibration: self.is_calibrated.then_some(calibration),
            passes_done: self.passes_done,
            filter_radius: 0,
            error: self.error.map(|[noise, bias]| ErrorEstimate { noise, bias }),
        }
    }
}
