//! The scene: what the file says, checked and made ready.
//!
//! ```text
//! .toml / .json ──tree──▶ values with their lines ──file──▶ SceneFile ──build──▶ Scene ──plan──▶ Plan
//! ```
//! [`SceneFile`] holds every key with its default filled in; its documentation is the manual of the format.
//! [`Scene`] has opened the files it names, too, and nothing in it can be out of range.

mod build;
mod emission;
mod environment;
mod error;
mod expected_collisions;
mod file;
mod grid_reader;
mod grid_use;
mod hash;
mod light_counts;
mod overrides;
mod plan;
mod preset;
mod schema;
mod tree;
mod volume;

pub use error::SceneError;
pub use file::{
    BoundsSection, CameraSection, EmissionSection, EstimateSettings, FlameKeys, LightSection,
    MediumSection, PhaseSection, PhotonSettings, RenderSettings, SceneFile, TemperatureKeys,
    TransformSection,
};
pub use grid_use::{GridRole, GridUse};
pub use light_counts::LightCounts;
pub use overrides::Overrides;
pub use plan::{MediumKind, Plan};
pub use preset::Preset;
pub use schema::{json_schema, scene_reference};
pub use tree::Origin;

use std::path::Path;

use crate::camera::Camera;
use crate::light::Light;
use crate::math::Rgb;
use crate::medium::{Medium, MediumExtinction};
use error::Problem;
use volume::VolumeRules;

/// A validated scene. Nothing in it can be out of range.
#[derive(Debug)]
pub struct Scene {
    /// Where the image is taken from.
    pub camera: Camera,
    /// What fills it.
    pub medium: Medium,
    /// At least one, unless the medium has light of its own.
    pub lights: Vec<Light>,
    /// How photons are emitted and followed.
    pub photons: PhotonSettings,
    /// How the photon map is read.
    pub estimate: EstimateSettings,
    /// How pixels are sampled.
    pub render: RenderSettings,
    /// Of all values above, including the content of files they came from: equal for scenes that give the same
    /// image, however their files are written.
    pub hash: u64,
    /// The grids that the medium is made of.
    pub grids: Vec<GridUse>,
    /// Whether the number of photons was asked for: what is left open, a target error or a time budget decides.
    pub is_photon_count_given: bool,
    /// What was mended on loading, one sentence each.
    pub warnings: Vec<String>,
}

impl Scene {
    /// Loads a scene file (`.toml` or `.json`) and the files it names.
    ///
    /// # Errors
    /// The first thing wrong, as one sentence that names the file, the line (TOML) and the key.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        Self::load_with(path, &Overrides::default())
    }

    /// Loads a scene file with some of its values replaced.
    ///
    /// # Errors
    /// As [`Scene::load`]; a replaced value meets the same limits as one of the file.
    pub fn load_with(path: &Path, overrides: &Overrides) -> Result<Self, SceneError> {
        let (file, tree) = SceneFile::load_tree(path, overrides)?;
        let directory = path.parent().unwrap_or(Path::new(""));
        let scene = Self::build(&file, directory, &overrides.volume_rules())
            .map_err(|problem| problem.locate(path, &tree))?;
        Ok(Self { is_photon_count_given: file::has_key(&tree, "photons", "count"), ..scene })
    }

    /// Whether all light and all scattering is the same in the three channels.
    pub fn is_grey(&self) -> bool {
        let grey = |color: Rgb| color.x == color.y && color.y == color.z;
        let medium = &self.medium;
        grey(medium.albedo)
            && medium.color.is_none()
            && medium.emissivity.is_none()
            && !matches!(medium.extinction, MediumExtinction::Chromatic(_))
            && self.lights.iter().all(|light| light.color().is_some_and(grey))
    }

    fn build(file: &SceneFile, directory: &Path, rules: &VolumeRules) -> Result<Self, Problem> {
        let (mut warnings, mut grids) = (Vec::new(), Vec::new());
        let mut hashes = hash::FileHashes::new();
        let medium =
            build::medium(&file.medium, directory, rules, &mut warnings, &mut grids, &mut hashes)?;
        let lights = file.lights.iter().enumerate();
        let lights = lights
            .map(|(index, section)| build::light(section, &format!("light[{index}]"), directory))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            camera: file.camera.camera()?,
            medium,
            lights,
            photons: file.photons,
            estimate: file.estimate,
            render: file.render,
            hash: hash::scene_hash(file, directory, &hashes)?,
            grids,
            is_photon_count_given: true,
            warnings,
        })
    }
}
