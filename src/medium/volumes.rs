//! Several volumes in one space, which may overlap.
//!
//! Where they do, sigma_t adds up, transmittances multiply, and each collision is with one of them: volume i with the
//! probability sigma_t,i / sum sigma_t, so that albedo and phase function are those of that volume and emissivities add up too.
//! Free flights need no common majorant: the first collision with any volume is the nearest of the first collisions with
//! each, drawn independently (superposition of Poisson processes), each by the volume's own method. A later volume is
//! only followed up to the nearest collision so far.

use super::{
    BallMoments, BoostedFlight, BoostedQuantile, Bounds, Extinction, Flight, Medium,
    MediumExtinction, Phase, PhaseMixture, RayProfile,
};
use crate::math::{Ball, DVec3, Random, Ray, Rgb, Span, uniform};

/// At least two media of grey extinction, each in its own bounds.
#[derive(Debug)]
pub struct Volumes {
    media: Vec<Medium>,
    /// The place of each among the media as they were given.
    numbers: Vec<usize>,
    /// Where all their scattered light goes, if it goes the same ways.
    shared_phase: Option<Phase>,
}

/// Why media cannot be volumes of one space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VolumesError {
    /// No medium at all.
    #[error("there is no medium")]
    None,
    /// sigma_t differs between channels.
    #[error("medium {0}: one of several media must have the same sigma_t in all channels")]
    Chromatic(usize),
    /// A medium without bounds.
    #[error("medium {0}: one of several media must have bounds")]
    Infinite(usize),
}

/// The extinction of a medium, of whatever kind.
macro_rules! with_extinction {
    ($medium:expr, $extinction:ident => $result:expr) => {
        match &$medium.extinction {
            MediumExtinction::Uniform($extinction) => $result,
            MediumExtinction::Chromatic($extinction) => $result,
            MediumExtinction::Grid(boxed) => {
                let $extinction = &**boxed;
                $result
            }
            MediumExtinction::Several(boxed) => {
                let $extinction = &**boxed;
                $result
            }
        }
    };
}

impl Volumes {
    /// Checks that media can share a space. The order does not matter.
    ///
    /// # Errors
    /// [`VolumesError`], with the number of the medium.
    pub(super) fn new(media: Vec<Medium>) -> Result<Self, VolumesError> {
        for (number, medium) in media.iter().enumerate() {
            if matches!(medium.extinction, MediumExtinction::Chromatic(_)) {
                return Err(VolumesError::Chromatic(number));
            }
            if matches!(medium.bounds, Bounds::Infinite) {
                return Err(VolumesError::Infinite(number));
            }
        }
        let first = media.first().ok_or(VolumesError::None)?.phase;
        let is_shared = media.iter().all(|medium| medium.phase == first);
        let mut numbered: Vec<(usize, Medium)> = media.into_iter().enumerate().collect();
        // What is cheap to fly through shortens the way through grids.
        numbered.sort_by_key(|(_, medium)| matches!(medium.extinction, MediumExtinction::Grid(_)));
        let (numbers, media) = numbered.into_iter().unzip();
        Ok(Self { media, numbers, shared_phase: is_shared.then_some(first) })
    }

    /// The medium that was given as number `number`, from 0.
    pub fn given(&self, number: usize) -> Option<&Medium> {
        let place = self.numbers.iter().position(|own| *own == number)?;
        self.media.get(place)
    }

    /// The volumes, uniform ones first.
    pub fn media(&self) -> &[Medium] {
        &self.media
    }

    /// Where light scattered by any of them goes; `None` if that depends on the volume.
    pub fn shared_phase(&self) -> Option<Phase> {
        self.shared_phase
    }

    /// The smallest axis-aligned box that holds all of them.
    pub(super) fn bounds(&self) -> Bounds {
        let corners = self.media.iter().filter_map(|medium| medium.bounds.extent());
        let all = corners.reduce(|(min, max), (low, high)| (min.min(low), max.max(high)));
        all.map_or(Bounds::Infinite, |(min, max)| Bounds::Box { min, max })
    }

    /// Emissivity at a place \[W/(m^3 sr)\].
    pub(super) fn emissivity_at(&self, position: DVec3) -> Rgb {
        self.media.iter().map(|medium| medium.emissivity_at(position)).sum()
    }

    /// Radiance of heat per sigma_t of all volumes \[W/(m^2 sr)\].
    pub(super) fn heat_at(&self, position: DVec3) -> Rgb {
        self.per_sigma_t(position, |medium| medium.heat_at(position))
    }

    /// Emissivity of flames \[W/(m^3 sr)\].
    pub(super) fn flame_at(&self, position: DVec3) -> Rgb {
        self.about(position).map(|medium| medium.flame_at(position)).sum()
    }

    /// The volumes that hold a place.
    fn about(&self, position: DVec3) -> impl Iterator<Item = &Medium> {
        self.media.iter().filter(move |medium| medium.bounds.contains(position))
    }

    /// The volumes along a ray, each with its part of the span.
    fn along(&self, ray: &Ray, span: Span) -> impl Iterator<Item = (&Medium, Span)> {
        self.media.iter().filter_map(move |medium| {
            let inside = medium.bounds.intersect(ray)?.intersect(span)?;
            Some((medium, inside))
        })
    }

