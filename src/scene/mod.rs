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
mod loaded_grids;
mod media;
mod overrides;
mod plan;
mod preset;
mod schema;
mod settings;
mod tree;
mod volume;

pub use error::SceneError;
pub use file::{
    Background, BoundsSection, CameraSection, EmissionSection, EstimateSettings, FlameKeys,
    LightSection, MediumSection, NamedLight, PhaseSection, PhotonSettings, RenderSettings,
    SceneFile, TemperatureKeys, TransformSection,
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
use crate::medium::Medium;
use crate::medium::vdb::SparseGrid;
use crate::render::Gather;
use error::Problem;
use expected_collisions::expected_collisions;
use media::MediaNotes;
use tree::Node;
use volume::VolumeRules;

/// Expected collisions of a photon from which paths are bounced.
const MANY_COLLISIONS: f64 = 8.0;

/// A validated scene. Nothing in it can be out of range.
#[derive(Debug)]
pub struct Scene {
    /// Where the image is taken from.
    pub camera: Camera,
    /// What fills it.
    pub medium: Medium,
    /// At least one, unless the medium has light of its own.
    pub lights: Vec<Light>,
    /// What each light is called, if the scene says so; may be shorter than `lights`.
    pub light_names: Vec<Option<String>>,
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
        let directory = path.parent().unwrap_or(Path::new(""));
        Self::of_tree(tree::read(path)?, path, directory, overrides)
    }

    /// A scene from the JSON text of a scene file. The files it names are relative to `directory`, and messages call it
    /// [`Scene::IN_MEMORY`].
    ///
    /// # Errors
    /// As [`Scene::load_with`].
    pub fn from_json_text(
        text: &str,
        directory: &Path,
        overrides: &Overrides,
    ) -> Result<Self, SceneError> {
        let name = Path::new(Self::IN_MEMORY);
        Self::of_tree(tree::read_json(text, name)?, name, directory, overrides)
    }

    /// What messages call a scene that is no file.
    pub const IN_MEMORY: &'static str = "the scene";

    /// Loads a scene from text, as though it were the content of the file at `path`, which need not exist: its extension tells TOML
    /// from JSON, files that the scene names are relative to its directory, and messages call the scene so.
    ///
    /// # Errors
    /// As [`Scene::load_with`].
    pub fn from_text(text: &str, path: &Path, overrides: &Overrides) -> Result<Self, SceneError> {
        let directory = path.parent().unwrap_or(Path::new(""));
        Self::of_tree(tree::parse(text, path)?, path, directory, overrides)
    }

    /// Loads the densities alone of medium number `number`, from 0: as they are rendered, in the tree of their file, with the
    /// transform to the scene's world. `None` of a homogeneous medium.
    ///
    /// # Errors
    /// As [`Scene::load_with`], and where there is no such medium.
    pub fn load_densities(
        path: &Path,
        overrides: &Overrides,
        number: usize,
    ) -> Result<Option<SparseGrid<f32>>, SceneError> {
        let (file, tree) = SceneFile::of_tree(tree::read(path)?, path, overrides)?;
        let directory = path.parent().unwrap_or(Path::new(""));
        let is_only = file.media.len() == 1;
        let key = if is_only { "medium".into() } else { format!("medium[{number}]") };
        let read = match file.media.get(number) {
            Some(section) => media::read_tree(section, key, directory, &overrides.volume_rules()),
            None => {
                let text = format!(
                    "there is no medium {number}; the scene has {}, from 0",
                    file.media.len()
                );
                Err(Problem::new("medium", text))
            }
        };
        read.map_err(|problem| problem.locate(path, &tree))
    }

    fn of_tree(
        tree: Node,
        path: &Path,
        directory: &Path,
        overrides: &Overrides,
    ) -> Result<Self, SceneError> {
        let (file, tree) = SceneFile::of_tree(tree, path, overrides)?;
        let scene = Self::build(&file, directory, &overrides.volume_rules())
            .map_err(|problem| problem.locate(path, &tree))?;
        let mut warnings = scene.warnings;
        if file::asks_for_lattice(&tree) && scene.medium.shared_phase().is_none() {
            let text = "render.gather: volumes with different phase functions have no lattice; \
                        light is gathered from the photon map";
            warnings.push(text.into());
        }
        let is_photon_count_given = file::has_key(&tree, "photons", "count");
        Ok(Self { is_photon_count_given, warnings, ..scene })
    }

    /// Whether all light and all scattering is the same in the three channels.
    pub fn is_grey(&self) -> bool {
        let grey = |color: Rgb| color.x == color.y && color.y == color.z;
        self.medium.is_grey() && self.lights.iter().all(|light| light.color().is_some_and(grey))
    }

    fn build(file: &SceneFile, directory: &Path, rules: &VolumeRules) -> Result<Self, Problem> {
        let mut notes = MediaNotes::default();
        let medium = media::read(&file.media, directory, rules, &mut notes)?;
        let lights = file.lights.iter().enumerate();
        let lights = lights
            .map(|(index, named)| build::light(&named.light, &format!("light[{index}]"), directory))
            .collect::<Result<_, _>>()?;
        let mut scene = Self {
            camera: file.camera.camera()?,
            lights,
            light_names: file.lights.iter().map(|named| named.name.clone()).collect(),
            photons: file.photons,
            estimate: file.estimate,
            render: file.render,
            hash: 0,
            medium,
            grids: notes.grids,
            is_photon_count_given: true,
            warnings: notes.warnings,
        };
        scene.render.gather = gather_for(&scene);
        let as_rendered = SceneFile { render: scene.render, ..file.clone() };
        scene.hash = hash::scene_hash(&as_rendered, directory, &notes.hashes)?;
        Ok(scene)
    }
}

/// How light is gathered in a scene: cells of a lattice hold light scattered by one phase function, and where volumes
/// differ in theirs photons are asked instead. Where light is scattered many times it falls off within a mean free path of the medium's faces, less
/// than a cell, and paths are bounced unless the scene says otherwise.
fn gather_for(scene: &Scene) -> Gather {
    match scene.render.gather {
        _ if scene.medium.shared_phase().is_none() => Gather::Knn,
        Gather::Auto if expected_collisions(scene) >= MANY_COLLISIONS => Gather::Bounce,
        Gather::Auto => Gather::Lattice,
        wanted => wanted,
    }
}
