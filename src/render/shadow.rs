//! Transmittance from a place in the medium to a light.

use crate::math::{DVec3, Ray, Rgb, Span};
use crate::medium::{Extinction, Medium};

/// Transmittance from `place` along `direction` over `distance` \[m\] (infinite for distant lights), by the exact
/// optical depth.
pub fn transmittance_to<E: Extinction>(
    medium: &Medium,
    extinction: &E,
    place: DVec3,
    direction: DVec3,
    distance: f64,
) -> Rgb {
    let ray = Ray::new(place, direction);
    let inside = medium.bounds.intersect(&ray).and_then(|s| s.intersect(Span::new(0.0, distance)));
    inside.map_or(Rgb::ONE, |span| extinction.transmittance(&ray, span))
}
