//! Participating media: what fills the scene, how it attenuates light, and how it scatters it.
//!
//! A [`Medium`] is an [`Extinction`] (homogeneous, a grid, or several [`Volumes`]) inside [`Bounds`], with an albedo (one for all, or coloured
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
mod scattering;

mod volumes;

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
pub use scattering::{PhaseMixture, PhaseShare, Scattering};
pub use volumes::{Volumes, VolumesError};

use crate::math::{Ball, DVec3, Random, Ray, Rgb, Span, exp};

/// The medium of a scene, or one volume of it.
///
/// Where `extinction` is [`Several`](MediumExtinction::Several), albedo, colour, phase function and emissivity are those of the
/// volumes: `albedo` is the largest, `phase` that of one of them.
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
    /// The medium that media make together; one alone stays as it is.
    ///
    /// # Errors
    /// [`VolumesError`], with the number of the medium.
    pub fn of_volumes(mut media: Vec<Self>) -> Result<Self, VolumesError> {
        if media.len() == 1
            && let Some(only) = media.pop()
        {
            return Ok(only);
        }
        // Places are drawn for all of them together.
        media.iter_mut().filter_map(|m| m.emissivity.as_mut()).for_each(|own| own.set_cells(None));
        let volumes = Volumes::new(media)?;
        let (bounds, media) = (volumes.bounds(), volumes.media());
        let albedo = media.iter().map(Self::max_albedo).fold(Rgb::ZERO, Rgb::max);
        let phase = media.first().map_or(Phase::Isotropic, |first| first.phase);
        let emissivity =
            Emissivity::of_volumes(media.iter().filter_map(|m| m.emissivity.as_deref()));
        let glowing = media.iter().filter(|m| m.emissivity.is_some()).collect::<Vec<_>>();
        let glow_bounds = match glowing.as_slice() {
            [only] => only.bounds,
            _ => bounds,
        };
        let extinction = MediumExtinction::Several(Box::new(volumes));
        let whole = Self { bounds, extinction, albedo, color: None, phase, emissivity: None };
        Ok(match emissivity {
            Some(emissivity) => whole.glowing_in(emissivity, &glow_bounds),
            None => whole,
        })
    }

    /// The medium number `number`, from 0, of those that it was made of.
    pub fn volume(&self, number: usize) -> Option<&Self> {
        match &self.extinction {
            MediumExtinction::Several(volumes) => volumes.given(number),
            _ => (number == 0).then_some(self),
        }
    }

    /// The medium with light of its own; an infinite one has none.
    pub fn with_emissivity(self, emissivity: Emissivity) -> Self {
        if matches!(self.bounds, Bounds::Infinite) {
            return self;
        }
        let bounds = self.bounds;
        self.glowing_in(emissivity, &bounds)
    }

    /// The medium with light that comes from within `bounds`.
    fn glowing_in(mut self, emissivity: Emissivity, bounds: &Bounds) -> Self {
        let voxel_size = emissivity.voxel_size();
        self.emissivity = Some(Box::new(emissivity));
        let cells = EmissiveCells::new(&self, bounds, voxel_size);
        if let Some(emissivity) = &mut self.emissivity {
            emissivity.set_cells(cells);
        }
        self
    }

    /// Emissivity at a place \[W/(m^3 sr)\]; 0 outside the bounds.
    pub fn emissivity_at(&self, position: DVec3) -> Rgb {
        if self.emissivity.is_none() || !self.bounds.contains(position) {
            return Rgb::ZERO;
        }
        if let MediumExtinction::Several(volumes) = &self.extinction {
            return volumes.emissivity_at(position);
        }
        let flame = self.flame_at(position);
        match self.heat_at(position) {
            Rgb::ZERO => flame,
            heat => flame + heat * self.extinction.sigma_t(position),
        }
    }

    /// Radiance of heat per sigma_t at a place inside the bounds: what a blackbody has, times 1 - albedo \[W/(m^2 sr)\].
    pub fn heat_at(&self, position: DVec3) -> Rgb {
        if let MediumExtinction::Several(volumes) = &self.extinction {
            return volumes.heat_at(position);
        }
        let Some(emissivity) = &self.emissivity else { return Rgb::ZERO };
        match emissivity.blackbody(position) {
            Rgb::ZERO => Rgb::ZERO,
            blackbody => blackbody * (Rgb::ONE - self.albedo_at(position)),
        }
    }

    /// Emissivity of flames at a place inside the bounds \[W/(m^3 sr)\].
    pub fn flame_at(&self, position: DVec3) -> Rgb {
        match (&self.extinction, &self.emissivity) {
            (MediumExtinction::Several(volumes), _) => volumes.flame_at(position),
            (_, Some(emissivity)) => emissivity.flame(position),
            (_, None) => Rgb::ZERO,
        }
    }

    /// Where scattered light goes; `None` if volumes scatter differently.
    pub fn shared_phase(&self) -> Option<Phase> {
        match &self.extinction {
            MediumExtinction::Several(volumes) => volumes.shared_phase(),
            _ => Some(self.phase),
        }
    }

    /// Whether it scatters all ways alike.
    pub fn is_isotropic(&self) -> bool {
        match &self.extinction {
            MediumExtinction::Several(volumes) => volumes.media().iter().all(Self::is_isotropic),
            _ => self.phase.is_isotropic(),
        }
    }

    /// Whether it attenuates, scatters and emits the same in all channels.
    pub fn is_grey(&self) -> bool {
        match &self.extinction {
            MediumExtinction::Several(volumes) => volumes.media().iter().all(Self::is_grey),
            extinction => {
                self.albedo == Rgb::splat(self.albedo.x)
                    && self.color.is_none()
                    && self.emissivity.is_none()
                    && !matches!(extinction, MediumExtinction::Chromatic(_))
            }
        }
    }

    /// The albedo at a place: the medium's own times its colour there, each channel at most 1. Of several volumes only
    /// [`Extinction::albedo_at`] knows it.
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
    /// The sum of several volumes.
    Several(Box<Volumes>),
}

