//! Scenes of any size and place, bounds without volume, and a camera inside.

use super::super::error::ValidateError;
use super::super::field::Cloud;
use super::super::report::Row;
use super::super::stage::{CUBE, ball, fog, one_watt, scene, smoke, trace, white_sky};
use super::FEW;
use crate::light::{DirectionalLight, Light, PointLight};
use crate::math::{DAffine3, DMat3, DVec3, Ray, Rgb, Span, Stream};
use crate::medium::{Bounds, Medium};
use crate::render::{LitScene, Unobserved};

const SCALE: &str = "scale 1e-6, 1e6";
const SHIFT: &str = "far from the origin";
const FLAT: &str = "bounds without volume";
const INSIDE: &str = "camera inside";

pub(super) fn rows() -> Result<Vec<Row>, ValidateError> {
    let mut rows = sizes_and_places()?;
    rows.extend(without_volume()?);
    rows.extend(camera_inside()?);
    Ok(rows)
}

/// Where a scene of size 1 about the origin is put.
#[derive(Clone, Copy)]
struct Place {
    scale: f64,
    shift: DVec3,
}

impl Place {
    fn point(self, x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z) * self.scale + self.shift
    }

    fn fog(self) -> Medium {
        let (min, max) = (self.point(-1.0, -1.0, -1.0), self.point(1.0, 1.0, 1.0));
        fog(Bounds::Box { min, max }, 1.5 / self.scale, 0.9, 0.4)
    }

    fn cloud(self) -> Result<Medium, ValidateError> {
        let place = DAffine3::from_mat3_translation(DMat3::IDENTITY * self.scale, self.shift);
        Ok(smoke(Cloud::new().extinction_at(place, 4.0 / self.scale)?, 0.9, 0.3))
    }

    /// Radiance along rays; lights grow with the square of the scale, so that it is the same.
    fn radiances(self, medium: Medium) -> Result<Vec<Rgb>, ValidateError> {
        let position = self.point(0.3, 0.4, 0.2);
        let intensity = Rgb::ONE * (self.scale * self.scale);
        let direction = DVec3::new(0.6, -0.48, 0.64);
        let lights = vec![
            Light::Point(PointLight { position, intensity }),
            Light::Directional(DirectionalLight { direction, irradiance: Rgb::ONE }),
            white_sky(),
        ];
        let scene = scene(medium, lights, FEW)?;
        let lit = LitScene::prepare(&scene, &Unobserved)?;
        let mut reader = lit.reader();
        let eye = self.point(2.2, 1.8, 4.2);
        let ray = |step: i32| {
            let target = self.point(0.1 * f64::from(step) - 0.8, 0.3, 0.05 * f64::from(step));
            Ray::new(eye, (target - eye).normalize())
        };
        let mut random = Stream::Experiment.random(0, 0);
        let mut seen = |step| {
            let light = reader.radiance(&ray(step), f64::INFINITY, &mut random);
            light.single_scatter + light.multiple_scatter + light.emission
        };
        Ok((0..16).map(&mut seen).collect())
    }
}

/// Root of the mean square of the difference, over the mean.
fn difference(found: &[Rgb], expected: &[Rgb]) -> f64 {
    let squares = found.iter().zip(expected).map(|(a, b)| (*a - *b).length_squared());
    let means = expected.iter().map(|b| b.length_squared());
    (squares.sum::<f64>() / means.sum::<f64>()).sqrt()
}

fn sizes_and_places() -> Result<Vec<Row>, ValidateError> {
    let home = Place { scale: 1.0, shift: DVec3::ZERO };
    let far = DVec3::new(1e6, -1e6, 5e5);
    let places = [
        (SCALE, "1e-6 m", Place { scale: 1e-6, ..home }),
        (SCALE, "1e6 m", Place { scale: 1e6, ..home }),
        (SHIFT, "1e6 m away", Place { shift: far, ..home }),
        (SHIFT, "1e6 m large, 1e12 m away", Place { scale: 1e6, shift: far * 1e6 }),
    ];
    let (fog, cloud) = (home.radiances(home.fog())?, home.radiances(home.cloud()?)?);
    let mut rows = Vec::new();
    for (group, name, place) in places {
        let of_fog = difference(&place.radiances(place.fog())?, &fog);
        let of_cloud = difference(&place.radiances(place.cloud()?)?, &cloud);
        rows.push(Row::exact(group, format!("{name}: fog differs by"), 0.0, of_fog, 1e-4));
        rows.push(Row::exact(group, format!("{name}: cloud differs by"), 0.0, of_cloud, 1e-4));
    }
    Ok(rows)
}

fn without_volume() -> Result<Vec<Row>, ValidateError> {
    let cube = |min: DVec3, max: DVec3| Bounds::Box { min, max };
    let cases = [
        ("flat box", cube(DVec3::NEG_ONE, DVec3::new(1.0, 1.0, -1.0))),
        ("point box", cube(DVec3::ZERO, DVec3::ZERO)),
        ("inverted box", cube(DVec3::ONE, DVec3::NEG_ONE)),
        ("ball of radius 0", ball(0.0)),
    ];
    let mut rows = Vec::new();
    for (name, bounds) in cases {
        let lights = vec![one_watt(DVec3::new(0.1, 0.2, 3.0)), white_sky()];
        let scene = scene(fog(bounds, 1.0, 0.9, 0.0), lights, FEW)?;
        let traced = trace(&scene);
        let lit = LitScene::prepare(&scene, &Unobserved)?;
        let mut random = Stream::Experiment.random(0, 0);
        let ray = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
        let seen = lit.reader().radiance(&ray, f64::INFINITY, &mut random);
        let stored = traced.photons.len() as f64;
        let light = seen.single_scatter.x + seen.multiple_scatter.x + seen.emission.x;
        rows.push(Row::exact(FLAT, format!("{name}: photons stored"), 0.0, stored, 0.0));
        rows.push(Row::exact(FLAT, format!("{name}: T"), 1.0, seen.transmittance.x, 0.0));
        rows.push(Row::exact(FLAT, format!("{name}: the sky behind"), 1.0, light, 0.0));
        let is_finite = traced.balance.escaped.is_finite();
        rows.push(Row::holds(FLAT, format!("{name}: powers are numbers"), is_finite));
    }
    Ok(rows)
}

fn camera_inside() -> Result<Vec<Row>, ValidateError> {
    let ray = Ray::new(DVec3::new(0.0, 0.0, -0.5), DVec3::Z);
    let span = CUBE.intersect(&ray).unwrap_or(Span::new(f64::NAN, f64::NAN));
    let scene = scene(fog(CUBE, 2.0, 0.9, 0.0), vec![one_watt(DVec3::new(0.2, 0.0, -3.0))], FEW)?;
    let lit = LitScene::prepare(&scene, &Unobserved)?;
    let reader = lit.reader();
    let transmittance = |end: f64| reader.transmittance(&ray, end).x;
    Ok(vec![
        Row::exact(INSIDE, "its part of the medium begins at", 0.0, span.start, 0.0),
        Row::exact(INSIDE, "and ends at", 1.5, span.end, 1e-15),
        Row::exact(INSIDE, "T to the boundary", (-3.0_f64).exp(), transmittance(1e9), 1e-15),
        Row::exact(INSIDE, "T of half a metre", (-1.0_f64).exp(), transmittance(0.5), 1e-15),
        Row::exact(INSIDE, "T of nothing", 1.0, transmittance(0.0), 0.0),
    ])
}
