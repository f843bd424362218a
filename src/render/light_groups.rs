//! The light that each layer of lights holds.

use crate::film::Film;
use crate::light::LightChoice;
use crate::render::RenderOptions;
use crate::scene::Scene;

/// What the medium's own light is called among the lights.
const MEDIUM_NAME: &str = "medium";

/// The parts that a pass is rendered in, and the layers that they go to.
#[derive(Clone, Debug)]
pub struct LightGroups {
    /// Names of the layers.
    pub names: Vec<String>,
    /// Each part's light, and its layer.
    pub parts: Vec<(LightChoice, Option<usize>)>,
}

impl LightGroups {
    /// All light at once, or, if layers of lights are asked for, light by light. Lights of one name share a layer.
    pub fn of(scene: &Scene, options: &RenderOptions) -> Self {
        let mut groups = Self { names: Vec::new(), parts: Vec::new() };
        let is_lit = !scene.lights.is_empty() || scene.medium.emissivity.is_some();
        if !options.layers.lights || !is_lit {
            groups.parts.push((LightChoice::All, None));
            return groups;
        }
        for index in 0..scene.lights.len() {
            let name = scene.light_names.get(index).cloned().flatten();
            let name = name.unwrap_or_else(|| index.to_string());
            groups.push(LightChoice::Light(index), name);
        }
        if scene.medium.emissivity.is_some() {
            groups.push(LightChoice::Medium, MEDIUM_NAME.to_string());
        }
        groups
    }

    fn push(&mut self, choice: LightChoice, name: String) {
        let layer = self.names.iter().position(|other| *other == name).unwrap_or_else(|| {
            self.names.push(name);
            self.names.len() - 1
        });
        self.parts.push((choice, Some(layer)));
    }
}

/// A film for what the options ask for.
pub fn empty_film(scene: &Scene, options: &RenderOptions) -> Film {
    let film = Film::new(scene.camera.width, scene.camera.height);
    let film = film.with_lights(&LightGroups::of(scene, options).names);
    if options.layers.depths { film.with_depths() } else { film }
}
