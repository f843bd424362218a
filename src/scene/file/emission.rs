//! Keys of `[medium]` that make it glow.

use serde::Serialize;

use super::table::{OneOrThree, Table};
use crate::math::Rgb;
use crate::scene::error::Problem;

/// Light of a volume's own, from one or both of two grids. The emissivity is
/// j = `emission_scale` (sigma_a B(kelvin) + `flame_color` flame) \[W/(m^3 sr)\].
///
/// | key | type | unit | default | range | meaning |
/// |---|---|---|---|---|---|
/// | `temperature` | text | | none | | name of a grid of numbers: heat glows as a blackbody |
/// | `temperature_scale` | number | K per grid value | 1 | at least 0 | kelvin = `temperature_offset` + `temperature_scale` value, at least 0 |
/// | `temperature_offset` | number | K | 0 | | 273.15 for grids in degrees Celsius |
/// | `flame` | text | | none | | name of a grid of numbers: flames glow whether or not they absorb |
/// | `flame_color` | number or RGB | W/(m^3 sr) per grid value | \[1, 0.23, 0\] | at least 0 | emissivity of value 1; the default has the colour of 1900 K |
/// | `emission_scale` | number | | 1 | at least 0 | factor on both |
///
/// B is the radiance of a blackbody \[W/(m^2 sr)\], each watt counted by the eye's response, in linear Rec.709 (683 cd/m^2 are
/// 1): 0.018 in red at 1000 K, 37 at 1500 K, 1700 at 2000 K, 78 000 at 3000 K. It rises steeply, so an
/// `emission_scale` well below 1 stands in for a camera's exposure beside lights of everyday numbers.
///
/// Heat glows as much as it absorbs: sigma_a = (1 - albedo) sigma_t. With an albedo of 1, or where the density is 0, it does not
/// glow at all, and thick smoke is no brighter than B. What lies outside of the density's bounds is cut off.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EmissionSection {
    /// Heat.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<TemperatureKeys>,
    /// Flames.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub flame: Option<FlameKeys>,
    /// Factor on both.
    pub emission_scale: f64,
}

/// A grid of temperatures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TemperatureKeys {
    /// Its name.
    pub temperature: String,
    /// \[K\]
    pub temperature_offset: f64,
    /// \[K\] per grid value.
    pub temperature_scale: f64,
}

/// A grid of flames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FlameKeys {
    /// Its name.
    pub flame: String,
    /// \[W/(m^3 sr)\] per grid value.
    pub flame_color: Rgb,
}

/// The Rec.709 colour of a blackbody at 1900 K, its red 1: blue is out of gamut there.
const FLAME_COLOR: Rgb = Rgb::new(1.0, 0.23, 0.0);

/// Keys that need another one.
const NEEDS: [(&str, &str); 3] = [
    ("temperature_scale", "temperature"),
    ("temperature_offset", "temperature"),
    ("flame_color", "flame"),
];

impl EmissionSection {
    /// The keys of this section.
    pub(super) const KEYS: [&str; 6] = [
        "temperature",
        "temperature_scale",
        "temperature_offset",
        "flame",
        "flame_color",
        "emission_scale",
    ];

    /// Reads them from `[medium]`; none if it names neither grid.
    pub(super) fn read(medium: &Table) -> Result<Option<Self>, Problem> {
        if let Some((key, grid)) =
            NEEDS.into_iter().find(|(key, grid)| medium.has(key) && !medium.has(grid))
        {
            return Err(medium.problem(key, format!("needs {grid}, the name of a grid")));
        }
        let temperature = Self::read_temperature(medium)?;
        let flame = Self::read_flame(medium)?;
        if temperature.is_none() && flame.is_none() {
            if medium.has("emission_scale") {
                let text = "needs temperature or flame, the name of a grid that glows";
                return Err(medium.problem("emission_scale", text));
            }
            return Ok(None);
        }
        let emission_scale = medium.get_or("emission_scale", 1.0)?;
        medium.ensure("emission_scale", emission_scale >= 0.0, "must not be below 0")?;
        Ok(Some(Self { temperature, flame, emission_scale }))
    }

    fn read_temperature(medium: &Table) -> Result<Option<TemperatureKeys>, Problem> {
        let Some(temperature) = medium.get("temperature")? else { return Ok(None) };
        let temperature_scale = medium.get_or("temperature_scale", 1.0)?;
        medium.ensure("temperature_scale", temperature_scale >= 0.0, "must not be below 0")?;
        let temperature_offset = medium.get_or("temperature_offset", 0.0)?;
        Ok(Some(TemperatureKeys { temperature, temperature_offset, temperature_scale }))
    }

    fn read_flame(medium: &Table) -> Result<Option<FlameKeys>, Problem> {
        let Some(flame) = medium.get("flame")? else { return Ok(None) };
        let flame_color = medium.get_or("flame_color", OneOrThree(FLAME_COLOR))?.0;
        medium.ensure("flame_color", flame_color.min_element() >= 0.0, "must not be below 0")?;
        Ok(Some(FlameKeys { flame, flame_color }))
    }
}
