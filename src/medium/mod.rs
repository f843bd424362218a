//! Participating media: what fills the scene, how it attenuates light, and how it scatters it.
//!
//! A [`Medium`] is an [`Extinction`] (homogeneous or a grid) inside [`Bounds`], with an albedo (one for all, or coloured
//! place by place), a phase [`Phase`] and, where it glows, an [`Emissivity`]. Tracing and rendering are generic over the extinction, so that a homogeneous fog
//! pays nothing for grids.

mod ball_points;
mod blackbody;
mod bounds;
mod cie_1931;
mod emissive_cells;
mod emissivity;
pub mod grid;
mod homogeneous;
mod moments;
mod overlap;
mod pages;
mod phase;
mod profile;

pub mod vdb;

pub use blackbody::{blackbody_radiance, blackbody_xyz};
pub use bounds::{Bounds, Face, Parallelepiped};
pub use emissive_cells::{EmissiveCells, EmissivePlace};
pub use emissivity::{Emissivity, Flame};
pub use grid::{ColorGrid, GridExtinction, ValueGrid};
pub use homogeneous::{ChromaticExtinction, UniformExtinction};
pub use moments::BallMoments;
pub use overlap::BallIntegral;
pub use phase::{ISOTROPIC, LARGEST_DROPLET, Lobe, Phase, SMALLEST_DROPLET};
pub use profile::{ProfileKnot, RayProfile};

use crate::math::{Ball, DVec3, Random, Ray, Rgb, Span, exp};

/// The medium of a scene.
#[derive(Debug)]
pub struct Medium {
    /// Where the medium is; outside it there is nothing.
    pub bounds: Bounds,
    /// How strongly it attenuates.
    pub extinction: MediumExtinction,
    /// sigma_s / sigma_t per channel, in \[0, 1\]: everywhere, or where `color` is white.
    pub albedo: Rgb,
    /// What the albedo is multiplied by, place by place.
    pub color: Option<Box<ColorGrid>>,
    /// Where scattered light goes.
    pub phase: Phase,
    /// Light of its own.
    pub emissivity: Option<Box<Emissivity>>,
}

impl Medium {
    /// The medium with light of its own; an infinite one has none.
    pub fn with_emissivity(mut self, emissivity: Emissivity) -> Self {
        if matches!(self.bounds, Bounds::Infinite) {
            return self;
        }
        let voxel_size = emissivity.voxel_size();
        self.emissivity = Some(Box::new(emissivity));
        let cells = EmissiveCells::new(&self, voxel_size);
        if let Some(emissivity) = &mut self.emissivity {
            emissivity.set_cells(cells);
        }
        self
    }

    /// Emissivity at a place \[W/(m^3 sr)\]; 0 outside the bounds.
    pub fn emissivity_at(&self, position: DVec3) -> Rgb {
        let Some(emissivity) = &self.emissivity else { return Rgb::ZERO };
        if !self.bounds.contains(position) {
            return Rgb::ZERO;
        }
        let flame = emissivity.flame(position);
        match emissivity.blackbody(position) {
            Rgb::ZERO => flame,
            blackbody => {
                let sigma_t = self.extinction.sigma_t(position);
                flame + blackbody * sigma_t * (Rgb::ONE - self.albedo_at(position))
            }
        }
    }

    /// The albedo at a place: the medium's own times its colour there, each channel at most 1.
    #[inline]
    pub fn albedo_at(&self, position: DVec3) -> Rgb {
        match &self.color {
            None => self.albedo,
            Some(color) => (self.albedo * color.color(position)).min(Rgb::ONE),
        }
    }

    /// No place has a larger albedo.
    pub fn max_albedo(&self) -> Rgb {
        let color = self.color.as_ref().map_or(Rgb::ONE, |color| color.max());
        (self.albedo * color).min(Rgb::ONE)
    }
}

/// The kinds of extinction a scene may hold. Match once, outside the loops, and go on with the one found.
#[derive(Debug)]
pub enum MediumExtinction {
    /// One sigma_t for all channels.
    Uniform(UniformExtinction),
    /// One sigma_t a channel.
    Chromatic(ChromaticExtinction),
    /// sigma_t = density_scale * density, from a VDB grid.
    Grid(Box<GridExtinction>),
}

impl MediumExtinction {
    /// sigma_t at a place, whatever the kind \[1/m\].
    pub fn sigma_t(&self, position: DVec3) -> Rgb {
        match self {
            Self::Uniform(uniform) => uniform.sigma_t(position),
            Self::Chromatic(chromatic) => chromatic.sigma_t(position),
            Self::Grid(grid) => grid.sigma_t(position),
        }
    }
}

/// How strongly a medium attenuates light along rays. `Span`s passed in lie inside the medium's bounds.
pub trait Extinction: Sync {
    /// Whether sigma_t is the same at every place of the bounds: then no photon needs its own.
    const IS_UNIFORM: bool;

    /// Whether it differs between channels: then photons change colour as they fly.
    const IS_CHROMATIC: bool = false;

    /// sigma_t at a point \[1/m\]; 0 outside a grid's bounds. A uniform extinction does not look at the point.
    fn sigma_t(&self, position: DVec3) -> Rgb;

