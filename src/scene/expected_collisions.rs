//! How many collisions a photon is expected to have, to the order of magnitude: enough to say before a render
//! whether its photons fit into memory.

use super::Scene;
use crate::math::{DVec3, Ray, Span, max_channel};
use crate::medium::{Bounds, Extinction, GridExtinction, MediumExtinction, Parallelepiped};

/// Rays through a grid from each of three sides, along either axis of the side.
const RAYS_PER_AXIS: usize = 8;

/// Collisions of a photon that enters the medium: with probability p of colliding on a flight and albedo a,
/// p + p (a p) + p (a p)^2 + ... up to the largest order followed.
pub(super) fn expected_collisions(scene: &Scene) -> f64 {
    let collides = collision_probability(scene);
    let goes_on = collides * max_channel(scene.medium.albedo);
    let orders = f64::from(scene.photons.max_order);
    let geometric = (1.0 - goes_on.powf(orders)) / (1.0 - goes_on);
    collides * if goes_on < 1.0 { geometric } else { orders }
}

/// Of a flight through the medium: over the mean chord if it is homogeneous, over rays through a grid.
fn collision_probability(scene: &Scene) -> f64 {
    let bounds = &scene.medium.bounds;
    let over_chord = |sigma_t: f64| match sigma_t > 0.0 {
        true => 1.0 - (-sigma_t * mean_chord(bounds)).exp(),
        false => 0.0,
    };
    match (&scene.medium.extinction, bounds) {
        (MediumExtinction::Uniform(uniform), _) => over_chord(uniform.sigma_t),
        (MediumExtinction::Chromatic(chromatic), _) => over_chord(max_channel(chromatic.sigma_t)),
        (MediumExtinction::Grid(grid), Bounds::Parallelepiped(shape)) => through_grid(grid, shape),
        (MediumExtinction::Grid(grid), _) => over_chord(grid.max_sigma_t()),
    }
}

/// The mean of 1 - transmittance over rays parallel to the edges.
fn through_grid(grid: &GridExtinction, shape: &Parallelepiped) -> f64 {
    let cells = || (0..RAYS_PER_AXIS).map(|cell| (cell as f64 + 0.5) / RAYS_PER_AXIS as f64);
    let mut sum = 0.0;
    for axis in 0..3 {
        let [along, u, v] = [0, 1, 2].map(|turn| shape.edges[(axis + turn) % 3]);
        for (a, b) in cells().flat_map(|a| cells().map(move |b| (a, b))) {
            let ray = Ray::new(shape.corner + a * u + b * v, along.normalize());
            let optical_depth = grid.optical_depth(&ray, Span::new(0.0, along.length()));
            sum += 1.0 - (-max_channel(optical_depth)).exp();
        }
    }
    sum / (3 * RAYS_PER_AXIS * RAYS_PER_AXIS) as f64
}

/// 4 V / S (Cauchy) \[m\].
fn mean_chord(bounds: &Bounds) -> f64 {
    match *bounds {
        Bounds::Box { min, max } => {
            let size = max - min;
            mean_chord_of_edges([size.x * DVec3::X, size.y * DVec3::Y, size.z * DVec3::Z])
        }
        Bounds::Sphere { radius, .. } => 4.0 / 3.0 * radius,
        Bounds::Parallelepiped(shape) => mean_chord_of_edges(shape.edges),
        Bounds::Infinite => f64::INFINITY,
    }
}

fn mean_chord_of_edges([u, v, w]: [DVec3; 3]) -> f64 {
    let faces = u.cross(v).length() + v.cross(w).length() + w.cross(u).length();
    2.0 * u.cross(v).dot(w).abs() / faces
}
