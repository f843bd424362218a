//! The optical depth along one ray as a function of distance.
//!
//! A renderer asks the same ray many times for its transmittance, and wants points on it that are
//! equally spaced in transmittance. Uniform media answer in closed form; grids tabulate one knot a voxel
//! cell that the ray crosses. Between knots sigma_t is the quadratic through its three values, whose
//! integral (Simpson's rule) is that of the trilinear density's cubic at every knot. Profiles of volumes that overlap add up:
//! between the knots of all of them the sum is a quadratic too.

use super::grid::cubic::Cubic;
use crate::math::{Rgb, Span, exp};
use crate::medium::Flight;

/// The optical depth of one ray over one span. Reused from ray to ray: it keeps its allocation.
#[derive(Debug, Default)]
pub struct RayProfile {
    span: Option<Span>,
    /// sigma_t of a uniform medium; 0 where there are knots.
    uniform: Rgb,
    knots: Vec<ProfileKnot>,
}

/// The end of one piece of the ray. Within the piece sigma_t is the quadratic through its three values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileKnot {
    /// Distance at which the piece ends \[m\].
    pub distance: f64,
    /// Optical depth from the span's start to `distance`.
    pub optical_depth: f64,
    /// sigma_t at the piece's start, middle and end \[1/m\].
    pub sigma_t: [f64; 3],
}

impl RayProfile {
    /// Describes a uniform medium.
    pub fn set_uniform(&mut self, span: Span, sigma_t: Rgb) {
        self.begin(span);
        self.uniform = sigma_t;
    }

    /// Starts over with a span of no extinction, to be filled by [`push`](Self::push).
    pub fn begin(&mut self, span: Span) {
        self.span = Some(span);
        self.uniform = Rgb::ZERO;
        self.knots.clear();
    }

    /// Adds the next piece. The first starts at the span's start, each other where the last one ended.
    pub fn push(&mut self, knot: ProfileKnot) {
        let is_empty = |knot: &ProfileKnot| knot.sigma_t == [0.0; 3];
        let start = self.start();
        match self.knots.last_mut() {
            Some(last) if knot.distance <= last.distance => {}
            Some(last) if is_empty(last) && is_empty(&knot) => last.distance = knot.distance,
            None if knot.distance <= start => {}
            _ => self.knots.push(knot),
        }
    }

    /// Describes the sum of grey profiles, each of a part of the span.
    pub fn set_sum(&mut self, span: Span, parts: &[Self]) {
        self.begin(span);
        let mut ends: Vec<f64> = parts.iter().flat_map(Self::joints).chain([span.end]).collect();
        ends.retain(|end| *end > span.start && *end <= span.end);
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        // The piece of each part that the place is in.
        let mut pieces = vec![0; parts.len()];
        let mut start = span.start;
        for end in ends {
            let middle = 0.5 * (start + end);
            let (mut optical_depth, mut sigma_t) = (0.0, [0.0; 3]);
            for (part, piece) in parts.iter().zip(&mut pieces) {
                while part.knots.get(*piece).is_some_and(|knot| knot.distance <= start) {
                    *piece += 1;
                }
                for (sum, place) in sigma_t.iter_mut().zip([start, middle, end]) {
                    *sum += part.sigma_t_in(*piece, middle, place);
                }
                optical_depth += part.depth_in(*piece, end);
            }
            self.push(ProfileKnot { distance: end, optical_depth, sigma_t });
            start = end;
        }
    }

    /// Where what it describes may change its form.
    fn joints(&self) -> impl Iterator<Item = f64> {
        [self.start(), self.end()].into_iter().chain(self.knots.iter().map(|knot| knot.distance))
    }

    /// sigma_t at a distance by the quadratic of the piece that `within` lies in; 0 if that is beyond the span or the last knot.
    fn sigma_t_in(&self, piece: usize, within: f64, distance: f64) -> f64 {
        if within < self.start() || within > self.end() {
            return 0.0;
        }
        if self.knots.is_empty() {
            return self.uniform.x;
        }
        let Some(knot) = self.knots.get(piece) else { return 0.0 };
        let (start, _) = self.start_of(piece);
        let u = ((distance - start) / (knot.distance - start)).clamp(0.0, 1.0);
        let [first, middle, last] = knot.sigma_t;
        let (a, b) = (2.0 * (first + last) - 4.0 * middle, 4.0 * middle - 3.0 * first - last);
        first + u * (b + u * a)
    }

