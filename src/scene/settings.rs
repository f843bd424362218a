//! The settings of a scene as names and values, for an image's metadata and for whoever compares two scenes.

use serde::Serialize;
use serde_json::Value;

use super::Scene;

impl Scene {
    /// The image's size and all of `[photons]`, `[estimate]` and `[render]`, defaults and overrides included: each value under
    /// the name that it has in a scene file, like `photons.seed`.
    pub fn settings(&self) -> Vec<(String, String)> {
        let resolution = format!("{}x{}", self.camera.width, self.camera.height);
        let mut settings = vec![("camera.resolution".to_string(), resolution)];
        push_section(&mut settings, "photons", &self.photons);
        push_section(&mut settings, "estimate", &self.estimate);
        push_section(&mut settings, "render", &self.render);
        settings
    }
}

fn push_section(settings: &mut Vec<(String, String)>, section: &str, values: &impl Serialize) {
    let Ok(Value::Object(values)) = serde_json::to_value(values) else { return };
    settings.extend(values.into_iter().map(|(key, value)| {
        let text = value.as_str().map_or_else(|| value.to_string(), str::to_string);
        (format!("{section}.{key}"), text)
    }));
}
