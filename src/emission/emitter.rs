//! One light seen as a source of photons into the medium's bounds.
//!
//! Every photon is aimed: a point outside the bounds sends its photons into the solid angle they fill,
//! parallel light covers their outline, an environment enters through their surface. The power of a photon is
//! the light's density (intensity, irradiance, radiance) over the density of the sample, so that the sum over
//! photons is exactly, or in the mean, the power that the light sends into the bounds.

use std::f64::consts::PI;

use crate::emission::aim::{DirectionAim, FaceChoice, OutlineAim};
use crate::emission::cone_table::ConeTable;
use crate::light::{Environment, Light, QuadLight, SphereLight, SpotLight};
use crate::math::square_maps::{
    disc_to_cap, disc_to_cosine_hemisphere, square_to_disc, square_to_sphere,
};
use crate::math::{Ball, DVec2, DVec3, Frame, Ray, Rgb, mean_channel};
use crate::medium::{Bounds, EmissiveCells, Face, Medium};

/// A light prepared for the bounds of a medium.
#[derive(Debug)]
pub struct Emitter<'a> {
    source: Source<'a>,
    /// Power into the bounds, estimated where it has no closed form \[W, mean channel\].
    power: f64,
    /// Sizes in the medium of the dimensions before the first flight.
    extents: Vec<Size>,
    /// A ball about the medium (about the light, if the medium is infinite).
    extent: Ball,
}

/// Size in the medium of one dimension of the emission.
#[derive(Clone, Copy, Debug)]
enum Size {
    /// In metres.
    Fixed(f64),
    /// In metres a metre of depth: directions into infinite bounds.
    PerDepth(f64),
}

