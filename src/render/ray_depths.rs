//! How deep a ray looks into the medium: where its transmittance falls to one half, and where it scatters first in the mean.
//!
//! Of the light that scatters at distance t towards the camera, the share T(t) sigma_s(t) dt is seen, so that the mean distance is
//! the integral of t T sigma_s over that of T sigma_s, both mean channel. In a uniform medium both are in closed form; in a grid
//! distances are drawn by transmittance, one a stratum.

use crate::film::PixelDepths;
use crate::math::{Ray, Span, mean_channel};
use crate::medium::{Extinction, Medium, RayProfile};
use crate::render::distances::ByTransmittance;

/// Strata of a ray through a grid.
const STRATA: usize = 16;

/// Halvings of the ray in which a chromatic medium's half distance is sought: to the last bit.
const HALVINGS: usize = 64;

/// Optical depth below which its exponential is a series.
const SHALLOW: f64 = 1e-3;

/// Depths of a ray whose part `span` is inside the medium, `profile` that part's; strata are looked at in `phase`.
pub fn ray_depths<E: Extinction>(
    medium: &Medium,
    extinction: &E,
    ray: &Ray,
    span: Span,
    profile: &RayProfile,
    phase: f64,
) -> PixelDepths {
    let [scatter_distance, scatter_weight] = match E::IS_UNIFORM {
        true => uniform_scattering(extinction, medium, ray, span),
        false => sampled_scattering((extinction, medium), ray, span, profile, phase),
    };
    let half = half_distance(profile, span);
    PixelDepths {
        half_distance: half.unwrap_or(0.0),
        half_share: if half.is_some() { 1.0 } else { 0.0 },
        scatter_distance,
        scatter_weight,
    }
}

/// Where the mean channel of the transmittance is one half.
fn half_distance(profile: &RayProfile, span: Span) -> Option<f64> {
    let depth = profile.optical_depth(span.end);
    if depth.x == depth.y && depth.y == depth.z {
        let half = std::f64::consts::LN_2;
        return (depth.x >= half).then(|| profile.distance_at(half, 0));
    }
    let is_beyond = |distance: f64| mean_channel(profile.transmittance(distance)) <= 0.5;
    if !is_beyond(span.end) {
        return None;
    }
    let (mut near, mut far) = (span.start, span.end);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (near + far);
        *(if is_beyond(middle) { &mut far } else { &mut near }) = middle;
    }
    Some(far)
}

/// The two integrals over a uniform medium, channel by channel.
fn uniform_scattering<E: Extinction>(
    extinction: &E,
    medium: &Medium,
    ray: &Ray,
    span: Span,
) -> [f64; 2] {
    let place = ray.at(span.start);
    let (sigma_t, albedo) = (extinction.sigma_t(place), extinction.albedo_at(medium, place));
    let mut sums = [0.0; 2];
    for channel in 0..3 {
        let depth = sigma_t[channel] * span.length();
        if depth > 0.0 {
            let opacity = -(-depth).exp_m1();
            // The integral of x exp(-x) from 0 to the depth.
            let first_moment = match depth < SHALLOW {
                true => depth * depth * (0.5 - depth * (1.0 / 3.0 - depth / 8.0)),
                false => opacity - depth * (-depth).exp(),
            };
            let share = albedo[channel] / 3.0;
            sums[0] += share * (span.start * opacity + first_moment / sigma_t[channel]);
            sums[1] += share * opacity;
        }
    }
    sums
}

fn sampled_scattering<E: Extinction>(
    (extinction, medium): (&E, &Medium),
    ray: &Ray,
    span: Span,
    profile: &RayProfile,
    phase: f64,
) -> [f64; 2] {
    let mut sums = [0.0; 2];
    let Some(by_transmittance) = ByTransmittance::new(profile, span) else { return sums };
    let share = by_transmittance.opacity() / STRATA as f64;
    for stratum in 0..STRATA {
        // Looked at from both ends in turn: what one stratum reads too far, the next reads too near.
        let within = if stratum % 2 == 0 { phase } else { 1.0 - phase };
        let u = (stratum as f64 + within) / STRATA as f64;
        // Extinction in a grid is grey: there is no channel to pick.
        let distance = by_transmittance.sample_distance(u, 0.0);
        let albedo = extinction.albedo_at(medium, ray.at(distance));
        let weight = share * mean_channel(albedo);
        sums[0] += weight * distance;
        sums[1] += weight;
    }
    sums
}
