//! The light lattice: scattered light in cells, from the lengths that photons fly in them.
//!
//! The fluence in a cell of volume V is the sum of power times length over the flights in it, over V (the track-length
//! estimator). It needs no collision: photons that only pass count as well, and cells of thin medium are as well known as those of
//! dense. With every flight weighted by the phase function towards the camera the cell holds in-scattered radiance per
//! sigma_s, one number a channel whatever the phase function; where light is wanted in other directions, cells hold fluence and
//! vector irradiance, which serve any direction to the first order of spherical harmonics. Between cells light is interpolated, after
//! [`Cells::sharpened`] has taken back what that flattens; what is left vanishes as cells shrink.
//!
//! Every task fills a lattice of its own, and they are added in order: results do not depend on the number of threads.

mod cells;
mod deposit;
mod lamps;
mod light;
mod shape;
mod walk;

pub use cells::Cells;
pub use deposit::{CameraDeposit, Deposit, DirectedDeposit};
pub use lamps::Lamps;
pub use light::{CellLight, CellSum, DirectedLight};
pub use shape::LatticeShape;

use glam::Vec3A;

use crate::math::{DVec3, Rgb};
use crate::medium::{ISOTROPIC, Phase};

/// Cells, and cells twice as long.
type Levels<L> = [Cells<L>; 2];

/// Light in cells.
#[derive(Debug)]
pub enum LightLattice {
    /// In-scattered radiance per sigma_s towards one camera, the same in all channels.
    Grey(Levels<f32>),
    /// Of three channels.
    Colored(Levels<Vec3A>),
    /// Fluence and its direction, from which that radiance follows in any direction: the same in all channels.
    DirectedGrey(Levels<DirectedLight<f32>>),
    /// Of three channels.
    DirectedColored(Levels<DirectedLight<Vec3A>>),
}

impl LightLattice {
    /// Where the cells lie.
    pub fn shape(&self) -> &LatticeShape {
        match self {
            Self::Grey([fine, _]) => &fine.shape,
            Self::Colored([fine, _]) => &fine.shape,
            Self::DirectedGrey([fine, _]) => &fine.shape,
            Self::DirectedColored([fine, _]) => &fine.shape,
        }
    }

    /// Radiance scattered at a place into a direction of travel, per sigma_s \[W/(m^2 sr)\]: the camera's, unless the light's own direction
    /// is known; then by the phase function.
    #[inline]
    pub fn scattered(&self, place: DVec3, towards: DVec3, phase: Phase) -> Rgb {
        self.at_level(0, place, towards, phase)
    }

    /// Fluence about a place \[W/m^2\], of a lattice whose cells look at all directions alike: where a lamp makes a peak, the mean over a ball of that radius.
    #[inline]
    pub fn fluence(&self, place: DVec3, ball_radius: f64) -> Rgb {
        let share = self.shape().lamps().map_or(1.0, |lamps| lamps.mean_share(place, ball_radius));
        self.at_level(0, place, DVec3::Z, Phase::Isotropic) * (share / ISOTROPIC)
    }

    /// [`LightLattice::scattered`] from the cells twice as long.
    pub fn coarse_scattered(&self, place: DVec3, towards: DVec3, phase: Phase) -> Rgb {
        self.at_level(1, place, towards, phase)
    }

