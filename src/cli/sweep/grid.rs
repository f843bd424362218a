//! The settings that lists of values span. Each meets the limits that the scene file sets.

use photonvdb::lab::SweepSetting;
use photonvdb::scene::{Overrides, SceneError, SceneFile};

use super::args::SweepArguments;
use crate::cli::error::CliError;

/// More settings than a table has use for.
const MOST: u128 = 10_000;

/// Every combination of the values asked for: knn, lattice, targets, paths.
pub fn settings(arguments: &SweepArguments) -> Result<Vec<SweepSetting>, CliError> {
    let divisors = or_scene(&arguments.divisor);
    let emissions = or_scene(&arguments.emission);
    let samples = or_scene(arguments.samples.as_ref().map_or(&[], |list| &list.0));
    let cells = or_scene(arguments.lattice.as_ref().map_or(&[], |list| &list.0));
    let photons = &arguments.photons.0;
    let gathers = |name: &str| arguments.gather.iter().any(|gather| gather == name);

    let mut grid: Vec<(Mode, Overrides)> = Vec::new();
    let mut add = |mode, choice: Overrides| {
        if grid.len() as u128 >= MOST {
            return Err(CliError::TooManySettings { limit: MOST });
        }
        grid.push((mode, choice));
        Ok(())
    };
    for emission in &emissions {
        for &photons in photons {
            for &samples_per_pixel in &samples {
                let with = |gather: &str| Overrides {
                    photons: Some(photons),
                    emission: emission.clone(),
                    samples_per_pixel,
                    gather: Some(gather.to_owned()),
                    ..Overrides::default()
                };
                if gathers("knn") {
                    for divisor in &divisors {
                        for &k in &arguments.k.0 {
                            let divisor = divisor.clone();
                            add(Mode::Knn, Overrides { k: Some(k), divisor, ..with("knn") })?;
                        }
                    }
                }
                if gathers("lattice") {
                    for &lattice in &cells {
                        add(Mode::Lattice, Overrides { lattice, ..with("lattice") })?;
                    }
                }
            }
        }
        for &error in &arguments.target_error.0 {
            let emission = emission.clone();
            add(Mode::Target { error }, Overrides { emission, ..Overrides::default() })?;
        }
    }
    for &paths in &arguments.spp.0 {
        add(Mode::Paths { paths }, Overrides::default())?;
    }
    grid.sort_by_key(|(mode, _)| mode.rank());
    let settings = grid.into_iter().map(|(mode, choice)| mode.setting(arguments, &choice));
    let settings: Vec<SweepSetting> = settings.collect::<Result<_, _>>()?;
    if settings.is_empty() { Err(CliError::NothingToSweep) } else { Ok(settings) }
}

#[derive(Clone, Copy)]
enum Mode {
    Knn,
    Lattice,
    Target { error: f64 },
    Paths { paths: u64 },
}

impl Mode {
    fn rank(self) -> u8 {
        match self {
            Self::Knn => 0,
            Self::Lattice => 1,
            Self::Target { .. } => 2,
            Self::Paths { .. } => 3,
        }
    }

    /// With what the scene file says where the choice says nothing.
    fn setting(
        self,
        arguments: &SweepArguments,
        choice: &Overrides,
    ) -> Result<SweepSetting, SceneError> {
        let SceneFile { photons, estimate, render, .. } =
            SceneFile::load(&arguments.scene, choice)?;
        let (emission, rays) = (photons.emission, render.samples_per_pixel);
        Ok(match self {
            Self::Knn => {
                let (k, divisor) = (estimate.k, estimate.divisor);
                SweepSetting::Knn { photons: photons.count, emission, k, divisor, rays }
            }
            Self::Lattice => {
                let cells = render.lattice;
                SweepSetting::Lattice { photons: photons.count, emission, cells, rays }
            }
            Self::Target { error } => SweepSetting::Target { error, emission },
            Self::Paths { paths } => SweepSetting::Paths { paths },
        })
    }
}

/// The values, each once, or what the scene says where there are none.
fn or_scene<T: Clone + PartialEq>(values: &[T]) -> Vec<Option<T>> {
    let mut once: Vec<Option<T>> = Vec::new();
    for value in values {
        if !once.contains(&Some(value.clone())) {
            once.push(Some(value.clone()));
        }
    }
    if once.is_empty() { vec![None] } else { once }
}
