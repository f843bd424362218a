//! Distances along a ray at which to look for scattered light.
//!
//! Two densities cover all cases. By *transmittance*: p(t) = sigma_t T(t) / (1 - T(end)), inverted from the ray's
//! profile, follows what the camera sees (for a chromatic medium, the mean of its channels' densities).
//! *Equi-angular* (Kulla and Fajardo 2012): p(t) = D / (dtheta (D^2 + (t - delta)^2)) follows the inverse square of the
//! distance to a light at distance D from the ray, and removes its peak. The peak of what that light leaves to scatter again is a
//! lower one: p(t) = 1 / (A sqrt(D^2 + (t - delta)^2)) follows the inverse distance.

use crate::math::{DVec3, Ray, Rgb, Span, exp};
use crate::medium::RayProfile;

/// The quantile at which one of `count` strata is looked at: at `phase` of each. Best where light ends as it begins, as that of a cone that the ray crosses.
/// Uniform in the stratum if the phase is in \[0, 1).
#[inline]
pub fn even_quantile(stratum: usize, phase: f64, count: usize) -> f64 {
    (stratum as f64 + phase) / count as f64
}

/// The same at `phase` of every other stratum and at 1 - phase of those between, so that what two strata miss of a slope cancels. Below 1.
#[inline]
pub fn mirrored_quantile(stratum: usize, phase: f64, count: usize) -> f64 {
    let within = if stratum.is_multiple_of(2) { phase } else { 1.0 - phase };
    ((stratum as f64 + within) / count as f64).min(1.0 - f64::EPSILON)
}

/// Sampling by transmittance over a part of a ray.
pub struct ByTransmittance<'a> {
    profile: &'a RayProfile,
    /// Optical depth up to the part's start, per channel.
    depth_before: Rgb,
    /// 1 - T over the part, per channel.
    opacity: Rgb,
    /// Channels that differ: 1 if the medium is grey, else 3.
    channels: usize,
}

impl<'a> ByTransmittance<'a> {
    /// Sampling of `span`, a part of the profile's; `None` where it has no extinction.
    pub fn new(profile: &'a RayProfile, span: Span) -> Option<Self> {
        Self::between(profile, profile.optical_depth(span.start), profile.optical_depth(span.end))
    }

    /// Sampling of the part of the profile between two optical depths.
    pub fn between(profile: &'a RayProfile, depth_before: Rgb, depth_after: Rgb) -> Option<Self> {
        let depth = depth_after - depth_before;
        let opacity = Rgb::new(-(-depth.x).exp_m1(), -(-depth.y).exp_m1(), -(-depth.z).exp_m1());
        let channels = if depth.x == depth.y && depth.y == depth.z { 1 } else { 3 };
        (opacity.max_element() > 0.0).then_some(Self { profile, depth_before, opacity, channels })
    }

    /// The largest channel's 1 - T over the part.
    pub fn opacity(&self) -> f64 {
        self.opacity.max_element()
    }

    /// The distance at quantile `u`; `pick` in \[0, 1) chooses the channel of a chromatic medium.
    pub fn sample_distance(&self, u: f64, pick: f64) -> f64 {
        let channel = self.pick_channel(pick);
        let depth = self.depth_before[channel] - (-u * self.opacity[channel]).ln_1p();
        self.profile.distance_at(depth, channel)
    }

    /// Density of [`Self::sample_distance`] \[1/m\], where sigma_t and the transmittance from the ray's start are as
    /// given.
    pub fn pdf_distance(&self, transmittance: Rgb, sigma_t: Rgb) -> f64 {
        let channel = |c: usize| {
            if transmittance[c] > 0.0 && self.opacity[c] > 0.0 {
                let within = transmittance[c] * self.depth_before[c].exp();
                within * sigma_t[c] / self.opacity[c]
            } else {
                0.0
            }
        };
        match self.channels {
            1 => channel(0),
            _ => {
                let visible = (0..3).filter(|&c| self.opacity[c] > 0.0).count();
                (0..3).map(channel).sum::<f64>() / visible as f64
            }
        }
    }

