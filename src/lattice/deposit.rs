//! Photons' flights into a lattice: weighted for one camera, or with their direction for any; near lamps by their distance.

use crate::lattice::walk::walk_cells;
use crate::lattice::{CellLight, CellSum, DirectedLight, LatticeShape};
use crate::math::{DVec3, Ray, Rgb, Span};
use crate::medium::{Extinction, Phase};
use crate::trace::Keep;

/// What takes flights into a lattice.
pub trait Deposit: Keep {
    /// What a cell holds.
    type Cell: CellSum;

    /// What was added to each cell, x fastest, its power scaled by [`LatticeShape::power_scale`].
    fn into_sums(self) -> Vec<Self::Cell>;
}

/// Takes flights for one camera: adds power times length, weighted by how much of it would scatter towards the camera, to the cells crossed.
pub struct CameraDeposit<'a, E, L> {
    shape: &'a LatticeShape,
    extinction: &'a E,
    phase: Phase,
    /// Where light is wanted \[m\].
    camera: DVec3,
    /// Scaled power times length a cell \[W/m^2\], times the phase function \[1/sr\].
    sums: Vec<L>,
}

impl<'a, E: Extinction, L: CellLight> CameraDeposit<'a, E, L> {
    /// An empty lattice.
    pub fn new(shape: &'a LatticeShape, extinction: &'a E, phase: Phase, camera: DVec3) -> Self {
        let sums = vec![L::default(); shape.cell_count()];
        Self { shape, extinction, phase, camera, sums }
    }
}

impl<E: Extinction, L: CellLight> Deposit for CameraDeposit<'_, E, L> {
    type Cell = L;

    fn into_sums(self) -> Vec<L> {
        self.sums
    }
}

impl<E: Extinction, L: CellLight> Keep for CameraDeposit<'_, E, L> {
    const FLIGHTS: bool = true;

    fn flight(&mut self, ray: &Ray, flight: Span, power: Rgb, _order: u32) {
        let Self { shape, extinction, phase, camera, sums } = self;
        let power = power * shape.power_scale();
        if phase.is_isotropic() && !E::IS_CHROMATIC {
            let light = L::from_rgb(power * phase.density(1.0));
            walk_cells(shape, ray, flight, |cell, enters, leaves| {
                sums[cell] += light * weighted_length(shape, ray, enters, leaves) as f32;
            });
            return;
        }
        let light = L::from_rgb(power);
        // |camera - at(t)|^2 = along^2 + across^2, along the way left to the point nearest to the camera.
        let to_camera = *camera - ray.origin;
        let nearest = to_camera.dot(ray.direction);
        let across = (to_camera - ray.direction * nearest).length_squared();
        walk_cells(shape, ray, flight, |cell, enters, leaves| {
            let middle = 0.5 * (enters + leaves);
            let along = nearest - middle;
            let distance = (along * along + across).sqrt().max(f64::MIN_POSITIVE);
            let length = weighted_length(shape, ray, enters, leaves);
            let weight = phase.density(along / distance) * length;
            sums[cell] += if E::IS_CHROMATIC {
                let colour = extinction.flying_weight(middle - flight.start, power);
                L::from_rgb(power * colour * weight)
            } else {
                light * weight as f32
            };
        });
    }

    fn collision(&mut self, _: &Ray, _: Rgb, _: u32) {}
}

/// The length of a piece of a flight in one cell, times the weight of lamps.
#[inline]
fn weighted_length(shape: &LatticeShape, ray: &Ray, enters: f64, leaves: f64) -> f64 {
    let length = leaves - enters;
    shape.lamps().map_or(length, |lamps| length * lamps.mean_weight(ray, enters, leaves))
}

/// Takes flights for any direction: adds power times length, and its direction, to the cells crossed.
pub struct DirectedDeposit<'a, E, L> {
    shape: &'a LatticeShape,
    extinction: &'a E,
    /// Scaled power times length a cell \[W/m^2\].
    sums: Vec<DirectedLight<L>>,
}

impl<'a, E: Extinction, L: CellLight> DirectedDeposit<'a, E, L> {
    /// An empty lattice.
    pub fn new(shape: &'a LatticeShape, extinction: &'a E) -> Self {
        let sums = vec![DirectedLight::default(); shape.cell_count()];
        Self { shape, extinction, sums }
    }
}

impl<E: Extinction, L: CellLight> Deposit for DirectedDeposit<'_, E, L> {
    type Cell = DirectedLight<L>;

    fn into_sums(self) -> Vec<DirectedLight<L>> {
        self.sums
    }
}

impl<E: Extinction, L: CellLight> Keep for DirectedDeposit<'_, E, L> {
    const FLIGHTS: bool = true;

    fn flight(&mut self, ray: &Ray, flight: Span, power: Rgb, _order: u32) {
        let Self { shape, extinction, sums } = self;
        let power = power * shape.power_scale();
        let light = DirectedLight::along(ray.direction, L::from_rgb(power));
        walk_cells(shape, ray, flight, |cell, enters, leaves| {
            let length = weighted_length(shape, ray, enters, leaves) as f32;
            sums[cell] += if E::IS_CHROMATIC {
                let middle = 0.5 * (enters + leaves);
                let colour = extinction.flying_weight(middle - flight.start, power);
                DirectedLight::along(ray.direction, L::from_rgb(power * colour)) * length
            } else {
                light * length
            };
        });
    }

    fn collision(&mut self, _: &Ray, _: Rgb, _: u32) {}
}
