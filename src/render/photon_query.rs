//! Queries of the photon map, put in an order in which each is near the last.
//!
//! Along one ray queries are far apart; across a tile of pixels they are dense. Sorted along a Morton curve, most find
//! their photons within a radius known from the query before.

use crate::map::morton_code;
use crate::math::{DVec3, Rgb};

/// Light scattered at a place towards the camera, wanted for a pixel.
#[derive(Clone, Copy, Debug)]
pub struct PhotonQuery {
    /// \[m\]
    pub place: DVec3,
    /// Unit direction of travel towards the camera.
    pub towards: DVec3,
    /// Factor on the light found, per channel.
    pub weight: Rgb,
    /// A random number of the query's own, in \[0, 1): the turn of a ball's quadrature, or the seed of a path.
    pub turn: f64,
    /// The pixel that asks.
    pub pixel: u32,
}

/// Sorts queries along a Morton curve through their bounding box; equal places keep their order.
pub fn sort_along_curve(queries: &mut [PhotonQuery]) {
    let places = || queries.iter().map(|query| query.place);
    let low = places().fold(DVec3::INFINITY, DVec3::min);
    let high = places().fold(DVec3::NEG_INFINITY, DVec3::max);
    let cells = f64::from(1u32 << 10) / (high - low).max_element().max(f64::MIN_POSITIVE);
    queries.sort_by_cached_key(|query| {
        let cell = (query.place - low) * cells;
        morton_code(cell.to_array().map(|c| c as u64))
    });
}
