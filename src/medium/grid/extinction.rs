//! A density grid placed in the world.

use std::ops::ControlFlow;

use super::{DensityGrid, block_walk::LocalRay};
use crate::{
    math::{Ball, DAffine3, DMat3, DVec3, Random, Ray, Rgb, Span},
    medium::{
        BallMoments, BoostedFlight, BoostedQuantile, Bounds, Extinction, Flight, Parallelepiped,
        ProfileKnot, RayProfile,
    },
};

/// Optical depth at which a ray counts as opaque: a transmittance of 2e-28, far below the rounding of 1.
const OPAQUE_DEPTH: f64 = 64.0;

/// Extinction of a density grid in world space, the same in all channels.
#[derive(Debug)]
pub struct GridExtinction {
    grid: DensityGrid,
    density_scale: f64,
    /// `None` where there is no extinction.
    placement: Option<Placement>,
}

/// The map from world to the grid's local coordinates, taken about the grid's centre so that a grid far from
/// the world's origin, or of tiny voxels, keeps its digits.
#[derive(Debug)]
pub(super) struct Placement {
    pub(super) bounds: Parallelepiped,
    world_center: DVec3,
    local_center: DVec3,
    world_to_local: DMat3,
}

impl GridExtinction {
    /// Places a grid. `index_to_world` is the file's transform followed by the scene's; sigma_t is
    /// `density_scale` \[1/m\] times the density.
    ///
    /// There is no extinction if the transform has no inverse, or the scale is not above 0. A scale that would
    /// make the largest sigma_t infinite is lowered.
    pub fn new(grid: DensityGrid, index_to_world: DAffine3, density_scale: f64) -> Self {
        let max_density = f64::from(grid.statistics().max_density);
        // NaN becomes 0.
        let density_scale = density_scale.max(0.0).min(f64::MAX / max_density.max(1.0));
        let placement = match density_scale > 0.0 && !grid.is_empty() {
            true => Placement::new(&grid, &index_to_world),
            false => None,
        };
        Self { grid, density_scale, placement }
    }

    /// Where the extinction is: the render bounds in world space, `None` if there is none.
    pub fn bounds(&self) -> Option<Bounds> {
        self.placement.as_ref().map(|placement| Bounds::Parallelepiped(placement.bounds))
    }

    /// The largest sigma_t \[1/m\].
    pub fn max_sigma_t(&self) -> f64 {
        match self.placement {
            Some(_) => f64::from(self.grid.statistics().max_density) * self.density_scale,
            None => 0.0,
        }
    }

    /// sigma_t per density \[1/m\].
    pub fn density_scale(&self) -> f64 {
        self.density_scale
    }

    /// The densities.
    pub fn grid(&self) -> &DensityGrid {
        &self.grid
    }

    /// The distance at which the optical depth from the span's start reaches `optical_depth`; `None` if it
    /// does not within the span.
    pub fn distance_at(&self, ray: &Ray, span: Span, optical_depth: f64) -> Option<f64> {
        let local = self.placement.as_ref()?.local_ray(ray);
        self.grid.distance_at_depth(&local, span, optical_depth / self.density_scale)
    }
}

impl Placement {
    pub(super) fn new(grid: &DensityGrid, index_to_world: &DAffine3) -> Option<Self> {
        let (min, max) = grid.render_bounds()?;
        let linear = index_to_world.matrix3;
        let world_to_local = linear.inverse();
        let index_center = 0.5 * (min + max);
        let world_center = index_to_world.transform_point3(index_center);
        if !world_to_local.is_finite() || !world_center.is_finite() {
            return None;
        }
        let extent = max - min;
        let edges = [linear.x_axis * extent.x, linear.y_axis * extent.y, linear.z_axis * extent.z];
        let corner = index_to_world.transform_point3(min);
        Some(Self {
            bounds: Parallelepiped::new(corner, edges),
            world_center,
            local_center: index_center - grid.local_origin(),
            world_to_local,
        })
    }

    #[inline]
    pub(super) fn local_point(&self, position: DVec3) -> DVec3 {
        self.local_center + self.world_to_local * (position - self.world_center)
    }

