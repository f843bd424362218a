//! Light that the medium emits towards the camera, without photons: L = integral of T(t) j(t) dt.
//!
//! The ray is cut into steps of a voxel, each with one random place. Of heat, j = sigma_a B(T): within a step places are drawn
//! by transmittance, so that what a step sends is its share of the ray's opacity times (1 - albedo) B, and opaque media
//! are as smooth as thin ones; where T is the same everywhere there is no noise at all. Of flames, which need no
//! extinction, places are even. Both are without bias, up to what lies behind 64 mean free paths.

use crate::math::{Random, Ray, Rgb, Span, uniform};
use crate::medium::{Emissivity, Medium, RayProfile};
use crate::render::distances::ByTransmittance;

/// Most steps a ray: voxels may be far smaller than the medium.
const MAX_STEPS: f64 = 4096.0;

/// Optical depth beyond which nothing is seen: a transmittance of 2e-28.
const OPAQUE_DEPTH: f64 = 64.0;

/// Radiance that the medium sends along the part `span` of a ray to its start \[W/(m^2 sr)\]; `profile` is that of the span.
pub fn emitted_light(
    medium: &Medium,
    emissivity: &Emissivity,
    ray: &Ray,
    span: Span,
    profile: &RayProfile,
    random: &mut Random,
) -> Rgb {
    let steps = (span.length() / emissivity.voxel_size()).ceil().clamp(1.0, MAX_STEPS);
    let length = span.length() / steps;
    let mut sum = Rgb::ZERO;
    let mut depth_before = Rgb::ZERO;
    for step in 0..steps as usize {
        let start = span.start + step as f64 * length;
        if depth_before.min_element() > OPAQUE_DEPTH {
            break;
        }
        let depth = profile.optical_depth(start + length);
        if emissivity.has_heat()
            && let Some(sampling) = ByTransmittance::between(profile, depth_before, depth)
        {
            sum += light_of_heat(medium, ray, &sampling, random);
        }
        depth_before = depth;
        if emissivity.has_flame() {
            let distance = start + length * uniform(random);
            let flame = medium.flame_at(ray.at(distance));
            if flame != Rgb::ZERO {
                sum += flame * profile.transmittance(distance) * length;
            }
        }
    }
    sum
}

/// The share of one step, whose places are drawn by transmittance.
fn light_of_heat(
    medium: &Medium,
    ray: &Ray,
    by_transmittance: &ByTransmittance,
    random: &mut Random,
) -> Rgb {
    let distance = by_transmittance.sample_distance(uniform(random), uniform(random));
    let place = ray.at(distance);
    match medium.heat_at(place) {
        Rgb::ZERO => Rgb::ZERO,
        heat => {
            let sigma_t = medium.extinction.sigma_t(place);
            by_transmittance.scattering_weight(distance, sigma_t, 1.0) * heat
        }
    }
}