    /// The span described; `None` before the first ray.
    pub fn span(&self) -> Option<Span> {
        self.span
    }

    /// Optical depth per channel from the span's start to `distance` along the ray.
    pub fn optical_depth(&self, distance: f64) -> Rgb {
        if self.knots.is_empty() {
            uniform_depth(self.uniform, distance - self.start())
        } else {
            Rgb::splat(self.scalar_depth(distance))
        }
    }

    /// Transmittance per channel from the span's start to `distance` along the ray.
    pub fn transmittance(&self, distance: f64) -> Rgb {
        if self.knots.is_empty() {
            exp(-uniform_depth(self.uniform, distance - self.start()))
        } else {
            Rgb::splat((-self.scalar_depth(distance)).exp())
        }
    }

    /// Transmittance per channel of the whole span.
    pub fn total_transmittance(&self) -> Rgb {
        match self.knots.last() {
            Some(last) => Rgb::splat((-last.optical_depth).exp()),
            None => self.transmittance(self.end()),
        }
    }

    /// The distance along the ray at which a channel's optical depth from the span's start reaches `optical_depth`; the
    /// span's end if it does not. All channels are the same in a grid.
    pub fn distance_at(&self, optical_depth: f64, channel: usize) -> f64 {
        if self.knots.is_empty() {
            let sigma_t = self.uniform[channel];
            // The quotient may be 0/0; then nothing is on the way.
            let distance = self.start() + optical_depth / sigma_t;
            return if sigma_t > 0.0 { distance.min(self.end()) } else { self.end() };
        }
        let piece = self.knots.partition_point(|knot| knot.optical_depth < optical_depth);
        let Some(knot) = self.knots.get(piece) else { return self.end() };
        let (start, depth_before) = self.start_of(piece);
        let length = knot.distance - start;
        start
            + length * Cubic::through(knot.sigma_t).invert((optical_depth - depth_before) / length)
    }

    /// Optical depth of the whole span, where all channels are the same.
    pub(super) fn total_depth(&self) -> f64 {
        self.optical_depth(self.end()).x
    }

    /// The flight that collides where the optical depth reaches `optical_depth`, where all channels are the same.
    pub(super) fn flight_at(&self, optical_depth: f64) -> Flight {
        let distance = self.distance_at(optical_depth, 0);
        match distance < self.end() {
            true => Flight::Collision { distance, weight: Rgb::ONE },
            false => Flight::Escape { weight: Rgb::ONE },
        }
    }

    /// Optical depth to a distance where there are knots.
    fn scalar_depth(&self, distance: f64) -> f64 {
        self.depth_in(self.knots.partition_point(|knot| knot.distance < distance), distance)
    }

    /// Optical depth to a distance that lies in a piece, or beyond the last one; of a uniform medium to any.
    fn depth_in(&self, piece: usize, distance: f64) -> f64 {
        if self.knots.is_empty() {
            let length = distance.clamp(self.start(), self.end()) - self.start();
            return uniform_depth(self.uniform, length).x;
        }
        let (start, depth_before) = self.start_of(piece);
        let Some(knot) = self.knots.get(piece) else { return depth_before };
        let length = knot.distance - start;
        let u = ((distance - start) / length).max(0.0);
        // A quadratic through values of a cubic can dip below 0; the depth never falls.
        let depth = depth_before + length * Cubic::through(knot.sigma_t).integral_to(u);
        depth.clamp(depth_before, knot.optical_depth.max(depth_before))
    }

    /// Where a piece starts: distance and optical depth.
    fn start_of(&self, piece: usize) -> (f64, f64) {
        match piece.checked_sub(1).and_then(|previous| self.knots.get(previous)) {
            Some(knot) => (knot.distance, knot.optical_depth),
            None => (self.start(), 0.0),
        }
    }

    fn start(&self) -> f64 {
        self.span.map_or(0.0, |span| span.start)
    }