    #[inline]
    fn at_level(&self, level: usize, place: DVec3, towards: DVec3, phase: Phase) -> Rgb {
        match self {
            Self::Grey(levels) => levels[level].at(place).rgb(),
            Self::Colored(levels) => levels[level].at(place).rgb(),
            Self::DirectedGrey(levels) => {
                levels[level].at(place).scattered(towards, phase.mean_cosine())
            }
            Self::DirectedColored(levels) => {
                levels[level].at(place).scattered(towards, phase.mean_cosine())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::Bounds;

    /// A light that varies linearly is read exactly up to the faces of a box, and within a ball from the cells that it fills.
    #[test]
    fn linear_light_is_read_exactly() {
        let slope = DVec3::new(0.3, -0.2, 0.5);
        let value = |place: DVec3| 2.0 + slope.dot(place);
        let boxed = Bounds::Box { min: DVec3::new(-1.0, 0.0, 0.5), max: DVec3::new(1.0, 1.0, 2.5) };
        let shape = LatticeShape::new(&boxed, 16).unwrap();
        assert_eq!(shape.counts(), [16, 8, 16]);
        let size = DVec3::new(2.0, 1.0, 2.0) / DVec3::new(16.0, 8.0, 16.0);
        assert!((shape.cell_volume() - size.element_product()).abs() < 1e-15);
        let middle = |index: usize| {
            let cell = [index % 16, index / 16 % 8, index / 128].map(|c| c as f64 + 0.5);
            DVec3::new(-1.0, 0.0, 0.5) + DVec3::from_array(cell) * size
        };
        let sums: Vec<f32> = (0..shape.cell_count())
            .map(|i| (value(middle(i)) * shape.cell_volume() * shape.power_scale()) as f32)
            .collect();
        // Two deposits of half the light each.
        let halves = vec![sums.iter().map(|s| 0.5 * s).collect::<Vec<f32>>(); 2];
        let cells = Cells::from_sums(&shape, halves);
        let lattice = LightLattice::Grey([cells.coarser(), cells]);
        for place in [
            DVec3::new(-1.0, 0.0, 0.5),
            DVec3::new(1.0, 1.0, 2.5),
            DVec3::new(0.01, 0.52, 1.7),
            DVec3::new(-0.99, 0.5, 2.49),
        ] {
            for found in [
                lattice.scattered(place, DVec3::X, Phase::Isotropic),
                lattice.coarse_scattered(place, DVec3::X, Phase::Isotropic),
            ] {
                assert!((found.x - value(place)).abs() < 1e-5, "{place}: {found}");
                assert_eq!(found.x, found.z);
            }
        }
    }

    /// Light that bends evenly is read exactly on average once it is sharpened, and too flat before.
    #[test]
    fn sharpening_takes_back_what_cells_flatten() {
        let bounds = Bounds::Box { min: DVec3::ZERO, max: DVec3::splat(16.0) };
        let shape = LatticeShape::new(&bounds, 16).unwrap();
        // 10 + x^2, whose mean over a cell is 1/12 more than in its middle.
        let mean = |index: usize| (10.0 + ((index % 16) as f64 + 0.5).powi(2) + 1.0 / 12.0) as f32;
        let sums: Vec<f32> = (0..shape.cell_count()).map(mean).collect();
        let error = |cells: &Cells<f32>| {
            let places = (0..1000).map(|i| 4.0 + 8.0 * (f64::from(i) + 0.5) / 1000.0);
            let errors =
                places.map(|x| f64::from(cells.at(DVec3::new(x, 5.3, 7.1))) - (10.0 + x * x));
            errors.sum::<f64>() / 1000.0
        };
        let cells = Cells::from_sums(&shape, vec![sums]);
        // h^2 / 8 times the second derivative, 2.
        assert!((error(&cells) - 0.25).abs() < 1e-4, "{}", error(&cells));
        let sharpened = cells.sharpened();
        assert!(error(&sharpened).abs() < 1e-4, "{}", error(&sharpened));
    }

    #[test]
    fn cells_at_the_edge_of_a_ball_count_by_what_it_fills() {
        let ball = Bounds::Sphere { center: DVec3::new(5.0, 0.0, 0.0), radius: 2.0 };
        let shape = LatticeShape::new(&ball, 12).unwrap();
        assert!(!shape.is_full());
        let share = |index: usize| shape.filled_share([index % 12, index / 12 % 12, index / 144]);
        let volume: f64 =
            (0..shape.cell_count()).map(|i| f64::from(share(i)) * shape.cell_volume()).sum();
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
        assert!((volume / exact - 1.0).abs() < 2e-3, "{volume} {exact}");
        let full = (shape.cell_volume() * shape.power_scale()) as f32;
        // An even fluence of 3 leaves power times length in proportion to what is filled.
        let sums: Vec<Vec3A> =
            (0..shape.cell_count()).map(|i| Vec3A::new(3.0, 1.0, 0.0) * share(i) * full).collect();
        let cells = Cells::from_sums(&shape, vec![sums]);
        let lattice = LightLattice::Colored([cells.coarser(), cells]);
        for direction in [DVec3::X, DVec3::NEG_Y, DVec3::ONE.normalize()] {
            for radius in [0.0, 1.0, 1.9, 1.999] {
                let place = DVec3::new(5.0, 0.0, 0.0) + direction * radius;
                for found in [
                    lattice.scattered(place, DVec3::X, Phase::Isotropic),
                    lattice.coarse_scattered(place, DVec3::X, Phase::Isotropic),
                ] {
                    let error = (found - Rgb::new(3.0, 1.0, 0.0)).abs().max_element();
                    assert!(error < 1e-4, "{place}: {found}");
                }
            }
        }
    }
}
