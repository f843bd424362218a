//! The scene file, section by section: which keys there are, their units, defaults and ranges.
//!
//! A file is TOML or JSON of the same structure. Angles are in degrees, lengths in metres, colours linear RGB.
//! An unknown key is an error.

mod bounds;
mod camera;
mod emission;
mod estimate;
mod light;
mod medium;
mod phase;
mod photons;
mod render;
mod table;
mod transform;

pub use bounds::BoundsSection;
pub use camera::CameraSection;
pub use emission::{EmissionSection, FlameKeys, TemperatureKeys};
pub use estimate::EstimateSettings;
pub use light::{LightSection, NamedLight};
pub use medium::MediumSection;
pub use phase::PhaseSection;
pub use photons::PhotonSettings;
pub(super) use photons::emission_word;
pub use render::{Background, RenderSettings};
pub use transform::TransformSection;

use std::path::Path;

use serde::{Serialize, Serializer};

use super::error::{Problem, SceneError};
use super::overrides::Overrides;
use super::preset;
use super::tree::{self, Node};
use table::Table;

/// What a scene file says, every key checked and every default filled in, but no other file opened.
///
/// | section | default | meaning |
/// |---|---|---|
/// | `[camera]` | required | where the image is taken from: [`CameraSection`] |
/// | `[medium]` | required | what fills the scene: [`MediumSection`]; `[[medium]]`, more than once, for several volumes |
/// | `[[light]]` | at least one, unless the medium glows | what lights it: [`NamedLight`] |
/// | `[photons]` | all defaults | how photons are emitted and followed: [`PhotonSettings`] |
/// | `[estimate]` | all defaults | how the photon map is read: [`EstimateSettings`] |
/// | `[render]` | all defaults | how pixels are sampled: [`RenderSettings`] |
///
/// Serialized, it is a scene file again.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct SceneFile {
    pub camera: CameraSection,
    #[serde(rename = "medium", serialize_with = "serialize_media")]
    pub media: Vec<MediumSection>,
    #[serde(rename = "light")]
    pub lights: Vec<NamedLight>,
    pub photons: PhotonSettings,
    pub estimate: EstimateSettings,
    pub render: RenderSettings,
}

impl SceneFile {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// The first thing wrong in the scene file itself; files it names are not looked at.
    pub fn load(path: &Path, overrides: &Overrides) -> Result<Self, SceneError> {
        Self::load_tree(path, overrides).map(|(file, _)| file)
    }

    /// The file, and the tree it was read from, which knows the lines of later errors.
    pub(super) fn load_tree(
        path: &Path,
        overrides: &Overrides,
    ) -> Result<(Self, Node), SceneError> {
        Self::of_tree(tree::read(path)?, path, overrides)
    }

    /// The same of text, as though it were the file at `path`.
    pub(super) fn parse_tree(
        text: &str,
        path: &Path,
        overrides: &Overrides,
    ) -> Result<(Self, Node), SceneError> {
        Self::of_tree(tree::parse(text, path)?, path, overrides)
    }

    fn of_tree(
        mut tree: Node,
        path: &Path,
        overrides: &Overrides,
    ) -> Result<(Self, Node), SceneError> {
        overrides.apply(&mut tree);
        match preset::apply(&mut tree).and_then(|()| Self::read(&tree)) {
            Ok(file) => Ok((file, tree)),
            Err(problem) => Err(problem.locate(path, &tree)),
        }
    }

    fn read(tree: &Node) -> Result<Self, Problem> {
        let root = Table::root(tree)?;
        root.allow(&["camera", "medium", "light", "photons", "estimate", "render"])?;
        let lights = root.sections("light")?;
        let asks_for_k = EstimateSettings::KEYS.iter().any(|key| has_key(tree, "estimate", key));
        let file = Self {
            camera: CameraSection::read(&root.section("camera")?)?,
            media: MediumSection::read_all(&root)?,
            lights: lights.iter().map(NamedLight::read).collect::<Result<_, _>>()?,
            photons: PhotonSettings::read(&root.section("photons")?)?,
            estimate: EstimateSettings::read(&root.section("estimate")?)?,
            render: RenderSettings::read(&root.section("render")?, asks_for_k)?,
        };
        let is_lit = !file.lights.is_empty() || file.media.iter().any(MediumSection::emits);
        root.ensure("light", is_lit, "the scene has no light; add a [[light]]")?;
        Ok(file)
    }
}

/// One medium is a table, several are a list of them.
fn serialize_media<S: Serializer>(
    media: &[MediumSection],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match media {
        [only] => only.serialize(serializer),
        _ => media.serialize(serializer),
    }
}

/// Whether the file, or what replaces its values, asks for a lattice.
pub(super) fn asks_for_lattice(tree: &Node) -> bool {
    let render = Table::root(tree).and_then(|root| root.section("render"));
    let gather = render.and_then(|render| render.get::<String>("gather"));
    matches!(gather, Ok(Some(word)) if word == "lattice")
}

/// Whether the file, or what replaces its values, says something at `section.key`.
pub(super) fn has_key(tree: &Node, section: &str, key: &str) -> bool {
    let section = Table::root(tree).and_then(|root| root.section(section));
    section.is_ok_and(|section| section.has(key))
}
