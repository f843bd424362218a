//! Single scattering along rays, computed without photons: the airlight of a point light against quadrature in multiple
//! precision, and every kind of light against integration by a fine ruler.

use std::f64::consts::PI;

use crate::transport_support::*;
use photonvdb::light::{
    DirectionalLight, Environment, EnvironmentImage, Light, PointLight, QuadLight, SphereLight,
    SpotLight,
};
use photonvdb::math::{DVec3, Ray, Rgb, Stream};
use photonvdb::medium::Bounds;
use photonvdb::render::{LitScene, Unobserved};
use photonvdb::scene::Scene;

/// Single scattering along a ray, from runs of `samples` points each.
fn single_scatter(scene: &mut Scene, ray: &Ray, end: f64, samples: usize) -> Runs {
    scene.render.light_samples = samples;
    let lit = LitScene::prepare(scene, &Unobserved).unwrap();
    let mut reader = lit.reader();
    Runs::of((0..RUNS).map(|run| {
        let mut random = Stream::Experiment.random(run, 0);
        let seen = reader.radiance(ray, end, &mut random).single_scatter;
        assert!((seen / seen.x - Rgb::ONE).abs().max_element() < 1e-12, "grey: {seen}");
        seen.x
    }))
}

fn vector(row: &serde_json::Value, key: &str) -> DVec3 {
    DVec3::from_slice(&numbers(row, key))
}

/// All 15 rays to 1e-3. The infinite media are balls of 60 mean free paths (of 100 m in the thinnest), whose missing
/// light is far below that.
#[test]
fn airlight_of_a_point_light() {
    for row in truth("airlight.json").as_array().unwrap() {
        let name = row["name"].as_str().unwrap();
        let sigma_t = number(row, "sigma_t");
        let bounds = match row["medium"].as_str().unwrap() {
            "infinite" => ball((60.0 / sigma_t).clamp(11.0, 100.0)),
            _ => CUBE,
        };
        let medium = grey_fog(bounds, sigma_t, number(row, "albedo"), number(row, "g"));
        let mut scene = scene(medium, one_watt(vector(row, "light")), 1);
        let ray = Ray::new(vector(row, "origin"), vector(row, "dir_unnormalised").normalize());
        let end = row["tmax"].as_f64().unwrap_or(f64::INFINITY);
        let found = single_scatter(&mut scene, &ray, end, 4096);
        let exact = number(row, "L");
        found.assert_within(exact, 1e-4 * exact, name);
        assert!((found.mean / exact - 1.0).abs() < 1e-3, "{name}: {found:?} for {exact}");
    }
}

const SIGMA_T: f64 = 1.2;
const ALBEDO: f64 = 0.9;
const G: f64 = 0.4;

/// Of the painted sky \[rad\].
const TURN: f64 = 0.3;

/// Transmittance from a place in the cube over a distance.
fn transmittance(place: DVec3, direction: DVec3, distance: f64) -> f64 {
    let to_face = |axis: usize| {
        let side = 1.0_f64.copysign(direction[axis]);
        (side - place[axis]) / direction[axis]
    };
    let exit = to_face(0).min(to_face(1)).min(to_face(2));
    (-SIGMA_T * exit.min(distance)).exp()
}

/// What a light sends through a place: (direction to the light, distance, irradiance), summed over many.
type Incoming = Vec<(DVec3, f64, f64)>;

/// Midpoints of `count` cells of the unit interval.
fn midpoints(count: usize) -> impl Iterator<Item = f64> + Clone {
    (0..count).map(move |i| (i as f64 + 0.5) / count as f64)
}

/// Light of radiance 2 from a piece of a surface.
fn from_piece(place: DVec3, point: DVec3, area_normal: DVec3) -> Option<(DVec3, f64, f64)> {
    let offset = point - place;
    let distance = offset.length();
    let cosine_area = -area_normal.dot(offset / distance);
    let irradiance = 2.0 * cosine_area / (distance * distance);
    (cosine_area > 0.0).then_some((offset / distance, distance, irradiance))
}

fn from_quad(light: &QuadLight, place: DVec3) -> Incoming {
    let side = 48;
    let cells = midpoints(side).flat_map(|u| midpoints(side).map(move |v| (u, v)));
    let normal = light.edge_u.cross(light.edge_v) / (side * side) as f64;
    cells
        .filter_map(|(u, v)| {
            from_piece(place, light.corner + light.edge_u * u + light.edge_v * v, normal)
        })
        .collect()
}