impl MediumExtinction {
    /// sigma_t at a place, whatever the kind \[1/m\].
    pub fn sigma_t(&self, position: DVec3) -> Rgb {
        match self {
            Self::Uniform(uniform) => uniform.sigma_t(position),
            Self::Chromatic(chromatic) => chromatic.sigma_t(position),
            Self::Grid(grid) => grid.sigma_t(position),
            Self::Several(volumes) => volumes.sigma_t(position),
        }
    }
}

/// How strongly a medium attenuates light along rays. `Span`s passed in lie inside the medium's bounds.
pub trait Extinction: Sync {
    /// How light is scattered at a place.
    type Scattering: Scattering;

    /// Whether sigma_t is the same at every place of the bounds: then no photon needs its own.
    const IS_UNIFORM: bool;

    /// Whether it differs between channels: then photons change colour as they fly.
    const IS_CHROMATIC: bool = false;

    /// The shortest edge of a grid's voxels \[m\]; `None` of media without.
    fn voxel_size(&self) -> Option<f64> {
        None
    }

    /// sigma_t at a point \[1/m\]; 0 outside a grid's bounds. A uniform extinction does not look at the point.
    fn sigma_t(&self, position: DVec3) -> Rgb;

    /// sigma_s / sigma_t at a place of `medium`, whose extinction this is.
    #[inline]
    fn albedo_at(&self, medium: &Medium, position: DVec3) -> Rgb {
        medium.albedo_at(position)
    }

    /// Where light scattered at a place of `medium` goes.
    fn scattering_at(&self, medium: &Medium, position: DVec3) -> Self::Scattering;

    /// The medium that a collision at a place of `medium` is with: itself, or one of its volumes, by chance.
    #[inline]
    fn struck<'a>(
        &'a self,
        medium: &'a Medium,
        _position: DVec3,
        _random: &mut Random,
    ) -> &'a Medium {
        medium
    }

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
    /// The flight through a grey medium, inverted in the profile of its way.
    fn flight_along(self, profile: &RayProfile) -> BoostedFlight {
        let opacity = -(-profile.total_depth()).exp_m1();
        self.flight(opacity, |quantile| profile.flight_at(-(-quantile).ln_1p()))
    }

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
