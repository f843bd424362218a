//! How many collisions a photon is expected to have, to the order of magnitude: enough to say before a render
//! whether its photons fit into memory.
//!
//! A photon that enters collides with probability 1 - exp(-tau) over a chord of optical depth tau, and one that
//! starts inside with 1 - 1/(1 + tau) (Wigner's rational approximation for convex bodies).

use super::Scene;
use crate::math::{DVec3, Ray, Span, max_channel};
use crate::medium::{Bounds, Extinction, MediumExtinction, Parallelepiped};

/// Rays through a grid from each of three sides, along either axis of the side.
const RAYS_PER_AXIS: usize = 8;

/// Collisions of a photon that enters the medium: the first, and after each, with albedo a, another with
/// probability a p, up to the largest order followed.
pub(super) fn expected_collisions(scene: &Scene) -> f64 {
    let chords = Chords::of(scene);
    let again = max_channel(scene.medium.max_albedo()) * (1.0 - 1.0 / (1.0 + chords.optical_depth));
    let orders = f64::from(scene.photons.max_order);
    let geometric = (1.0 - again.powf(orders)) / (1.0 - again);
    // Photons of the medium's own start inside, and are made to collide.
    let first = if scene.medium.emissivity.is_some() { 1.0 } else { chords.first_collision };
    first * if again < 1.0 { geometric } else { orders }
}

/// Straight ways through a medium.
struct Chords {
    /// Probability of colliding on one of them.
    first_collision: f64,
    /// Mean optical depth of those on which a photon collides.
    optical_depth: f64,
}

impl Chords {
    fn of(scene: &Scene) -> Self {
        let bounds = &scene.medium.bounds;
        match (&scene.medium.extinction, bounds) {
            (MediumExtinction::Uniform(uniform), _) => Self::mean(bounds, uniform.sigma_t),
            (MediumExtinction::Chromatic(chromatic), _) => {
                Self::mean(bounds, max_channel(chromatic.sigma_t))
            }
            (MediumExtinction::Grid(grid), Bounds::Parallelepiped(shape)) => {
                Self::through(&**grid, shape)
            }
            (MediumExtinction::Several(volumes), bounds) => match bounds.parallelepiped() {
                Some(shape) => Self::through(&**volumes, &shape),
                None => Self::mean(bounds, 0.0),
            },
            (MediumExtinction::Grid(grid), _) => Self::mean(bounds, grid.max_sigma_t()),
        }
    }

    /// The mean chord stands for all.
    fn mean(bounds: &Bounds, sigma_t: f64) -> Self {
        let optical_depth = if sigma_t > 0.0 { sigma_t * mean_chord(bounds) } else { 0.0 };
        Self { first_collision: 1.0 - (-optical_depth).exp(), optical_depth }
    }

    /// Rays parallel to the edges of a box about what varies.
    fn through(extinction: &impl Extinction, shape: &Parallelepiped) -> Self {
        let centers = || (0..RAYS_PER_AXIS).map(|cell| (cell as f64 + 0.5) / RAYS_PER_AXIS as f64);
        let (mut collisions, mut depths) = (0.0, 0.0);
        for axis in 0..3 {
            let [along, u, v] = [0, 1, 2].map(|turn| shape.edges()[(axis + turn) % 3]);
            for (a, b) in centers().flat_map(|a| centers().map(move |b| (a, b))) {
                let ray = Ray::new(shape.corner() + a * u + b * v, along.normalize());
                let depth =
                    max_channel(extinction.optical_depth(&ray, Span::new(0.0, along.length())));
                let collides = 1.0 - (-depth).exp();
                collisions += collides;
                depths += collides * depth;
            }
        }
        Self {
            first_collision: collisions / (3 * RAYS_PER_AXIS * RAYS_PER_AXIS) as f64,
            optical_depth: if collisions > 0.0 { depths / collisions } else { 0.0 },
        }
    }
}

/// 4 V / S (Cauchy) \[m\].
fn mean_chord(bounds: &Bounds) -> f64 {
    match *bounds {
        Bounds::Box { min, max } => {
            let size = max - min;
            mean_chord_of_edges([size.x * DVec3::X, size.y * DVec3::Y, size.z * DVec3::Z])
        }
        Bounds::Sphere { radius, .. } => 4.0 / 3.0 * radius,
        Bounds::Parallelepiped(shape) => mean_chord_of_edges(shape.edges()),
        Bounds::Infinite => f64::INFINITY,
    }
}

fn mean_chord_of_edges([u, v, w]: [DVec3; 3]) -> f64 {
    let faces = u.cross(v).length() + v.cross(w).length() + w.cross(u).length();
    2.0 * u.cross(v).dot(w).abs() / faces
}