fn from_sphere(light: &SphereLight, place: DVec3) -> Incoming {
    let (rows, columns) = (80, 160);
    let area = 4.0 * PI * light.radius * light.radius / (rows * columns) as f64;
    let cells = midpoints(rows).flat_map(|u| midpoints(columns).map(move |v| (2.0 * u - 1.0, v)));
    cells
        .filter_map(|(z, turn)| {
            let (sin, cos) = (2.0 * PI * turn).sin_cos();
            let ring = (1.0 - z * z).sqrt();
            let normal = DVec3::new(ring * cos, ring * sin, z);
            from_piece(place, light.center + normal * light.radius, normal * area)
        })
        .collect()
}

/// A sky of `radiance`, constant over the pixels of an image of 8 x 4.
fn from_sky(radiance: impl Fn(DVec3) -> f64) -> Incoming {
    let (rows, columns) = (4 * 24, 8 * 12);
    let cells = midpoints(rows).flat_map(|u| midpoints(columns).map(move |v| (u, v)));
    cells
        .map(|(u, v)| {
            // Turned with the image, so that no cell lies across a pixel's edge.
            let (theta, azimuth) = (PI * u, 2.0 * PI * v + TURN);
            let direction =
                DVec3::new(theta.sin() * azimuth.sin(), theta.cos(), theta.sin() * azimuth.cos());
            let solid_angle = theta.sin() * (PI / rows as f64) * (2.0 * PI / columns as f64);
            (direction, f64::INFINITY, radiance(direction) * solid_angle)
        })
        .collect()
}

/// Radiance of a light scattered once along a ray, by the midpoint rule.
fn by_ruler(ray: &Ray, steps: usize, incoming: impl Fn(DVec3) -> Incoming) -> f64 {
    let span = CUBE.intersect(ray).unwrap();
    let step = span.length() / steps as f64;
    let at = |t: f64| {
        let place = ray.at(span.start + t * span.length());
        let scattered = incoming(place).into_iter().map(|(direction, distance, irradiance)| {
            // The angle turned by light that travels to the place and on to the camera.
            let cosine = direction.dot(ray.direction);
            let phase = (1.0 - G * G) / (4.0 * PI * (1.0 + G * G - 2.0 * G * cosine).powf(1.5));
            irradiance * phase * transmittance(place, direction, distance)
        });
        (-SIGMA_T * t * span.length()).exp() * scattered.sum::<f64>()
    };
    midpoints(steps).map(at).sum::<f64>() * step * SIGMA_T * ALBEDO
}

fn sky_pixels() -> Vec<[f32; 3]> {
    (0..32).map(|i| [((i * 7) % 5) as f32 + if i == 13 { 40.0 } else { 0.0 }; 3]).collect()
}

