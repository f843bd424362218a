//! The few mathematical words every stage shares: colour, rays, spans of a ray, and random streams.
//!
//! Geometry and transport are computed in `f64`: a scene may lie a million metres from the origin
//! or be a micrometre wide. Only stored photons and images are `f32`.

pub(crate) mod content_hash;
mod random;
mod ray;
mod spherical_triangle;
pub mod square_maps;

pub use glam::{DAffine3, DMat3, DVec2, DVec3};
pub use random::{Random, Stream, uniform};
pub use ray::{Ball, Frame, Ray, Span};
pub use spherical_triangle::SphericalTriangle;

/// Linear RGB (Rec.709 primaries): a coefficient, a power, or a radiance per channel.
pub type Rgb = DVec3;

/// The largest of the three channels.
pub fn max_channel(color: Rgb) -> f64 {
    color.max_element()
}

/// Mean of the three channels.
pub fn mean_channel(color: Rgb) -> f64 {
    (color.x + color.y + color.z) / 3.0
}

/// exp applied to each channel; once where they are equal.
pub fn exp(color: Rgb) -> Rgb {
    if color.x == color.y && color.y == color.z {
        return Rgb::splat(color.x.exp());
    }
    Rgb::new(color.x.exp(), color.y.exp(), color.z.exp())
}
