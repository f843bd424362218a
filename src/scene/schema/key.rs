//! A key of a scene file, as tables of keys declare it.

/// A key: what may stand there, and what it means.
#[derive(Clone, Copy)]
pub(super) struct Key {
    pub name: &'static str,
    pub kind: Kind,
    pub unit: &'static str,
    pub default: Default,
    /// Limits beyond those of the kind, in words.
    pub rule: &'static str,
    pub meaning: &'static str,
    /// Other keys of which one must be there, too.
    pub needs: &'static [&'static str],
}

/// What may stand at a key.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    /// One number.
    Number(Limits),
    /// A whole number from the first to the second.
    Integer(u64, u64),
    /// `true` or `false`.
    Boolean,
    /// Text; a name in some file.
    Text,
    /// A path, relative to the scene file.
    Path,
    /// One of these words.
    Word(&'static [&'static str]),
    /// So many numbers.
    Numbers(usize),
    /// One number for all channels or axes, or three.
    OneOrThree(Limits),
    /// Two whole numbers, each from the first to the second.
    Pair(u64, u64),
    /// The name of a preset.
    Preset,
    /// Another table.
    Table(&'static Section),
}

/// What holds where a file does not say.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Default {
    /// The file must say.
    Required,
    /// The file must say, unless it gives a key named here.
    Unless(&'static str),
    /// This value, written as JSON.
    Value(&'static str),
    /// Something that is no value, in words.
    Words(&'static str),
}

/// Where a number must lie.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    pub min: Option<f64>,
    pub max: Option<f64>,
    pub open_min: bool,
    pub open_max: bool,
}

/// Any number.
pub(super) const ANY: Limits = Limits { min: None, max: None, open_min: false, open_max: false };
/// 0 and above.
pub(super) const POSITIVE_OR_0: Limits = Limits { min: Some(0.0), ..ANY };
/// Above 0.
pub(super) const POSITIVE: Limits = Limits { min: Some(0.0), open_min: true, ..ANY };
/// 0 to 1.
pub(super) const SHARE: Limits = Limits { max: Some(1.0), ..POSITIVE_OR_0 };

/// A table of the scene file, in one of several variants.
pub(super) struct Section {
    /// Its path, as `medium.phase`.
    pub path: &'static str,
    pub about: &'static str,
    pub repeats: Repeats,
    pub variants: &'static [Variant],
}

/// Whether there may be several of a table.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Repeats {
    /// One: `[camera]`.
    Never,
    /// One, or a list: `[medium]` or `[[medium]]`.
    Allowed,
    /// A list: `[[light]]`.
    Always,
}

/// A set of keys that go together.
pub(super) struct Variant {
    /// What chooses it: `("kind", "point")`.
    pub chosen_by: Option<(&'static str, &'static str)>,
    /// Whether it is the one that holds where nothing is chosen.
    pub is_default: bool,
    pub about: &'static str,
    pub keys: &'static [Key],
    /// A word that may stand in the table's stead.
    pub word: Option<&'static str>,
}

/// A key that must be given; the methods change that.
pub(super) const fn key(name: &'static str, kind: Kind, meaning: &'static str) -> Key {
    Key { name, kind, unit: "", default: Default::Required, rule: "", meaning, needs: &[] }
}

impl Key {
    pub const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// With a default, written as JSON.
    pub const fn or(self, json: &'static str) -> Self {
        Self { default: Default::Value(json), ..self }
    }

    /// With a default that is no value.
    pub const fn or_else(self, words: &'static str) -> Self {
        Self { default: Default::Words(words), ..self }
    }

    /// Required unless another key is given.
    pub const fn unless(self, other: &'static str) -> Self {
        Self { default: Default::Unless(other), ..self }
    }

    pub const fn rule(self, rule: &'static str) -> Self {
        Self { rule, ..self }
    }

    pub const fn needs(self, needs: &'static [&'static str]) -> Self {
        Self { needs, ..self }
    }
}

/// The only variant of a section.
pub(super) const fn only(keys: &'static [Key]) -> Variant {
    Variant { chosen_by: None, is_default: false, about: "", keys, word: None }
}

/// A variant chosen by `kind`.
pub(super) const fn kind(word: &'static str, about: &'static str, keys: &'static [Key]) -> Variant {
    Variant { chosen_by: Some(("kind", word)), is_default: false, about, keys, word: None }
}
