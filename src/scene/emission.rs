//! The light of a volume's own.

use super::error::Problem;
use super::file::{EmissionSection, FlameKeys, TemperatureKeys};
use super::grid_reader::GridReader;
use super::grid_use::GridRole;
use super::loaded_grids::GridForm;
use crate::medium::vdb::VolumeSource;
use crate::medium::{Emissivity, Flame, Medium, ValueGrid};

/// No camera would see what is colder glow \[K\].
const DARK_HEAT: f64 = 700.0;

/// The medium with the light that `section` gives it.
pub(super) fn read(
    section: &EmissionSection,
    medium: Medium,
    reader: &mut GridReader,
) -> Result<Medium, Problem> {
    let temperature = section.temperature.as_ref().map(|keys| read_temperature(keys, reader));
    let temperature = temperature.transpose()?;
    let flame = section.flame.as_ref().map(|keys| read_flame(keys, reader)).transpose()?;
    if flame.as_ref().is_some_and(|flame| reaches_out(flame, &medium)) {
        reader.warnings.push(format!(
            "{}.flame: the flames of {} reach beyond the density grid's bounds and are cut off there",
            reader.key,
            reader.source.name()
        ));
    }
    let hottest = temperature.as_ref().map(ValueGrid::max);
    let medium =
        medium.with_emissivity(Emissivity::new(temperature, flame, section.emission_scale));
    let glows = medium.emissivity.as_ref().is_some_and(|own| own.cells().is_some());
    let is_dark = !glows && section.emission_scale > 0.0;
    match hottest {
        Some(kelvin) if kelvin < DARK_HEAT => reader.warnings.push(format!(
            "{}.temperature: no place is hotter than {kelvin:.0} K, and none glows; \
             give temperature_scale (1 to 3 thousand for a grid of 0 to 1)",
            reader.key
        )),
        Some(_) if is_dark => reader.warnings.push(
            "the medium does not glow: where it is hot it absorbs nothing; lower its albedo, or \
             name a flame grid"
                .into(),
        ),
        None if is_dark => reader.warnings.push(format!(
            "{}.flame: nothing burns: the grid is 0 wherever the medium is, or flame_color is 0",
            reader.key
        )),
        _ => {}
    }
    Ok(medium)
}

fn read_temperature(keys: &TemperatureKeys, reader: &mut GridReader) -> Result<ValueGrid, Problem> {
    let (offset, scale) = (keys.temperature_offset, keys.temperature_scale);
    // What is below 0 K is cold, and no fault of the grid; what is no number is one.
    let kelvin = |value: f32| match (offset + scale * f64::from(value)) as f32 {
        cold if cold.is_finite() => cold.max(0.0),
        other => other,
    };
    reader.read_values(
        GridRole::Temperature,
        &keys.temperature,
        GridForm::Temperature { offset, scale },
        kelvin,
    )
}

fn read_flame(keys: &FlameKeys, reader: &mut GridReader) -> Result<Flame, Problem> {
    let grid = reader.read_values(GridRole::Flame, &keys.flame, GridForm::Flame, |value| value)?;
    Ok(Flame { grid, color: keys.flame_color })
}

fn reaches_out(flame: &Flame, medium: &Medium) -> bool {
    flame.grid.active_corners().into_iter().any(|corner| !medium.bounds.contains(corner))
}
