//! What a cell adds up: one number where all light is grey, else one a channel; and, where it is wanted for all directions, how much
//! of it flies which way.

use std::ops::{Add, AddAssign, Mul, Sub};

use glam::Vec3A;

use crate::math::{DVec3, Rgb};

/// What cells hold: sums, and blends of them.
pub trait CellSum:
    Copy
    + Default
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<f32, Output = Self>
    + AddAssign
{
}

/// Light, grey or of three channels.
pub trait CellLight: CellSum {
    /// Of three channels; grey light takes the first, which is as good as any.
    fn from_rgb(light: Rgb) -> Self;

    /// Three channels.
    fn rgb(self) -> Rgb;
}

impl CellSum for f32 {}

impl CellLight for f32 {
    #[inline]
    fn from_rgb(light: Rgb) -> Self {
        light.x as f32
    }

    #[inline]
    fn rgb(self) -> Rgb {
        Rgb::splat(f64::from(self))
    }
}

impl CellSum for Vec3A {}

impl CellLight for Vec3A {
    #[inline]
    fn from_rgb(light: Rgb) -> Self {
        light.as_vec3a()
    }

    #[inline]
    fn rgb(self) -> Rgb {
        self.as_dvec3()
    }
}

/// Light with its direction, to the first order of spherical harmonics.
#[derive(Clone, Copy, Debug, Default)]
pub struct DirectedLight<L> {
    /// Fluence \[W/m^2\].
    fluence: L,
    /// Vector irradiance \[W/m^2\]: fluence times the mean direction of travel.
    flux: [L; 3],
}

impl<L: CellLight> DirectedLight<L> {
    /// Light that travels in one direction.
    #[inline]
    pub fn along(direction: DVec3, light: L) -> Self {
        let [x, y, z] = direction.to_array().map(|component| light * component as f32);
        Self { fluence: light, flux: [x, y, z] }
    }

    /// Radiance that a phase function of that mean cosine scatters into a direction of travel, per sigma_s: its first two Legendre
    /// moments, (fluence + 3 g flux . direction) / (4 pi).
    #[inline]
    pub fn scattered(&self, towards: DVec3, mean_cosine: f64) -> Rgb {
        let [x, y, z] = self.flux.map(CellLight::rgb);
        let along = x * towards.x + y * towards.y + z * towards.z;
        (self.fluence.rgb() + along * (3.0 * mean_cosine)) * crate::medium::ISOTROPIC
    }
}

impl<L: CellLight> CellSum for DirectedLight<L> {}

impl<L: CellLight> DirectedLight<L> {
    fn zip(self, other: Self, with: impl Fn(L, L) -> L) -> Self {
        let flux = std::array::from_fn(|axis| with(self.flux[axis], other.flux[axis]));
        Self { fluence: with(self.fluence, other.fluence), flux }
    }
}

impl<L: CellLight> Add for DirectedLight<L> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<L: CellLight> Sub for DirectedLight<L> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<L: CellLight> Mul<f32> for DirectedLight<L> {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f32) -> Self {
        Self { fluence: self.fluence * factor, flux: self.flux.map(|light| light * factor) }
    }
}

impl<L: CellLight> AddAssign for DirectedLight<L> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