    /// Integral of sigma_t over the span, exact up to rounding.
    fn optical_depth(&self, ray: &Ray, span: Span) -> Rgb;

    /// exp(-optical depth) over the span. A grid stops looking where nothing is left to see.
    fn transmittance(&self, ray: &Ray, span: Span) -> Rgb {
        exp(-self.optical_depth(ray, span))
    }

    /// A random number per channel whose mean is the transmittance over the span: ratio tracking in grids, which looks up a few
    /// densities instead of crossing every cell; exact in uniform media.
    fn estimate_transmittance(&self, ray: &Ray, span: Span, _random: &mut Random) -> Rgb {
        self.transmittance(ray, span)
    }

    /// Probability that a photon of the given power collides within the span: 1 - T, for a chromatic medium
    /// averaged over the channels' shares of the power.
    fn opacity(&self, ray: &Ray, span: Span, power: Rgb) -> f64 {
        let depth = self.optical_depth(ray, span);
        let opacity = Rgb::new(-(-depth.x).exp_m1(), -(-depth.y).exp_m1(), -(-depth.z).exp_m1());
        let total = power.element_sum();
        if total > 0.0 { opacity.dot(power) / total } else { opacity.element_sum() / 3.0 }
    }

    /// Draws the next collision of a photon of the given power: analytic in uniform media, delta
    /// tracking with local majorants in grids.
    fn sample_flight(&self, ray: &Ray, span: Span, power: Rgb, random: &mut Random) -> Flight;

    /// What a photon of the given power, drawn by [`Extinction::sample_flight`], weighs per channel where it is still flying
    /// after `length` \[m\]: 1 in the mean of its power.
    fn flying_weight(&self, _length: f64, _power: Rgb) -> Rgb {
        Rgb::ONE
    }

    /// The collision at quantile `u` in \[0, 1) of the free-flight distribution, by exact inversion: keeps
    /// the strata of `u` intact.
    fn invert_flight(&self, ray: &Ray, span: Span, power: Rgb, u: f64) -> Flight;

    /// A flight made to end in a collision more often than by nature. With opacity o and probability
    /// p = min(1, `boost` o), `boost` >= 1, a `u` below p is a collision at quantile o u / p that carries the share
    /// o / p of the power; any other escapes. `profile` is memory for grids; `is_known` tells that it is still that of this very ray.
    fn boosted_flight(
        &self,
        ray: &Ray,
        span: Span,
        power: Rgb,
        boosted: BoostedQuantile,
        _profile: &mut RayProfile,
        _is_known: bool,
    ) -> BoostedFlight {
        let opacity = self.opacity(ray, span, power);
        boosted.flight(opacity, |quantile| self.invert_flight(ray, span, power, quantile))
    }

    /// Fills `profile` with the optical depth along the span, as a function of distance.
    fn profile(&self, ray: &Ray, span: Span, profile: &mut RayProfile);

    /// Moments over the ball of min(sigma_t / `ceiling`, 1) (1 - `falloff` (d / r)^2), for the normalisation of kernels: in
    /// a uniform medium of what is inside `bounds`, whatever the ceiling. `turn` in \[0, 1) turns the
    /// quadrature points.
    fn ball_moments(
        &self,
        bounds: &Bounds,
        ball: Ball,
        _ceiling: f64,
        turn: f64,
        falloff: f64,
    ) -> BallMoments {
        BallMoments::inside(bounds, ball, turn, falloff)
    }
}

/// A quantile of the first flight, and how many times likelier than by nature it should collide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoostedQuantile {
    /// In \[0, 1).
    pub u: f64,
    /// At least 1.
    pub boost: f64,
}

/// A flight that is worth only a share of the photon's power; the rest of it has escaped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoostedFlight {
    /// Its end.
    pub flight: Flight,
    /// In (0, 1\].
    pub share: f64,
    /// Factor on the power that escapes: 1 where all channels share one sigma_t.
    pub escape_weight: Rgb,
}

impl BoostedQuantile {
    /// The flight through a medium of the given opacity, inverted at the quantile it asks for.
    #[inline]
    pub fn flight(self, opacity: f64, invert: impl FnOnce(f64) -> Flight) -> BoostedFlight {
        let probability = (opacity * self.boost).min(1.0);
        if self.u < probability {
            let flight = invert(opacity * (self.u / probability));
            let share = opacity / probability;
            return BoostedFlight { flight, share, escape_weight: Rgb::ONE };
        }
        let flight = Flight::Escape { weight: Rgb::ONE };
        BoostedFlight { flight, share: 1.0, escape_weight: Rgb::ONE }
    }
}

/// The end of a photon's flight.
///
/// `weight` multiplies the photon's power. It is 1 where all channels share one sigma_t; otherwise it
/// corrects each channel for having been sampled with the mixture of all (mean 1 over both outcomes).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flight {
    /// It collided with the medium at this distance along the ray.
    Collision {
        /// Distance along the ray \[m\].
        distance: f64,
        /// Factor on the photon's power.
        weight: Rgb,
    },
    /// It reached the end of the span.
    Escape {
        /// Factor on the photon's power.
        weight: Rgb,
    },
}