/// How each kind of light is sampled.
#[derive(Debug)]
enum Source<'a> {
    /// Nothing to sample.
    Dark,
    /// From a point, by solid angle.
    Point { position: DVec3, intensity: Rgb, aim: DirectionAim },
    /// From a spot, by its own cone.
    Cone { spot: &'a SpotLight, frame: Frame, table: ConeTable },
    /// From a spot, by the solid angle of the bounds.
    AimedSpot { spot: &'a SpotLight, aim: DirectionAim },
    /// Parallel light through the outline.
    Parallel { direction: DVec3, irradiance: Rgb, outline: OutlineAim },
    /// The same radiance from all around: uniform over the bounds' surface, by cosine.
    Surround { radiance: Rgb, surface: Surface },
    /// An environment image: a direction by its radiance, then the outline.
    Image { environment: &'a Environment, bounds: &'a Bounds },
    /// A quad: a place, then a direction.
    Quad { light: &'a QuadLight, bounds: &'a Bounds },
    /// The medium itself: a place by what is emitted there, then a direction.
    Medium { medium: &'a Medium, cells: &'a EmissiveCells },
    /// A sphere: a place on the side that sees the bounds, then a direction.
    Sphere { light: &'a SphereLight, bounds: &'a Bounds, cap: Option<(Frame, f64)> },
}

/// The surface of convex bounds.
#[derive(Debug)]
enum Surface {
    Faces(FaceChoice),
    Ball(Ball),
}

impl<'a> Emitter<'a> {
    /// Prepares a light.
    pub fn new(light: &'a Light, bounds: &'a Bounds) -> Self {
        let extent = bounds.enclosing_ball().unwrap_or(Ball {
            center: light.position().unwrap_or(DVec3::ZERO),
            radius: f64::INFINITY,
        });
        let nothing = |power: Rgb| mean_channel(power) <= 0.0;
        // From a surface photons go into a hemisphere.
        let across = match extent.radius {
            f64::INFINITY => Size::PerDepth((2.0 * PI).sqrt()),
            radius => Size::Fixed(radius),
        };
        let (source, power, extents) = match light {
            Light::Point(light) => {
                let aim = DirectionAim::new(light.position, bounds);
                let solid_angle = aim.solid_angle();
                let power = mean_channel(light.intensity) * solid_angle;
                let lateral = lateral_extent(light.position, extent, solid_angle);
                let (position, intensity) = (light.position, light.intensity);
                (Source::Point { position, intensity, aim }, power, vec![lateral; 2])
            }
            Light::Spot(spot) => Self::spot(spot, bounds, extent),
            Light::Directional(light) => match OutlineAim::new(light.direction, bounds) {
                Some(outline) if !nothing(light.irradiance) => {
                    let (direction, irradiance) = (light.direction, light.irradiance);
                    let power = mean_channel(irradiance) * outline.area();
                    let lateral = Size::Fixed(outline.area().sqrt());
                    (Source::Parallel { direction, irradiance, outline }, power, vec![lateral; 2])
                }
                _ => Self::dark(),
            },
            Light::Environment(environment) => Self::environment(environment, bounds, extent),
            Light::Quad(light) => {
                let area = light.area_normal().length();
                let power = mean_channel(light.radiance) * PI * area;
                let edges = [light.edge_u, light.edge_v].map(|edge| Size::Fixed(edge.length()));
                let extents = vec![edges[0], edges[1], across, across];
                (Source::Quad { light, bounds }, power, extents)
            }
            Light::Sphere(light) => {
                let area = 4.0 * PI * light.radius * light.radius;
                let power = mean_channel(light.radiance) * PI * area;
                let cap = visible_cap(light, bounds, extent);
                let radius = Size::Fixed(light.radius);
                let extents = vec![radius, radius, across, across];
                (Source::Sphere { light, bounds, cap }, power, extents)
            }
        };
        Self { source, power, extents, extent }
    }

    /// Prepares a medium that emits light of its own.
    pub fn of_medium(medium: &'a Medium) -> Option<Self> {
        let cells = medium.emissivity.as_ref()?.cells()?;
        let extent = medium.bounds.enclosing_ball()?;
        let [u, v, w] = cells.edges();
        let extents = [u, v, w, extent.radius, extent.radius].map(Size::Fixed).to_vec();
        let power = mean_channel(cells.power());
        Some(Self { source: Source::Medium { medium, cells }, power, extents, extent })
    }

    fn spot(spot: &'a SpotLight, bounds: &Bounds, extent: Ball) -> (Source<'a>, f64, Vec<Size>) {
        let aim = DirectionAim::new(spot.position, bounds);
        let cone = spot.effective_solid_angle();
        let solid_angle = cone.min(aim.solid_angle());
        let power = mean_channel(spot.intensity) * solid_angle;
        let lateral = lateral_extent(spot.position, extent, solid_angle);
        // The smaller of the two wastes fewer photons on directions that the other excludes.
        let source = if cone <= aim.solid_angle() {
            Source::Cone { spot, frame: Frame::about(spot.axis), table: ConeTable::new(spot) }
        } else {
            Source::AimedSpot { spot, aim }
        };
        (source, power, vec![lateral; 2])
    }

    fn environment(
        environment: &'a Environment,
        bounds: &'a Bounds,
        extent: Ball,
    ) -> (Source<'a>, f64, Vec<Size>) {
        let surface = match bounds {
            Bounds::Sphere { .. } => Surface::Ball(extent),
            Bounds::Infinite => return Self::dark(),
            Bounds::Box { .. } | Bounds::Parallelepiped(_) => {
                let faces = bounds.parallelepiped().map(|shape| shape.faces().to_vec());
                let area = |face: &Face| face.area_normal.length();
                Surface::Faces(FaceChoice::new(faces.unwrap_or_default(), area))
            }
        };
        let area = surface.area();
        let power = environment.mean_radiance() * PI * area;
        let source = match environment {
            Environment::Constant(radiance) => Source::Surround { radiance: *radiance, surface },
            Environment::Image(_) => Source::Image { environment, bounds },
        };
        let extents = [area.sqrt(), area.sqrt(), extent.radius, extent.radius];
        (source, power, extents.map(Size::Fixed).to_vec())
    }

    /// A light that sends nothing into the bounds, or has none to aim at.
    fn dark() -> (Source<'a>, f64, Vec<Size>) {
        (Source::Dark, 0.0, vec![Size::Fixed(1.0); 2])
    }

    /// Power into the bounds \[W, mean channel\], exact up to spots cut by the bounds, area lights and images.
    pub fn power_estimate(&self) -> f64 {
        self.power
    }

    /// Whether the medium is the source, and not a light.
    pub fn is_medium(&self) -> bool {
        matches!(self.source, Source::Medium { .. })
    }

    /// Primary dimensions that lead to a ray: 2 or 4, or, of a medium, 5.
    pub fn dimensions(&self) -> usize {
        self.extents.len()
    }

    /// Sizes in the medium of the primary dimensions, that of the first flight last \[m\].
    pub fn extents(&self, mean_free_path: f64) -> Vec<f64> {
        // A quantile interval dw of the flight is exp(t / mfp) mfp dw long; taken at the typical depth.
        let depth = mean_free_path.min(self.extent.radius);
        let flight = (depth / mean_free_path).exp() * mean_free_path;
        let largest = if self.extent.radius.is_finite() { 1e6 * self.extent.radius } else { 1e6 };
        let lateral = self.extents.iter().map(|&size| match size {
            Size::Fixed(metres) => metres,
            Size::PerDepth(metres) => metres * depth,
        });
        lateral.chain([flight.min(largest)]).map(|e| e.max(f64::MIN_POSITIVE)).collect()
    }

    /// The ray and power \[W\] at a point of the unit cube, the power as if it were the only photon. `None` where
    /// the light sends nothing that way.
    pub fn sample_ray(&self, u: [f64; 5]) -> Option<(Ray, Rgb)> {
        let (first, second) = (DVec2::new(u[0], u[1]), DVec2::new(u[2], u[3]));
        let (ray, power) = match &self.source {
            Source::Dark => return None,
            Source::Point { position, intensity, aim } => {
                let aimed = aim.sample_direction(first)?;
                (Ray::new(*position, aimed.direction), *intensity * aimed.solid_angle)
            }
            Source::Cone { spot, frame, table } => {
                let sample = table.sample_direction(spot, frame, first);
                (Ray::new(spot.position, sample.direction), spot.intensity * sample.solid_angle)
            }
            Source::AimedSpot { spot, aim } => {
                let aimed = aim.sample_direction(first)?;
                let falloff = spot.falloff(spot.angle_to(aimed.direction));
                let power = spot.intensity * (falloff * aimed.solid_angle);
                (Ray::new(spot.position, aimed.direction), power)
            }
            Source::Parallel { direction, irradiance, outline } => {
                let place = outline.sample_place(first)?;
                (self.ray_through(place.position, *direction), *irradiance * place.area)
            }
            Source::Surround { radiance, surface } => {
                let (place, normal) = surface.sample_place(first)?;
                let inward = disc_to_cosine_hemisphere(square_to_disc(second));
                let direction = Frame::about(-normal).to_world(inward);
                (self.ray_through(place, direction), *radiance * (PI * surface.area()))
            }
            Source::Image { environment, bounds } => {
                let sample = environment.sample_direction(second);
                let outline = OutlineAim::new(-sample.direction, bounds)?;
                let place = outline.sample_place(first)?;
                let power = environment.radiance(sample.direction) * (place.area / sample.pdf);
                (self.ray_through(place.position, -sample.direction), power)
            }
            Source::Quad { light, bounds } => {
                let place = light.corner + light.edge_u * u[0] + light.edge_v * u[1];
                let normal = light.area_normal();
                let power = light.radiance * normal.length();
                from_surface(place, normal.normalize(), power, bounds, second)?
            }
            Source::Medium { medium, cells } => {
                let place = cells.sample_place([u[0], u[1], u[2]]);
                let direction = square_to_sphere(DVec2::new(u[3], u[4]));
                let emissivity = medium.emissivity_at(place.position);
                let power = emissivity * (4.0 * PI * place.volume);
                (Ray::new(place.position, direction), power)
            }
            Source::Sphere { light, bounds, cap } => {
                let (normal, share) = match cap {
                    Some((frame, versine)) => {
                        let disc = square_to_disc(first);
                        let (local, _) = disc_to_cap(disc, *versine);
                        (frame.to_world(local).normalize(), 0.5 * versine)
                    }
                    None => (square_to_sphere(first), 1.0),
                };
                let place = light.center + normal * light.radius;
                let area = 4.0 * PI * light.radius * light.radius * share;
                from_surface(place, normal, light.radiance * area, bounds, second)?
            }
        };
        (power.max_element() > 0.0).then_some((ray, power))
    }

    /// A ray through `place` that starts outside the medium.
    fn ray_through(&self, place: DVec3, direction: DVec3) -> Ray {
        let back = 2.0 * self.extent.radius + (place - self.extent.center).length();
        Ray::new(place - direction * back, direction)
    }
}

impl Surface {
    fn area(&self) -> f64 {
        match self {
            Self::Faces(faces) => faces.total,
            Self::Ball(ball) => 4.0 * PI * ball.radius * ball.radius,
        }
    }

    /// A uniform place and the unit outward normal there.
    fn sample_place(&self, u: DVec2) -> Option<(DVec3, DVec3)> {
        match self {
            Self::Faces(faces) => {
                let place = faces.sample_place(u)?;
                Some((place.position, place.face.area_normal.normalize()))
            }
            Self::Ball(ball) => {
                let normal = square_to_sphere(u);
                Some((ball.center + normal * ball.radius, normal))
            }
        }
    }
}

/// A photon from a place of a surface that radiates `power` per steradian along its normal: by cosine if the
/// place is inside the bounds, else into the solid angle that they fill.
fn from_surface(
    place: DVec3,
    normal: DVec3,
    power: Rgb,
    bounds: &Bounds,
    u: DVec2,
) -> Option<(Ray, Rgb)> {
    if bounds.contains(place) {
        let outward = disc_to_cosine_hemisphere(square_to_disc(u));
        let direction = Frame::about(normal).to_world(outward);
        return Some((Ray::new(place, direction), power * PI));
    }
    let aimed = DirectionAim::new(place, bounds).sample_direction(u)?;
    let cosine = normal.dot(aimed.direction);
    (cosine > 0.0).then(|| (Ray::new(place, aimed.direction), power * (cosine * aimed.solid_angle)))
}

/// The cap of a sphere light, as frame and 1 - cos of its half-angle, from which the bounds can be seen; `None`
/// if that is all of it.
fn visible_cap(light: &SphereLight, bounds: &Bounds, extent: Ball) -> Option<(Frame, f64)> {
    if matches!(bounds, Bounds::Infinite) {
        return None;
    }
    let to_medium = extent.center - light.center;
    let distance = to_medium.length();
    // The tangent plane at angle a from the axis has the medium's centre at height d cos(a) - r above
    // it: the ball is out of sight where that is below minus its radius.
    let cosine = (light.radius - extent.radius) / distance;
    if cosine <= -1.0 || distance <= light.radius + extent.radius {
        return None;
    }
    Some((Frame::about(to_medium / distance), 1.0 - cosine))
}

/// The mean size across the beam, where it meets the medium, of a light's directions.
fn lateral_extent(position: DVec3, extent: Ball, solid_angle: f64) -> Size {
    if extent.radius.is_infinite() {
        return Size::PerDepth(solid_angle.sqrt());
    }
    Size::Fixed(position.distance(extent.center).max(0.5 * extent.radius) * solid_angle.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{DirectionalLight, EnvironmentImage, PointLight};
    use crate::math::{Stream, uniform};

    const BOX: Bounds = Bounds::Box { min: DVec3::NEG_ONE, max: DVec3::new(1.0, 2.0, 0.5) };
    const BALL: Bounds = Bounds::Sphere { center: DVec3::new(0.2, 0.1, 0.0), radius: 0.9 };
    const PROBE: Ball = Ball { center: DVec3::new(0.3, 0.4, -0.2), radius: 0.3 };

    fn lights() -> Vec<Light> {
        let spot = |position: DVec3, cone_angle, falloff_angle| {
            let axis = (PROBE.center - position).normalize();
            Light::Spot(SpotLight {
                position,
                axis,
                intensity: Rgb::ONE,
                cone_angle,
                falloff_angle,
            })
        };
        let pixels = (0..16 * 8).map(|i| [((i * 7) % 11) as f32; 3]).collect();
        vec![
            Light::Point(PointLight { position: DVec3::new(0.5, -0.5, 0.1), intensity: Rgb::ONE }),
            Light::Point(PointLight { position: DVec3::new(4.0, 3.0, 2.0), intensity: Rgb::ONE }),
            spot(DVec3::new(-3.0, 1.0, 1.0), 0.15, 0.1),
            spot(DVec3::new(-3.0, 1.0, 1.0), 1.2, 0.2),
            Light::Directional(DirectionalLight {
                direction: DVec3::new(0.6, -0.48, 0.64),
                irradiance: Rgb::ONE,
            }),
            Light::Environment(Environment::Constant(Rgb::ONE)),
            Light::Environment(Environment::Image(Box::new(EnvironmentImage::new(
                16, 8, pixels, 0.4,
            )))),
            Light::Quad(QuadLight {
                corner: DVec3::new(-1.0, 3.0, -1.0),
                edge_u: DVec3::new(2.0, 0.3, 0.0),
                edge_v: DVec3::new(0.0, 0.0, 1.5),
                radiance: Rgb::ONE,
                is_visible: true,
            }),
            Light::Sphere(SphereLight {
                center: DVec3::new(2.5, 0.0, 1.0),
                radius: 0.8,
                radiance: Rgb::ONE,
                is_visible: true,
            }),
            // One light within the medium of either kind.
            Light::Sphere(SphereLight {
                center: DVec3::new(-0.3, 0.2, -0.1),
                radius: 0.2,
                radiance: Rgb::ONE,
                is_visible: true,
            }),
        ]
    }

    /// Fluence in an empty ball two ways: track length of the photons in it over its volume, and the mean over
    /// its places of the light's own illumination. 64 independent batches; z of the difference.
    #[test]
    fn photons_carry_exactly_what_the_light_sends() {
        for (case, light) in lights().iter().enumerate() {
            for bounds in [BOX, BALL] {
                let emitter = Emitter::new(light, &bounds);
                let differences: Vec<f64> = (0..64)
                    .map(|batch| {
                        let mut random = Stream::Experiment.random(case as u64, batch);
                        track_length(&emitter, &bounds, &mut random)
                            - illumination(light, &mut random)
                    })
                    .collect();
                let mean = differences.iter().sum::<f64>() / 64.0;
                let spread = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>();
                let z = mean / (spread / 63.0 / 64.0).sqrt();
                assert!(z.abs() < 4.5, "light {case} in {bounds:?}: z = {z}, mean {mean}");
            }
        }
    }

    fn track_length(emitter: &Emitter, bounds: &Bounds, random: &mut crate::math::Random) -> f64 {
        let count = 4000;
        let mut sum = 0.0;
        for _ in 0..count {
            let u = std::array::from_fn(|_| uniform(random));
            let Some((ray, power)) = emitter.sample_ray(u) else { continue };
            assert!(bounds.intersect(&ray).is_some(), "wasted: {ray:?}");
            let probe = Bounds::Sphere { center: PROBE.center, radius: PROBE.radius };
            let length = probe.intersect(&ray).map_or(0.0, |span| span.length());
            sum += power.x * length;
        }
        sum / f64::from(count) / PROBE.volume()
    }

    fn illumination(light: &Light, random: &mut crate::math::Random) -> f64 {
        let count = 4000;
        let mut sum = 0.0;
        for _ in 0..count {
            let offset = loop {
                let p = DVec3::from_array(std::array::from_fn(|_| 2.0 * uniform(random) - 1.0));
                if p.length_squared() < 1.0 {
                    break p * PROBE.radius;
                }
            };
            let u = DVec2::new(uniform(random), uniform(random));
            sum += match light {
                Light::Environment(environment) => 4.0 * PI * environment.mean_radiance(),
                light => light
                    .sample_illumination(PROBE.center + offset, u)
                    .map_or(0.0, |sample| sample.irradiance.x),
            };
        }
        sum / f64::from(count)
    }
}
