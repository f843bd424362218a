//! Transmittance from a place in the medium to a light.
//!
//! By the exact optical depth along the way; or, for parallel light in a grid, from *columns*: the optical depth along rays from the light
//! one voxel apart, kept at steps of a voxel (a deep shadow map: Lokovic and Veach, SIGGRAPH 2000), trilinear between. One
//! walk through the grid then serves all places of its column. How far columns are off is measured where the
//! medium is, and where it is too much, or they would be too many, every place has a walk of its own.

use rayon::prelude::*;

use super::Light;
use crate::math::{DAffine3, DMat3, DVec3, Frame, Random, Ray, Rgb, Span, Stream, uniform};
use crate::medium::{Extinction, Medium, RayProfile};

/// Most nodes of all columns of a light: 256 MiB.
const MAX_NODES: usize = 1 << 26;

/// Places in the medium where columns are held against exact walks.
const PROBES: usize = 512;

/// The largest error of columns at a place: root mean square over that of the transmittance, both weighted by sigma_t. Along a ray
/// errors of either sign add up to a fraction of it.
const MAX_ERROR: f64 = 0.03;

/// Shadows of a scene's lights.
#[derive(Debug)]
pub struct Shadows {
    /// For each light, where it has them.
    columns: Vec<Option<ShadowColumns>>,
}

impl Shadows {
    /// Columns, at most so many a light, for the lights for which they serve.
    pub fn of<E: Extinction>(
        lights: &[Light],
        medium: &Medium,
        extinction: &E,
        most_columns: usize,
    ) -> Self {
        let columns = |light: &Light| match light {
            Light::Directional(light) => {
                ShadowColumns::new(medium, extinction, light.direction, most_columns)
            }
            _ => None,
        };
        Self { columns: lights.iter().map(columns).collect() }
    }

    /// Transmittance to light `index` if it has columns.
    #[inline]
    pub fn transmittance(&self, index: usize, place: DVec3) -> Option<Rgb> {
        let columns = self.columns.get(index)?.as_ref()?;
        Some(Rgb::splat(f64::from(-columns.optical_depth(place)).exp()))
    }
}

/// Optical depths towards one parallel light.
#[derive(Debug)]
struct ShadowColumns {
    /// From world space: x and y count columns, z nodes along them.
    to_nodes: DAffine3,
    counts: [usize; 3],
    /// Optical depth from the light, z fastest.
    depths: Vec<f32>,
}

impl ShadowColumns {
    /// The columns of light that travels in `direction`; `None` where exact walks are cheaper or the columns too coarse.
    fn new<E: Extinction>(
        medium: &Medium,
        extinction: &E,
        direction: DVec3,
        most_columns: usize,
    ) -> Option<Self> {
        let columns = Self::placed(medium, extinction.voxel_size()?, direction)?;
        let [width, height, length] = columns.counts;
        let fits = width.saturating_mul(height) <= most_columns
            && width.saturating_mul(height).saturating_mul(length) <= MAX_NODES;
        let filled = fits.then(|| columns.filled(medium, extinction))?;
        (filled.error(medium, extinction) <= MAX_ERROR).then_some(filled)
    }

    /// Empty columns about the bounds.
    fn placed(medium: &Medium, voxel_size: f64, direction: DVec3) -> Option<Self> {
        let shape = medium.bounds.parallelepiped()?;
        let frame = Frame::about(direction);
        let axes = DMat3::from_cols(
            frame.to_world(DVec3::X),
            frame.to_world(DVec3::Y),
            frame.to_world(DVec3::Z),
        );
        let edges = shape.edges();
        let corner = |index: usize| {
            let along = |axis: usize| edges[axis] * (index >> axis & 1) as f64;
            axes.transpose() * (shape.corner() + along(0) + along(1) + along(2))
        };
        let low = (0..8).map(corner).fold(DVec3::INFINITY, DVec3::min);
        let high = (0..8).map(corner).fold(DVec3::NEG_INFINITY, DVec3::max);
        let steps = ((high - low) / voxel_size).ceil().max(DVec3::ONE);
        let to_world = DAffine3 {
            matrix3: axes * DMat3::from_diagonal((high - low) / steps),
            translation: axes * low,
        };
        let to_nodes = to_world.inverse();
        let counts = steps.to_array().map(|count| count as usize + 1);
        to_nodes.is_finite().then_some(Self { to_nodes, counts, depths: Vec::new() })
    }