    /// The mean of a property of the volumes about a place, weighed by sigma_t; 0 where there is none.
    fn per_sigma_t(&self, position: DVec3, property: impl Fn(&Medium) -> Rgb) -> Rgb {
        let (mut sum, mut total) = (Rgb::ZERO, 0.0);
        for medium in self.about(position) {
            let sigma_t = sigma_t_inside(medium, position);
            if sigma_t > 0.0 {
                sum += property(medium) * sigma_t;
                total += sigma_t;
            }
        }
        if total > 0.0 { sum / total } else { Rgb::ZERO }
    }
}

/// sigma_t of a grey medium at a place inside its bounds \[1/m\].
fn sigma_t_inside(medium: &Medium, position: DVec3) -> f64 {
    medium.extinction.sigma_t(position).x
}

impl Extinction for Volumes {
    type Scattering = PhaseMixture;

    const IS_UNIFORM: bool = false;

    fn sigma_t(&self, position: DVec3) -> Rgb {
        Rgb::splat(self.about(position).map(|medium| sigma_t_inside(medium, position)).sum())
    }

    fn albedo_at(&self, _: &Medium, position: DVec3) -> Rgb {
        self.per_sigma_t(position, |medium| medium.albedo_at(position))
    }

    fn scattering_at(&self, _: &Medium, position: DVec3) -> PhaseMixture {
        if let Some(phase) = self.shared_phase {
            return PhaseMixture::Same(phase);
        }
        let parts = self.about(position).map(|medium| {
            let sigma_t = sigma_t_inside(medium, position);
            (medium.phase, medium.albedo_at(position) * sigma_t)
        });
        PhaseMixture::new(parts, Phase::Isotropic)
    }

    fn struck<'a>(&'a self, whole: &'a Medium, position: DVec3, random: &mut Random) -> &'a Medium {
        let total = self.sigma_t(position).x;
        let mut left = uniform(random) * total;
        let mut struck = None;
        for medium in self.about(position) {
            let sigma_t = sigma_t_inside(medium, position);
            if sigma_t > 0.0 {
                struck = Some(medium);
                left -= sigma_t;
                if left < 0.0 {
                    break;
                }
            }
        }
        // Only rounding at a face finds none.
        struck.or(self.media.first()).unwrap_or(whole)
    }

    fn optical_depth(&self, ray: &Ray, span: Span) -> Rgb {
        let depth = |(medium, inside): (&Medium, Span)| with_extinction!(medium, extinction => extinction.optical_depth(ray, inside));
        self.along(ray, span).map(depth).sum()
    }

    fn transmittance(&self, ray: &Ray, span: Span) -> Rgb {
        self.along(ray, span).fold(Rgb::ONE, |transmittance, (medium, inside)| {
            match transmittance {
                Rgb::ZERO => Rgb::ZERO,
                _ => with_extinction!(medium, extinction => transmittance * extinction.transmittance(ray, inside)),
            }
        })
    }

    fn estimate_transmittance(&self, ray: &Ray, span: Span, random: &mut Random) -> Rgb {
        self.along(ray, span).fold(
            Rgb::ONE,
            |transmittance, (medium, inside)| match transmittance {
                Rgb::ZERO => Rgb::ZERO,
                _ => with_extinction!(medium, extinction => {
                    transmittance * extinction.estimate_transmittance(ray, inside, random)
                }),
            },
        )
    }

    fn sample_flight(&self, ray: &Ray, span: Span, power: Rgb, random: &mut Random) -> Flight {
        let mut left = span;
        let mut nearest = Flight::Escape { weight: Rgb::ONE };
        for (medium, inside) in self.along(ray, span) {
            let Some(inside) = inside.intersect(left) else { continue };
            let flight = with_extinction!(medium, extinction => {
                extinction.sample_flight(ray, inside, power, random)
            });
            if let Flight::Collision { distance, .. } = flight {
                left.end = distance;
                nearest = flight;
            }
        }
        nearest
    }

    fn invert_flight(&self, ray: &Ray, span: Span, _: Rgb, u: f64) -> Flight {
        let mut profile = RayProfile::default();
        self.profile(ray, span, &mut profile);
        profile.flight_at(-(-u).ln_1p())
    }

    fn boosted_flight(
        &self,
        ray: &Ray,
        span: Span,
        _: Rgb,
        boosted: BoostedQuantile,
        profile: &mut RayProfile,
        is_known: bool,
    ) -> BoostedFlight {
        if !is_known {
            self.profile(ray, span, profile);
        }
        boosted.flight_along(profile)
    }

    fn profile(&self, ray: &Ray, span: Span, profile: &mut RayProfile) {
        let of_volume = |(medium, inside): (&Medium, Span)| {
            let mut part = RayProfile::default();
            with_extinction!(medium, extinction => extinction.profile(ray, inside, &mut part));
            part
        };
        let parts: Vec<RayProfile> = self.along(ray, span).map(of_volume).collect();
        profile.set_sum(span, &parts);
    }

    fn ball_moments(
        &self,
        _: &Bounds,
        ball: Ball,
        ceiling: f64,
        turn: f64,
        falloff: f64,
    ) -> BallMoments {
        BallMoments::by_points(ball, turn, 1, |place| {
            let sigma_t = self.sigma_t(ball.center + place * ball.radius).x;
            (sigma_t / ceiling).min(1.0) * (1.0 - falloff * place.length_squared())
        })
    }
}