    #[inline]
    fn local_ray(&self, ray: &Ray) -> LocalRay {
        let origin = self.local_point(ray.origin).to_array();
        LocalRay::new(origin, (self.world_to_local * ray.direction).to_array())
    }
}

impl Extinction for GridExtinction {
    const IS_UNIFORM: bool = false;

    fn sigma_t(&self, position: DVec3) -> Rgb {
        match &self.placement {
            Some(placement) => {
                let point = placement.local_point(position).to_array();
                Rgb::splat(self.density_scale * self.grid.local_density(point))
            }
            None => Rgb::ZERO,
        }
    }

    fn optical_depth(&self, ray: &Ray, span: Span) -> Rgb {
        match &self.placement {
            Some(placement) => {
                let depth = self.grid.depth(&placement.local_ray(ray), span);
                Rgb::splat(self.density_scale * depth)
            }
            None => Rgb::ZERO,
        }
    }

    fn transmittance(&self, ray: &Ray, span: Span) -> Rgb {
        let Some(placement) = &self.placement else { return Rgb::ONE };
        let limit = OPAQUE_DEPTH / self.density_scale;
        let mut depth = 0.0;
        self.grid.for_each_cell(&placement.local_ray(ray), span, |piece| {
            depth += piece.depth();
            if depth < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        Rgb::splat((-self.density_scale * depth).exp())
    }

    fn estimate_transmittance(&self, ray: &Ray, span: Span, random: &mut Random) -> Rgb {
        let Some(placement) = &self.placement else { return Rgb::ONE };
        let local = placement.local_ray(ray);
        Rgb::splat(self.grid.estimate_transmittance(&local, span, self.density_scale, random))
    }

    fn sample_flight(&self, ray: &Ray, span: Span, _: Rgb, random: &mut Random) -> Flight {
        flight_to(self.placement.as_ref().and_then(|placement| {
            let local = placement.local_ray(ray);
            self.grid.sample_collision(&local, span, self.density_scale, random)
        }))
    }

    fn invert_flight(&self, ray: &Ray, span: Span, _: Rgb, u: f64) -> Flight {
        flight_to(self.distance_at(ray, span, -(-u).ln_1p()))
    }

    /// One walk along the ray serves the opacity and the inversion.
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
        let opacity = -(-profile.optical_depth(span.end).x).exp_m1();
        boosted.flight(opacity, |quantile| {
            let distance = profile.distance_at(-(-quantile).ln_1p(), 0);
            flight_to((distance < span.end).then_some(distance))
        })
    }

    fn profile(&self, ray: &Ray, span: Span, profile: &mut RayProfile) {
        profile.begin(span);
        let Some(placement) = &self.placement else { return };
        let limit = OPAQUE_DEPTH / self.density_scale;
        let mut depth = 0.0;
        self.grid.for_each_cell(&placement.local_ray(ray), span, |piece| {
            depth += piece.depth();
            profile.push(ProfileKnot {
                distance: piece.span.end,
                optical_depth: self.density_scale * depth,
                sigma_t: piece.density.values().map(|density| self.density_scale * density),
            });
            if depth < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
    }

    fn ball_moments(
        &self,
        _: &Bounds,
        ball: Ball,
        ceiling: f64,
        turn: f64,
        falloff: f64,
    ) -> BallMoments {
        let Some(placement) = &self.placement else { return BallMoments::even(0.0) };
        let center = placement.local_point(ball.center);
        let to_local = placement.world_to_local * ball.radius;
        let scale = self.density_scale / ceiling;
        BallMoments::by_points(ball, turn, 1, |place| {
            let density = self.grid.local_density((center + to_local * place).to_array());
            (scale * density).min(1.0) * (1.0 - falloff * place.length_squared())
        })
    }
}

/// The flight that ends at a collision, if there was one.
fn flight_to(collision: Option<f64>) -> Flight {
    match collision {
        Some(distance) => Flight::Collision { distance, weight: Rgb::ONE },
        None => Flight::Escape { weight: Rgb::ONE },
    }
}
