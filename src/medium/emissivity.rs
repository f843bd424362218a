//! Light of the medium's own: where it is hot or burns.
//!
//! The emissivity j \[W/(m^3 sr)\] is what a volume adds to the radiance of a ray, a metre of it:
//! j = `scale` (sigma_a B(T) + flame colour), with sigma_a = (1 - albedo) sigma_t.
//!
//! That heat glows as much as it absorbs is Kirchhoff's law: thick smoke of temperature T then has the radiance B(T) of
//! a blackbody, whatever its density, and no more. (Of other renderers, pbrt multiplies by sigma_a too; Cycles takes emission
//! to be independent of density, which no opaque body's is.) Flames are the other kind: gas that glows without being seen to
//! absorb, for which the grid's value times a colour is all there is.

use super::blackbody::{COLDEST, blackbody_radiance};
use super::emissive_cells::EmissiveCells;
use super::grid::ValueGrid;
use crate::math::{DVec3, Rgb};

/// How much light the places of a medium emit.
#[derive(Debug)]
pub struct Emissivity {
    scale: f64,
    temperature: Option<ValueGrid>,
    flame: Option<Flame>,
    has_heat: bool,
    has_flame: bool,
    voxel_size: f64,
    cells: Option<EmissiveCells>,
}

/// Light that does not come with absorption.
#[derive(Debug)]
pub struct Flame {
    /// By place.
    pub grid: ValueGrid,
    /// Emissivity where the grid is 1 \[W/(m^3 sr)\].
    pub color: Rgb,
}

impl Emissivity {
    /// Of blackbodies at the kelvins of a grid, of a flame, or both; `scale` multiplies all.
    pub fn new(temperature: Option<ValueGrid>, flame: Option<Flame>, scale: f64) -> Self {
        let (has_heat, has_flame) = (temperature.is_some(), flame.is_some());
        let grids = temperature.iter().chain(flame.as_ref().map(|flame| &flame.grid));
        let voxel_size = grids.map(ValueGrid::voxel_size).fold(f64::INFINITY, f64::min);
        Self { scale, temperature, flame, has_heat, has_flame, voxel_size, cells: None }
    }

    /// What is known of the light of several volumes together, which have their grids; `None` if none has light.
    pub(super) fn of_volumes<'a>(volumes: impl Iterator<Item = &'a Self>) -> Option<Self> {
        volumes.fold(None, |all: Option<Self>, volume| {
            let all = all.unwrap_or_else(|| Self::new(None, None, 1.0));
            Some(Self {
                has_heat: all.has_heat || volume.has_heat,
                has_flame: all.has_flame || volume.has_flame,
                voxel_size: all.voxel_size.min(volume.voxel_size),
                ..all
            })
        })
    }

    /// Of heat, per sigma_a \[W/(m^2 sr)\].
    #[inline]
    pub fn blackbody(&self, position: DVec3) -> Rgb {
        let Some(temperature) = &self.temperature else { return Rgb::ZERO };
        let kelvin = temperature.value(position);
        if kelvin < COLDEST { Rgb::ZERO } else { self.scale * blackbody_radiance(kelvin) }
    }

    /// Of flames \[W/(m^3 sr)\].
    #[inline]
    pub fn flame(&self, position: DVec3) -> Rgb {
        match &self.flame {
            Some(flame) => flame.color * (self.scale * flame.grid.value(position)),
            None => Rgb::ZERO,
        }
    }

    /// Whether heat glows here.
    pub fn has_heat(&self) -> bool {
        self.has_heat
    }

    /// Whether flames do.
    pub fn has_flame(&self) -> bool {
        self.has_flame
    }

    /// The edge of a voxel, the shortest of all grids' \[m\]: emissivity hardly varies within.
    pub fn voxel_size(&self) -> f64 {
        self.voxel_size
    }

    /// Where the light comes from; `None` if there is none.
    pub fn cells(&self) -> Option<&EmissiveCells> {
        self.cells.as_ref()
    }

    pub(super) fn set_cells(&mut self, cells: Option<EmissiveCells>) {
        self.cells = cells;
    }
}
