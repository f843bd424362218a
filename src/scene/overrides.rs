//! Values given outside the scene file, usually on the command line.

use super::tree::{Node, Origin, Value};
use super::volume::VolumeRules;
use crate::medium::vdb::Limits;

/// Values that replace those of the scene file before it is checked: they meet the same limits and errors.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Overrides {
    /// `photons.count`
    pub photons: Option<u64>,
    /// `photons.emission`, as the file spells it.
    pub emission: Option<String>,
    /// `photons.seed`
    pub seed: Option<u64>,
    /// `estimate.k`
    pub k: Option<u64>,
    /// `estimate.divisor`, as the file spells it.
    pub divisor: Option<String>,
    /// `camera.resolution`: width, height \[pixels\].
    pub resolution: Option<[u64; 2]>,
    /// `render.gather`, as the file spells it.
    pub gather: Option<String>,
    /// `render.lattice`
    pub lattice: Option<u64>,
    /// `render.filter`, as the file spells it.
    pub filter: Option<String>,
    /// `render.bounces`
    pub bounces: Option<u64>,
    /// `render.samples_per_pixel`
    pub samples_per_pixel: Option<u64>,
    /// `render.photons_only`
    pub photons_only: Option<bool>,
    /// `render.background`, as the file spells it.
    pub background: Option<String>,
    /// `medium.sdf_to_fog`, of every volume from a file.
    pub sdf_to_fog: Option<bool>,
    /// Memory that reading a volume may take \[bytes\], instead of the default of [`Limits`]; not a value of the file.
    pub max_volume_memory: Option<u64>,
    /// Whether values that cannot be densities are an error instead of a warning; not a value of the file.
    pub strict: bool,
}

impl Overrides {
    /// What reading volumes may cost and must find.
    pub(super) fn volume_rules(&self) -> VolumeRules {
        let default = Limits::default();
        let max_bytes = self.max_volume_memory.unwrap_or(default.max_bytes);
        VolumeRules { limits: Limits { max_bytes }, strict: self.strict }
    }

    pub(super) fn apply(&self, tree: &mut Node) {
        let integer = |value: u64| Value::Integer(value.into());
        let mut set = |section: &str, key: &str, value: Option<Value>| {
            if let Some(value) = value {
                tree.set(section, key, value);
            }
        };
        set("photons", "count", self.photons.map(integer));
        set("photons", "emission", self.emission.clone().map(Value::Text));
        set("photons", "seed", self.seed.map(integer));
        set("estimate", "k", self.k.map(integer));
        set("estimate", "divisor", self.divisor.clone().map(Value::Text));
        set("render", "gather", self.gather.clone().map(Value::Text));
        set("render", "lattice", self.lattice.map(integer));
        set("render", "bounces", self.bounces.map(integer));
        set("render", "filter", self.filter.clone().map(Value::Text));
        set("render", "samples_per_pixel", self.samples_per_pixel.map(integer));
        set("render", "photons_only", self.photons_only.map(Value::Boolean));
        set("render", "background", self.background.clone().map(Value::Text));
        let resolution = self.resolution.map(|sides| {
            let item = |side| Node { origin: Origin::Override, value: integer(side) };
            Value::List(sides.map(item).into())
        });
        set("camera", "resolution", resolution);
        if let Some(sdf_to_fog) = self.sdf_to_fog {
            let is_volume = |medium: &Node| medium.text("kind") == Some("vdb");
            tree.set_in_each("medium", "sdf_to_fog", Value::Boolean(sdf_to_fog), is_volume);
        }
    }
}
