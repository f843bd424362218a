//! The settings of a render, carried by its image so that the render can be repeated.

use std::fmt::Display;

use exr::meta::attribute::{AttributeValue, Text};

/// Names and values stored as text attributes of an EXR, such as `seed` or `scene_hash`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RenderMetadata {
    entries: Vec<(String, String)>,
}

impl RenderMetadata {
    /// What the names begin with in the file, so that they cannot meet the format's own.
    pub const PREFIX: &'static str = "photonvdb:";

    /// No entries.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds an entry; a later one of the same name takes its place. `name` is at most 200 bytes of
    /// lower-case words joined by underscores, without [`RenderMetadata::PREFIX`].
    pub fn set(&mut self, name: &str, value: impl Display) {
        self.entries.retain(|(existing, _)| existing != name);
        self.entries.push((name.to_string(), value.to_string()));
    }

    /// The value of `name`.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.entries.iter().find(|(existing, _)| existing == name).map(|(_, value)| value.as_str())
    }

    /// All names, without the prefix, and values.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().map(|(name, value)| (name.as_str(), value.as_str()))
    }

    /// The entries as EXR attributes.
    pub(super) fn attributes(&self) -> impl Iterator<Item = (Text, AttributeValue)> {
        self.iter().map(|(name, value)| {
            let name = utf8_text(&format!("{}{name}", Self::PREFIX));
            (name, AttributeValue::Text(utf8_text(value)))
        })
    }
}

/// EXR text in UTF-8, as the OpenEXR library stores it; `Text::from` would take only Latin-1.
pub(super) fn utf8_text(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}
