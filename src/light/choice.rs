//! Which of a scene's light is looked at.

/// All light of a scene, or that of one source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightChoice {
    /// Of all lights and of the medium.
    #[default]
    All,
    /// Of one of the scene's lights, by its index.
    Light(usize),
    /// The medium's own.
    Medium,
}

impl LightChoice {
    /// Whether light number `index` belongs to it.
    pub fn has_light(self, index: usize) -> bool {
        self == Self::All || self == Self::Light(index)
    }

    /// Whether the medium's own light belongs to it.
    pub fn has_medium(self) -> bool {
        self == Self::All || self == Self::Medium
    }
}
