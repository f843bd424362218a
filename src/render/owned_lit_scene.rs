//! A scene and its photon map in one value, for hosts that cannot keep a borrow: foreign languages, long-lived objects.

use std::num::NonZeroUsize;
use std::sync::Arc;

use crate::estimate::{Divisor, Kernel};
use crate::map::PhotonMap;
use crate::medium::MediumExtinction;
use crate::render::lit_medium::{map_reader, photons_of_estimate};
use crate::render::{LightReader, LitScene, Observer, RenderError, RenderReport};
use crate::scene::Scene;

/// A [`LitScene`] that owns its scene, or shares it. Shared by all threads; each takes a reader of its own.
#[derive(Debug)]
pub struct OwnedLitScene {
    scene: Arc<Scene>,
    map: PhotonMap,
    /// What the scene's k photons count as.
    constant: f64,
    report: RenderReport,
}

/// The calibrated divisor was asked for and had not been measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the divisor \"calibrated\" is measured with the map: ask for it in the scene")]
pub struct NotCalibrated;

impl OwnedLitScene {
    /// Emits and traces the scene's photons and builds their map.
    ///
    /// # Errors
    /// More photons than memory allows.
    pub fn prepare(
        scene: impl Into<Arc<Scene>>,
        observer: &dyn Observer,
    ) -> Result<Self, RenderError> {
        let scene = scene.into();
        let (map, constant, report) = LitScene::prepare(&scene, observer)?.into_map();
        Ok(Self { scene, map, constant, report })
    }

    /// A reader for one thread, with the scene's k and divisor.
    pub fn reader(&self) -> Box<dyn LightReader + '_> {
        self.reader_of(photons_of_estimate(&self.scene), self.constant)
    }

    /// A reader for one thread whose estimates are of k photons that count as `divisor` says.
    ///
    /// # Errors
    /// The calibrated divisor where the scene asks for another: nothing was measured.
    pub fn reader_with(
        &self,
        k: NonZeroUsize,
        divisor: Divisor,
    ) -> Result<Box<dyn LightReader + '_>, NotCalibrated> {
        let calibrated = || match self.scene.estimate.kernel {
            // The k-th photon has no weight: there is nothing to leave out.
            Kernel::Epanechnikov => Divisor::KMinus1.constant(k),
            Kernel::Constant => {
                let calibration = self.report.calibration?;
                Some(calibration.law.constant(k.get() as f64))
            }
        };
        let constant = divisor.constant(k).or_else(calibrated).ok_or(NotCalibrated)?;
        Ok(self.reader_of(k, constant))
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The photon map.
    pub fn map(&self) -> &PhotonMap {
        &self.map
    }

    /// How the map was made: photons, powers, seconds.
    pub fn report(&self) -> &RenderReport {
        &self.report
    }

    fn reader_of(&self, k: NonZeroUsize, constant: f64) -> Box<dyn LightReader + '_> {
        let Self { scene, map, .. } = self;
        match &scene.medium.extinction {
            MediumExtinction::Uniform(uniform) => {
                Box::new(map_reader(scene, uniform, map, k, constant))
            }
            MediumExtinction::Chromatic(chromatic) => {
                Box::new(map_reader(scene, chromatic, map, k, constant))
            }
            MediumExtinction::Grid(grid) => Box::new(map_reader(scene, &**grid, map, k, constant)),
            MediumExtinction::Several(volumes) => {
                Box::new(map_reader(scene, &**volumes, map, k, constant))
            }
        }
    }
}
