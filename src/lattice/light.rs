//! What a cell adds up: one number where all light is grey, else one a channel.

use std::ops::{Add, AddAssign, Mul, Sub};

use glam::Vec3A;

use crate::math::Rgb;

/// Light, grey or of three channels.
pub trait CellLight:
    Copy
    + Default
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<f32, Output = Self>
    + AddAssign
{
    /// Of three channels; grey light takes the first, which is as good as any.
    fn from_rgb(light: Rgb) -> Self;

    /// Three channels.
    fn rgb(self) -> Rgb;
}

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