    /// For `count` samples: T(t) sigma_t(t) / (count pdf(t)) per channel, in the form that is exact for grey media.
    pub fn scattering_weight(&self, distance: f64, sigma_t: Rgb, count: f64) -> Rgb {
        if self.channels == 1 {
            return exp(-self.depth_before) * self.opacity / count;
        }
        let transmittance = exp(-self.profile.optical_depth(distance));
        transmittance * sigma_t / (count * self.pdf_distance(transmittance, sigma_t))
    }

    /// One of the channels that are not transparent.
    fn pick_channel(&self, pick: f64) -> usize {
        if self.channels == 1 {
            return 0;
        }
        let visible: [bool; 3] = std::array::from_fn(|c| self.opacity[c] > 0.0);
        let count = visible.iter().filter(|v| **v).count();
        let chosen = ((pick * count as f64) as usize).min(count - 1);
        (0..3).filter(|&c| visible[c]).nth(chosen).unwrap_or(0)
    }
}

/// Equi-angular sampling about a position.
pub struct EquiAngular {
    span: Span,
    /// Distance of the ray's nearest point to the position.
    delta: f64,
    /// Distance of the position from the ray \[m\].
    offset: f64,
    /// Angle of the span's start, and the angle that the span fills, seen from the position.
    first: f64,
    angle: f64,
}

impl EquiAngular {
    /// Sampling of the part `span` of a ray about `position`.
    pub fn new(ray: &Ray, span: Span, position: DVec3) -> Self {
        let (delta, offset) = nearest(ray, position);
        let (a, b) = (span.start - delta, span.end - delta);
        let first = a.atan2(offset);
        // One arctangent of the difference, which does not cancel for a far light.
        let angle = if b.is_finite() {
            (offset * (b - a)).atan2(offset * offset + a * b)
        } else {
            std::f64::consts::FRAC_PI_2 - first
        };
        Self { span, delta, offset, first, angle }
    }

    /// The distance at quantile `u`.
    pub fn sample_distance(&self, u: f64) -> f64 {
        // tan(first + x) by the addition theorem: exact also where the angle is a rounding of `first`.
        let (tan_first, tan_step) = (self.first.tan(), (u * self.angle).tan());
        let step =
            self.offset * (tan_step * (1.0 + tan_first * tan_first)) / (1.0 - tan_first * tan_step);
        let from_start = self.span.start + step;
        let distance = if from_start.is_finite() && self.first.abs() < 1.5 {
            from_start
        } else {
            self.delta + self.offset * (self.first + u * self.angle).tan()
        };
        distance.clamp(self.span.start, self.span.end)
    }

    /// Density of [`Self::sample_distance`] \[1/m\].
    pub fn pdf_distance(&self, distance: f64) -> f64 {
        let along = distance - self.delta;
        self.offset / (self.angle * (self.offset * self.offset + along * along))
    }
}

/// Sampling by the inverse of the distance to a position.
pub struct InverseDistance {
    span: Span,
    /// Distance of the ray's nearest point to the position.
    delta: f64,
    /// Distance of the position from the ray \[m\].
    offset: f64,
    /// asinh((t - delta) / offset) of the span's start, and how much more it is at its end.
    first: f64,
    width: f64,
}

impl InverseDistance {
    /// Sampling of the part `span` of a ray about `position`, which is no farther than some lengths of the span.
    pub fn new(ray: &Ray, span: Span, position: DVec3) -> Self {
        let (delta, offset) = nearest(ray, position);
        let [first, last] = [span.start, span.end].map(|end| ((end - delta) / offset).asinh());
        Self { span, delta, offset, first, width: last - first }
    }

    /// The distance at quantile `u`.
    pub fn sample_distance(&self, u: f64) -> f64 {
        let distance = self.delta + self.offset * (self.first + u * self.width).sinh();
        distance.clamp(self.span.start, self.span.end)
    }

    /// Density of [`Self::sample_distance`] \[1/m\].
    pub fn pdf_distance(&self, distance: f64) -> f64 {
        1.0 / (self.width * self.offset.hypot(distance - self.delta))
    }
}