    fn end(&self) -> f64 {
        self.span.map_or(0.0, |span| span.end)
    }
}

/// sigma_t times distance; 0 times infinity is 0.
fn uniform_depth(sigma_t: Rgb, distance: f64) -> Rgb {
    let depth = |sigma_t: f64| if sigma_t > 0.0 { sigma_t * distance } else { 0.0 };
    Rgb::new(depth(sigma_t.x), depth(sigma_t.y), depth(sigma_t.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() <= 1e-13 * (1.0 + a.abs() + b.abs())
    }

    #[test]
    fn a_uniform_medium_is_exponential_in_each_channel() {
        let mut profile = RayProfile::default();
        assert_eq!(profile.span(), None);
        profile.set_uniform(Span::new(2.0, f64::INFINITY), Rgb::new(1.0, 0.5, 0.0));
        assert_eq!(profile.optical_depth(4.0), Rgb::new(2.0, 1.0, 0.0));
        assert!(close(profile.transmittance(4.0).y, (-1.0_f64).exp()));
        assert_eq!(profile.total_transmittance(), Rgb::new(0.0, 0.0, 1.0));
        assert!(close(profile.distance_at(1.0, 1), 4.0));
        assert_eq!(profile.distance_at(0.0, 2), f64::INFINITY);
    }

    /// Empty up to 1, then sigma_t = d - 1 up to 3, then 2 up to 4, then empty up to 6.
    fn ramp() -> RayProfile {
        let mut profile = RayProfile::default();
        profile.begin(Span::new(0.0, 6.0));
        let mut push = |distance, optical_depth, sigma_t| {
            profile.push(ProfileKnot { distance, optical_depth, sigma_t })
        };
        push(0.5, 0.0, [0.0; 3]);
        push(1.0, 0.0, [0.0; 3]);
        push(3.0, 2.0, [0.0, 1.0, 2.0]);
        push(4.0, 4.0, [2.0; 3]);
        push(5.0, 4.0, [0.0; 3]);
        push(6.0, 4.0, [0.0; 3]);
        profile
    }

    #[test]
    fn knots_integrate_and_invert() {
        let profile = ramp();
        assert_eq!(profile.knots.len(), 4, "empty stretches are one knot each");
        let exact = |d: f64| match d {
            _ if d < 1.0 => 0.0,
            _ if d < 3.0 => 0.5 * (d - 1.0) * (d - 1.0),
            _ if d < 4.0 => 2.0 + 2.0 * (d - 3.0),
            _ => 4.0,
        };
        for step in -10..=70 {
            let distance = 0.1 * f64::from(step);
            assert!(close(profile.optical_depth(distance).x, exact(distance)), "{distance}");
            assert!(close(profile.transmittance(distance).z, (-exact(distance)).exp()));
        }
        for step in 1..40 {
            let depth = 0.1 * f64::from(step);
            assert!(close(exact(profile.distance_at(depth, 0)), depth));
        }
        assert_eq!(profile.distance_at(4.5, 1), 6.0);
        assert!(close(profile.total_transmittance().x, (-4.0_f64).exp()));
    }

    #[test]
    fn the_depth_never_falls_where_the_quadratic_is_negative() {
        // Through (1 - u)^3.
        let mut profile = RayProfile::default();
        profile.begin(Span::new(0.0, 1.0));
        profile.push(ProfileKnot {
            distance: 1.0,
            optical_depth: 0.25,
            sigma_t: [1.0, 0.125, 0.0],
        });
        for step in 0..=100 {
            let depth = profile.optical_depth(0.01 * f64::from(step)).x;
            assert!((0.0..=0.25).contains(&depth));
            let found = profile.distance_at(depth, 0);
            assert!((profile.optical_depth(found).x - depth).abs() < 1e-13);
        }
    }

    #[test]
    fn a_new_ray_forgets_the_last() {
        let mut profile = ramp();
        profile.begin(Span::new(0.0, 1.0));
        assert_eq!(profile.total_transmittance(), Rgb::ONE);
        assert_eq!(profile.distance_at(1e-9, 0), 1.0);
    }
}
