//! A grid of colours: one [`ValueGrid`] a channel, all of the same topology.

use super::{DensityGridError, ValueGrid};
use crate::{
    math::{DAffine3, DVec3, Rgb},
    medium::vdb::{Limits, SanitizeCount, SparseGrid, sanitize_density},
};

/// Linear RGB by place, no channel below 0.
#[derive(Clone, Debug)]
pub struct ColorGrid {
    channels: [ValueGrid; 3],
}

impl ColorGrid {
    /// Places a grid of vectors; `index_to_world` is the file's transform followed by the scene's. Components that are not
    /// finite or below 0 count as 0; how many is returned. `None` if no voxel is active, or the transform has
    /// no inverse.
    ///
    /// # Errors
    /// As [`DensityGrid::build`](super::DensityGrid::build).
    pub fn new(
        sparse: &SparseGrid<[f32; 3]>,
        index_to_world: DAffine3,
        limits: &Limits,
    ) -> Result<Option<(Self, SanitizeCount)>, DensityGridError> {
        let mut mended = SanitizeCount::default();
        let mut channel = |axis: usize| {
            let mut component = sparse.map(|value| value[axis]);
            mended = mended.sum(sanitize_density(&mut component));
            ValueGrid::new(&component, index_to_world, limits)
        };
        let (Some(red), Some(green), Some(blue)) = (channel(0)?, channel(1)?, channel(2)?) else {
            return Ok(None);
        };
        Ok(Some((Self { channels: [red, green, blue] }, mended)))
    }

    /// The same colours at another place, in the same memory; `None` if the transform has no inverse.
    pub fn moved(&self, index_to_world: DAffine3) -> Option<Self> {
        let [red, green, blue] = &self.channels;
        let moved = |channel: &ValueGrid| channel.moved(index_to_world);
        Some(Self { channels: [moved(red)?, moved(green)?, moved(blue)?] })
    }

    /// The colour at a place in world space.
    #[inline]
    pub fn color(&self, position: DVec3) -> Rgb {
        let point = self.channels[0].local_point(position);
        Rgb::from_array(std::array::from_fn(|axis| self.channels[axis].local_value(point)))
    }

    /// The largest value of each channel.
    pub fn max(&self) -> Rgb {
        Rgb::from_array(std::array::from_fn(|axis| self.channels[axis].max()))
    }

    /// Memory held \[bytes\].
    pub fn bytes(&self) -> usize {
        self.channels.iter().map(ValueGrid::bytes).sum()
    }
}
