//! The grids by which a volume glows.

use super::error::Problem;
use super::file::{EmissionSection, FlameKeys, TemperatureKeys};
use super::grid_use::{GridRole, GridUse};
use crate::math::DAffine3;
use crate::medium::vdb::{
    Limits, SparseGrid, VdbFile, VolumeSource, find_scalar, sanitize_density,
};
use crate::medium::{Emissivity, Flame, Medium, ValueGrid};

/// Where the grids come from, and what is to be said of them.
pub(super) struct EmissionReader<'a> {
    pub source: &'a VdbFile,
    /// From the file's world to the scene's.
    pub transform: DAffine3,
    pub warnings: &'a mut Vec<String>,
    pub grids: &'a mut Vec<GridUse>,
}

/// No blackbody below glows so that a camera would see it \[K\].
const DARK_HEAT: f64 = 700.0;

impl EmissionReader<'_> {
    /// The medium with the light that `section` gives it.
    pub fn read(mut self, section: &EmissionSection, medium: Medium) -> Result<Medium, Problem> {
        let temperature = match &section.temperature {
            Some(keys) => Some(self.read_temperature(keys)?),
            None => None,
        };
        let flame = match &section.flame {
            Some(keys) => Some(self.read_flame(keys)?),
            None => None,
        };
        let reaches_out = |flame: &Flame| {
            flame.grid.active_corners().into_iter().any(|corner| !medium.bounds.contains(corner))
        };
        if flame.as_ref().is_some_and(reaches_out) {
            self.warnings.push(format!(
                "medium.flame: the flames of {} reach beyond the density grid's bounds and are cut off there",
                self.source.name()
            ));
        }
        let hottest = temperature.as_ref().map(ValueGrid::max);
        let emissivity = Emissivity::new(temperature, flame, section.emission_scale);
        let medium = medium.with_emissivity(emissivity);
        let glows = medium.emissivity.as_ref().is_some_and(|own| own.cells().is_some());
        match hottest {
            Some(kelvin) if kelvin < DARK_HEAT => self.warnings.push(format!(
                "medium.temperature: no place is hotter than {kelvin:.0} K, and none glows; \
                 give temperature_scale (1 to 3 thousand for a grid of 0 to 1)"
            )),
            None if !glows && section.emission_scale > 0.0 => self.warnings.push(
                "medium.flame: nothing burns: the grid is 0 wherever the medium is, or flame_color is 0"
                    .into(),
            ),
            Some(_) if !glows && section.emission_scale > 0.0 => self.warnings.push(
                "the medium does not glow: where it is hot it absorbs nothing; lower its albedo, or \
                 name a flame grid"
                    .into(),
            ),
            _ => {}
        }
        Ok(medium)
    }

    fn read_temperature(&mut self, keys: &TemperatureKeys) -> Result<ValueGrid, Problem> {
        let (offset, scale) = (keys.temperature_offset, keys.temperature_scale);
        // What is below 0 K is cold, and no fault of the grid; what is no number is one.
        let kelvin = |value: f32| match (offset + scale * f64::from(value)) as f32 {
            cold if cold.is_finite() => cold.max(0.0),
            other => other,
        };
        let sparse = self.load("temperature", &keys.temperature)?;
        self.place(GridRole::Temperature, &keys.temperature, sparse.map(kelvin))
    }

    fn read_flame(&mut self, keys: &FlameKeys) -> Result<Flame, Problem> {
        let sparse = self.load("flame", &keys.flame)?;
        let grid = self.place(GridRole::Flame, &keys.flame, sparse)?;
        Ok(Flame { grid, color: keys.flame_color })
    }

    fn load(&self, key: &str, name: &str) -> Result<SparseGrid<f32>, Problem> {
        find_scalar(self.source, name)
            .and_then(|index| self.source.load_scalar(index, &Limits::default()))
            .map_err(|error| Problem::new(format!("medium.{key}"), error.to_string()))
    }

    fn place(
        &mut self,
        role: GridRole,
        name: &str,
        mut sparse: SparseGrid<f32>,
    ) -> Result<ValueGrid, Problem> {
        let shown = format!("grid {name:?} of {}", self.source.name());
        let mended = sanitize_density(&mut sparse);
        if mended.total() > 0 {
            self.warnings.push(format!(
                "{shown}: {} values are no {} and count as 0 ({} NaN, {} infinite, {} negative)",
                mended.total(),
                if role == GridRole::Flame { "flames" } else { "temperatures" },
                mended.nan,
                mended.infinite,
                mended.negative,
            ));
        }
        let grid = ValueGrid::new(&sparse, self.transform * sparse.index_to_world);
        let grid = grid.ok_or_else(|| {
            let text = format!("{shown} is empty: it has no active voxel");
            Problem::new(format!("medium.{}", role.name()), text)
        })?;
        let memory_bytes = grid.bytes() as u64;
        self.grids.push(GridUse { role, name: name.to_owned(), memory_bytes });
        Ok(grid)
    }
}
