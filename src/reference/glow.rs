//! The medium's own light along a segment: L = integral of T(t) j(t) dt.
//!
//! A flight that ends at d has passed every place before d: the integral of j up to d has the mean of the integral of T j
//! (the track-length estimator). It is taken at one random place a step of two voxels.

use crate::math::{Random, Rgb, uniform};
use crate::medium::Extinction;

use super::segment::Segment;

/// Voxels a step.
const STEP: f64 = 2.0;

/// Most steps a segment.
const MAX_STEPS: f64 = 64.0;

/// An estimate of the radiance that the medium adds along a segment whose flight ended at `end` \[W/(m^2 sr)\].
pub(super) fn glow<E: Extinction>(segment: &Segment<E>, end: f64, random: &mut Random) -> Rgb {
    let Some(emissivity) = &segment.medium.emissivity else { return Rgb::ZERO };
    let length = end - segment.span.start;
    let steps = (length / (STEP * emissivity.voxel_size())).ceil().clamp(1.0, MAX_STEPS);
    let step = length / steps;
    let light = |number: usize| {
        let distance = segment.span.start + (number as f64 + uniform(random)) * step;
        let emitted = segment.medium.emissivity_at(segment.ray.at(distance));
        if emitted == Rgb::ZERO { emitted } else { emitted * segment.flight_weight(distance) }
    };
    (0..steps as usize).map(light).sum::<Rgb>() * step
}