/// How far along a ray it is nearest to a position, and how near. A ray through a light itself would see it without bound: the floor is far below any pixel.
fn nearest(ray: &Ray, position: DVec3) -> (f64, f64) {
    let to_position = position - ray.origin;
    let delta = to_position.dot(ray.direction);
    let floor = 1e-12 * to_position.length() + f64::MIN_POSITIVE;
    (delta, (to_position - ray.direction * delta).length().max(floor))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One place a stratum, the slopes of two cancel, and no phase reaches 1.
    #[test]
    fn quantiles_mirror_every_other_stratum() {
        for (phase, found) in
            [(0.25, [0.0625, 0.4375, 0.5625, 0.9375]), (0.0, [0.0, 0.5, 0.5, 1.0])]
        {
            let places: [f64; 4] =
                std::array::from_fn(|stratum| mirrored_quantile(stratum, phase, 4));
            let same = places.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-15);
            assert!(same && places.iter().all(|u| *u < 1.0), "{places:?}");
            assert!((places.iter().sum::<f64>() - 2.0).abs() < 1e-15);
        }
        assert!(mirrored_quantile(127, 1e-17, 128) < 1.0);
    }

    /// The pdf is the derivative of the quantile, and spans the span, for near, far and grazing lights.
    #[test]
    fn equi_angular_distances_follow_their_density() {
        let ray = Ray::new(DVec3::ZERO, DVec3::Z);
        let span = Span::new(0.5, 3.0);
        for position in [
            DVec3::new(0.3, 0.0, 1.0),
            DVec3::new(1e-7, 0.0, 2.0),
            DVec3::new(1e7, 0.0, -1e7),
            DVec3::new(0.2, 0.0, -40.0),
            DVec3::new(0.0, 0.01, 900.0),
        ] {
            let sampling = EquiAngular::new(&ray, span, position);
            assert!((sampling.sample_distance(0.0) - span.start).abs() < 1e-9, "{position}");
            assert!((sampling.sample_distance(1.0) - span.end).abs() < 1e-6, "{position}");
            for step in 1..50 {
                let u = f64::from(step) / 50.0;
                let h = 1e-5;
                let (low, high) =
                    (sampling.sample_distance(u - h), sampling.sample_distance(u + h));
                let density = 2.0 * h / (high - low);
                let middle = sampling.sample_distance(u);
                let ratio = density / sampling.pdf_distance(middle);
                assert!((ratio - 1.0).abs() < 2e-3, "{position} at {u}: {ratio}");
            }
        }
    }

    #[test]
    fn inverse_distances_follow_their_density() {
        let ray = Ray::new(DVec3::ZERO, DVec3::Z);
        let span = Span::new(0.5, 3.0);
        for (x, z, h) in [(0.3, 1.0, 1e-5), (1e-7, 2.0, 1e-5), (0.0, 2.0, 1e-7), (2.0, 0.1, 1e-5)] {
            let sampling = InverseDistance::new(&ray, span, DVec3::new(x, 0.0, z));
            assert!((sampling.sample_distance(0.0) - span.start).abs() < 1e-9, "{x}");
            assert!((sampling.sample_distance(1.0) - span.end).abs() < 1e-9, "{x}");
            for step in 1..50 {
                let u = f64::from(step) / 50.0;
                let (low, high) =
                    (sampling.sample_distance(u - h), sampling.sample_distance(u + h));
                let density = 2.0 * h / (high - low);
                let ratio = density / sampling.pdf_distance(sampling.sample_distance(u));
                // Where a ray all but meets the position distances are rounded.
                assert!((ratio - 1.0).abs() < 2e-3 || high - low < 1e-12, "{x} at {u}: {ratio}");
            }
        }
    }

    #[test]
    fn transmittance_sampling_inverts_each_channel() {
        let mut profile = RayProfile::default();
        let span = Span::new(1.0, 4.0);
        let sigma_t = Rgb::new(0.2, 1.0, 5.0);
        profile.set_uniform(span, sigma_t);
        let sampling = ByTransmittance::new(&profile, span).unwrap();
        // Mean of the weights over the mixture is 1 - T(end) per channel.
        let mut sum = Rgb::ZERO;
        let steps = 30_000;
        for i in 0..steps {
            let u = (f64::from(i) + 0.5) / f64::from(steps);
            let pick = (u * 7919.0).fract();
            let distance = sampling.sample_distance(u, pick);
            sum += sampling.scattering_weight(distance, sigma_t, f64::from(steps));
        }
        let exact = Rgb::ONE - exp(-sigma_t * 3.0);
        assert!((sum / exact - Rgb::ONE).abs().max_element() < 1e-2, "{sum} {exact}");
    }
}
