//! What is compared in a scene, and what comes of it.

use serde::Serialize;

use super::error::SceneComparisonError;
use super::pixels::ReferenceImage;
use super::row::{PixelRow, PointRow};
use super::{pixels, points};
use crate::emission::EmissionKind;
use crate::film::RgbImage;
use crate::lab::compare::request::emission_name;
use crate::lab::compare::saving::Saving;
use crate::lab::error::LabError;
use crate::medium::Bounds;
use crate::render::Gather;
use crate::render::RenderError;
use crate::scene::Scene;

/// What is compared in a scene.
#[derive(Clone, Debug)]
pub struct SceneComparison {
    /// Ways of emission; ratios are to the random one, if it is among them.
    pub emissions: Vec<EmissionKind>,
    /// Photons of the estimate at points: 2 or more. Pixels take those of the scene.
    pub ks: Vec<u64>,
    /// Photons emitted a run.
    pub n: u64,
    /// Maps, and images, of each way of emission: at least 2.
    pub runs: u64,
    /// Places asked, the same in every map.
    pub queries: u64,
    /// Photons of each render of the reference image, where none is given.
    pub reference_photons: u64,
    /// Seed of everything.
    pub seed: u64,
}

/// The rows, emission by emission, and what they cost.
#[derive(Clone, Debug, Serialize)]
pub struct SceneTable {
    /// Estimates at places, k by k.
    pub points: Vec<PointRow>,
    /// Images.
    pub pixels: Vec<PixelRow>,
    /// One for each way of emission.
    pub costs: Vec<SceneCost>,
    /// What points save over random emission.
    pub point_savings: Vec<Saving>,
    /// What images save; k is the scene's.
    pub pixel_savings: Vec<Saving>,
    /// What both are held against.
    pub reference: SceneReference,
}

/// Processor time of one way of emission \[s\]; `None` where the system does not tell.
#[derive(Clone, Debug, Serialize)]
pub struct SceneCost {
    /// Name of the way of emission.
    pub emission: &'static str,
    /// Of a map, from emission to the last query.
    pub seconds_per_map: Option<f64>,
    /// Of an image.
    pub seconds_per_image: Option<f64>,
}

/// What estimates are held against.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReference {
    /// Maps that the power in a ball is the mean of.
    pub maps: u64,
    /// Photons of a map in the ball that stands for a point.
    pub photons_in_inner_ball: f64,
    /// Renders that the reference image is the mean of; 0 of a given image.
    pub image_runs: u64,
    /// Photons of each; 0 of a given image.
    pub image_photons: u64,
    /// Standard error of the image's mean, relative; 0 of a given image, whose errors are not known.
    pub image_std_error: f64,
    /// Root of the variance of its pixels, relative to their light; 0 of a given image.
    pub image_noise: f64,
}

impl SceneComparison {
    /// Measures everything, in images of the size of the scene's camera. `reference` may be larger by a whole factor.
    /// `processor_seconds` tells the processor time of the process so far; `advanced` hears of each map and image that is done:
    /// [`Self::step_count`] in all. The scene's photons are left as they were last used.
    ///
    /// # Errors
    /// The scene cannot be rendered, its map is too small for a k, the reference has another shape, or more would be kept
    /// than memory allows.
    pub fn tabulate(
        &self,
        scene: &mut Scene,
        reference: Option<&RgbImage>,
        processor_seconds: impl Fn() -> Option<f64>,
        mut advanced: impl FnMut(),
    ) -> Result<SceneTable, SceneComparisonError> {
        if matches!(scene.medium.bounds, Bounds::Infinite) {
            return Err(RenderError::InfiniteMedium.into());
        }
        let mut ks = self.ks.clone();
        ks.sort_unstable();
        ks.dedup();
        if let Some(&k) = ks.first().filter(|&&k| k < 2) {
            return Err(LabError::InfiniteMean { k }.into());
        }
        let size = [scene.camera.width, scene.camera.height];
        pixels::check(self, size)?;
        // What can fail must fail before the work, not after it.
        let reference = match reference {
            Some(image) => ReferenceImage::given(image, size)?,
            None => pixels::make_reference(self, scene, &mut advanced)?,
        };
        // The k asked for is one of photon maps.
        scene.render.gather = Gather::Knn;
        scene.photons.count = self.n;
        let points = points::measure(self, scene, &ks, &processor_seconds, &mut advanced)?;
        let images = pixels::measure(self, scene, reference, &processor_seconds, &mut advanced)?;

        let point_rows = PointRow::table(self, &ks, &points);
        let pixel_rows = PixelRow::table(self, scene, &images);
        let costs = self.emissions.iter().zip(points.seconds.iter().zip(&images.seconds));
        let costs: Vec<SceneCost> = costs
            .map(|(&kind, (&seconds_per_map, &seconds_per_image))| SceneCost {
                emission: emission_name(kind),
                seconds_per_map,
                seconds_per_image,
            })
            .collect();
        let saving = |emission, k, ratio: Option<f64>, seconds: fn(&SceneCost) -> Option<f64>| {
            let of = |name| costs.iter().find(|cost| cost.emission == name).and_then(seconds);
            let random = emission_name(EmissionKind::Random);
            let ratio = ratio.filter(|_| emission != random)?;
            Some(Saving::new(emission, k, ratio, of(emission), of(random)))
        };
        let point_savings = point_rows.iter().filter_map(|row| {
            saving(row.emission, row.k, row.error_ratio, |cost| cost.seconds_per_map)
        });
        let pixel_savings = pixel_rows.iter().filter_map(|row| {
            saving(row.emission, row.k, row.variance_ratio, |cost| cost.seconds_per_image)
        });
        let (point_savings, pixel_savings) = (point_savings.collect(), pixel_savings.collect());
        let image = &images.reference;
        let reference = SceneReference {
            maps: self.emissions.len() as u64 * self.runs - 1,
            photons_in_inner_ball: points.inner_count,
            image_runs: image.runs,
            image_photons: if image.runs > 0 { self.reference_photons } else { 0 },
            image_std_error: image.std_error,
            image_noise: image.noise().sqrt(),
        };
        let (points, pixels) = (point_rows, pixel_rows);
        Ok(SceneTable { points, pixels, costs, point_savings, pixel_savings, reference })
    }

    /// Renders of the reference image, where none is given.
    pub fn reference_runs(&self) -> u64 {
        pixels::reference_runs(self.runs)
    }

    /// Maps and images that are made, those of a reference image if none is given.
    pub fn step_count(&self, is_reference_given: bool) -> u64 {
        let reference = if is_reference_given { 0 } else { self.reference_runs() };
        2 * self.emissions.len() as u64 * self.runs + reference
    }
}