#[test]
fn every_light_by_the_ruler() {
    let position = DVec3::new(0.4, 0.9, -1.6);
    let axis = (DVec3::new(0.1, 0.0, 0.1) - position).normalize();
    let quad = |shift: DVec3| QuadLight {
        corner: DVec3::new(-0.5, 0.7, 0.4) + shift,
        edge_u: DVec3::new(0.9, 0.1, 0.0),
        edge_v: DVec3::new(0.0, 0.2, -0.8),
        radiance: Rgb::splat(2.0),
        is_visible: true,
    };
    // edge_u x edge_v points to +y: turned over, it shines down.
    let down = |q: QuadLight| QuadLight { edge_u: q.edge_v, edge_v: q.edge_u, ..q };
    let sphere = |center: DVec3, radius| SphereLight {
        center,
        radius,
        radiance: Rgb::splat(2.0),
        is_visible: true,
    };
    let point = |intensity: f64| {
        move |place: DVec3| {
            let offset = position - place;
            let distance = offset.length();
            (offset / distance, distance, intensity / (distance * distance))
        }
    };
    let spot = SpotLight {
        position,
        axis,
        intensity: Rgb::splat(5.0),
        cone_angle: 0.4,
        falloff_angle: 0.15,
    };
    let in_cone = |place: DVec3| {
        let (direction, distance, irradiance) = point(5.0)(place);
        let angle = (-direction).dot(axis).clamp(-1.0, 1.0).acos();
        (direction, distance, irradiance * ((0.4 - angle) / 0.25).clamp(0.0, 1.0))
    };
    let travel = DVec3::new(0.3, -0.8, 0.5).normalize();
    let sun = DirectionalLight { direction: travel, irradiance: Rgb::splat(3.0) };
    let image = || Environment::Image(Box::new(EnvironmentImage::new(8, 4, sky_pixels(), TURN)));
    let painted = image();
    let sky = move |direction: DVec3| painted.radiance(direction).x;

    let rays = [
        Ray::new(DVec3::new(-3.0, 0.3, 0.25), DVec3::new(1.0, -0.1, -0.05).normalize()),
        Ray::new(DVec3::new(0.2, -0.4, 0.6), DVec3::new(-0.3, 0.5, -0.6).normalize()),
    ];
    for (index, ray) in rays.iter().enumerate() {
        let check = |name: &str, light: Light, exact: f64| {
            let medium = grey_fog(CUBE, SIGMA_T, ALBEDO, G);
            let mut scene = scene(medium, light, 1);
            let found = single_scatter(&mut scene, ray, f64::INFINITY, 8192);
            let name = format!("ray {index}, {name}");
            found.assert_within(exact, 3e-3 * exact, &name);
            assert!((found.mean / exact - 1.0).abs() < 1e-2, "{name}: {found:?} for {exact}");
        };
        let light = PointLight { position, intensity: Rgb::splat(5.0) };
        let exact = by_ruler(ray, 20_000, |place| vec![point(5.0)(place)]);
        check("point", Light::Point(light), exact);
        check("spot", Light::Spot(spot), by_ruler(ray, 20_000, |place| vec![in_cone(place)]));
        let exact = by_ruler(ray, 20_000, |_| vec![(-travel, f64::INFINITY, 3.0)]);
        check("directional", Light::Directional(sun), exact);
        for (name, light) in [("far", down(quad(DVec3::Y))), ("inside", quad(-1.5 * DVec3::Y))] {
            let exact = by_ruler(ray, 100, |place| from_quad(&light, place));
            check(&format!("quad {name}"), Light::Quad(light), exact);
        }
        for (name, light) in [
            ("far", sphere(DVec3::new(1.5, -2.0, 0.3), 0.7)),
            ("inside", sphere(DVec3::new(0.3, -0.7, -0.5), 0.2)),
        ] {
            let exact = by_ruler(ray, 100, |place| from_sphere(&light, place));
            check(&format!("sphere {name}"), Light::Sphere(light), exact);
        }
        let exact = by_ruler(ray, 100, |_| from_sky(|_| 2.0));
        check("constant sky", Light::Environment(Environment::Constant(Rgb::splat(2.0))), exact);
        let exact = by_ruler(ray, 100, |_| from_sky(&sky));
        check("painted sky", Light::Environment(image()), exact);
    }
}

/// A light that does not shine towards the ray leaves it dark.
#[test]
fn the_back_of_a_quad_and_the_outside_of_a_cone_are_dark() {
    let back = QuadLight {
        corner: DVec3::new(-1.0, 3.0, -1.0),
        edge_u: DVec3::Z,
        edge_v: DVec3::X,
        radiance: Rgb::ONE,
        is_visible: true,
    };
    let away = QuadLight { edge_u: back.edge_v, edge_v: back.edge_u, ..back };
    assert!(away.area_normal().y < 0.0);
    let spot = SpotLight {
        position: DVec3::new(0.0, 3.0, 0.0),
        axis: DVec3::Y,
        intensity: Rgb::ONE,
        cone_angle: 1.0,
        falloff_angle: 0.5,
    };
    for light in [Light::Quad(back), Light::Spot(spot)] {
        let bounds = Bounds::Box { min: DVec3::NEG_ONE, max: DVec3::ONE };
        let scene = scene(grey_fog(bounds, 1.0, 0.5, 0.0), light, 1000);
        let lit = LitScene::prepare(&scene, &Unobserved).unwrap();
        let ray = Ray::new(DVec3::new(0.1, 0.2, 5.0), DVec3::NEG_Z);
        let mut random = Stream::Experiment.random(0, 0);
        let seen = lit.reader().radiance(&ray, f64::INFINITY, &mut random);
        assert_eq!((seen.single_scatter, seen.multiple_scatter), (Rgb::ZERO, Rgb::ZERO));
    }
}
