//! What a collision leaves behind.

/// A photon stored at a collision with the medium.
///
/// 44 bytes on the way to the map, which keeps less of it. Positions are relative to the medium and in units
/// of its size, so that `f32` loses nothing to a far origin or an extreme scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    /// Place of the collision in [`MapFrame`](crate::trace::MapFrame) coordinates.
    pub position: [f32; 3],
    /// Unit direction of travel before the collision.
    pub direction: [f32; 3],
    /// Power before the albedo \[W\].
    pub power: [f32; 3],
    /// sigma_t at the collision \[1/m\], largest channel.
    pub sigma_t: f32,
    /// Scatterings before this collision: 0 for light straight from its source.
    pub order: u32,
}