    fn filled<E: Extinction>(mut self, medium: &Medium, extinction: &E) -> Self {
        let [width, height, length] = self.counts;
        let to_world = self.to_nodes.inverse();
        let axis = to_world.matrix3.z_axis;
        let (step, direction) = (axis.length(), axis.normalize());
        let mut depths = vec![0.0f32; width * height * length];
        depths.par_chunks_mut(length).enumerate().for_each_init(
            RayProfile::default,
            |profile, (column, depths)| {
                let node = DVec3::new((column / height) as f64, (column % height) as f64, 0.0);
                let ray = Ray::new(to_world.transform_point3(node), direction);
                let Some(span) = medium.bounds.intersect(&ray) else { return };
                extinction.profile(&ray, span, profile);
                for (node, depth) in depths.iter_mut().enumerate() {
                    let distance = (node as f64 * step).clamp(span.start, span.end);
                    *depth = profile.optical_depth(distance).x as f32;
                }
            },
        );
        self.depths = depths;
        self
    }

    /// Trilinear between nodes.
    #[inline]
    fn optical_depth(&self, place: DVec3) -> f32 {
        let [width, height, length] = self.counts;
        let node = self.to_nodes.transform_point3(place).as_vec3();
        let place = |at: f32, count: usize| {
            let low = (at as usize).min(count - 2);
            (low, (at - low as f32).clamp(0.0, 1.0))
        };
        let ((i, u), (j, v), (k, w)) =
            (place(node.x, width), place(node.y, height), place(node.z, length));
        let along = |i: usize, j: usize| {
            let first = (i * height + j) * length + k;
            match self.depths.get(first..first + 2) {
                Some(&[low, high]) => low + (high - low) * w,
                _ => 0.0,
            }
        };
        let across = |i: usize| along(i, j) + (along(i, j + 1) - along(i, j)) * v;
        across(i) + (across(i + 1) - across(i)) * u
    }

    /// Root mean square of the error of transmittance over that of transmittance, at random places, weighted by sigma_t.
    fn error<E: Extinction>(&self, medium: &Medium, extinction: &E) -> f64 {
        let mut random = Stream::Guide.random(1, 0);
        let to_world = self.to_nodes.inverse();
        let direction = to_world.matrix3.z_axis.normalize();
        let (mut errors, mut squares) = (0.0, 0.0);
        for _ in 0..PROBES {
            let place = to_world.transform_point3(random_node(self.counts, &mut random));
            let sigma_t = extinction.sigma_t(place).x;
            if sigma_t > 0.0 && medium.bounds.contains(place) {
                let exact = transmittance_to(medium, extinction, place, -direction, f64::INFINITY);
                let found = f64::from(-self.optical_depth(place)).exp();
                errors += sigma_t * (found - exact.x).powi(2);
                squares += sigma_t * exact.x * exact.x;
            }
        }
        if squares > 0.0 { (errors / squares).sqrt() } else { 0.0 }
    }
}

/// A random place among nodes.
fn random_node(counts: [usize; 3], random: &mut Random) -> DVec3 {
    DVec3::from_array(counts.map(|count| (count - 1) as f64 * uniform(random)))
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    /// Columns of a cloud hold what exact walks find, to what they measure of themselves; and where they are to be fewer than it takes, there
    /// are none.
    #[test]
    fn columns_hold_the_optical_depth() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let scene = Scene::load(&root.join("tests/scenes/smoke_sun.toml")).unwrap();
        let crate::medium::MediumExtinction::Grid(grid) = &scene.medium.extinction else {
            panic!("a grid");
        };
        let shadows = Shadows::of(&scene.lights, &scene.medium, &**grid, 1 << 16);
        let Light::Directional(sun) = &scene.lights[0] else { panic!("a sun") };
        let mut random = Stream::Experiment.random(5, 0);
        let shape = scene.medium.bounds.parallelepiped().unwrap();
        let (mut error, mut mean, mut count) = (0.0, 0.0, 0.0);
        for _ in 0..4000 {
            let [u, v, w]: [f64; 3] = std::array::from_fn(|_| uniform(&mut random));
            let [a, b, c] = shape.edges();
            let place = shape.corner() + a * u + b * v + c * w;
            let far = f64::INFINITY;
            let exact = transmittance_to(&scene.medium, &**grid, place, -sun.direction, far).x;
            let found = shadows.transmittance(0, place).unwrap().x;
            assert!((found - exact).abs() < 0.2, "{place}: {found} {exact}");
            error += found - exact;
            mean += exact;
            count += 1.0;
        }
        // What is left of errors of either sign.
        assert!((error / mean).abs() < 2e-3, "{} of {}", error / count, mean / count);
        assert!(shadows.transmittance(1, DVec3::ZERO).is_none());
        let few = Shadows::of(&scene.lights, &scene.medium, &**grid, 100);
        assert!(few.transmittance(0, DVec3::ZERO).is_none());
    }
}
