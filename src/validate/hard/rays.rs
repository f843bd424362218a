//! Rays along faces and edges of bounds and voxels, through corners, along axes with zeros of either sign, and past the grid.

use super::super::error::ValidateError;
use super::super::field::{Cloud, extinction, sparse};
use super::super::report::Row;
use super::super::stage::CUBE;
use crate::math::{DAffine3, DVec3, Ray, Rgb, Span, Stream};
use crate::medium::{Extinction, Flight, GridExtinction, RayProfile};

const FACES: &str = "rays on faces, edges, corners";
const AXES: &str = "axis-parallel rays, 0 and -0";
const MISSES: &str = "endless rays";

pub(super) fn rows() -> Result<Vec<Row>, ValidateError> {
    let mut rows = on_faces()?;
    rows.extend(along_axes()?);
    rows.extend(past_the_grid()?);
    Ok(rows)
}

/// Density 1 in voxels 0 to 16 and beyond, bounds from -1 to 17.
fn even() -> Result<GridExtinction, ValidateError> {
    extinction(&sparse([0; 3], [16; 3], 1.0, |_| 1.0), DAffine3::IDENTITY, 1.0)
}

/// The chord of the bounds, as the sum of the depths of all pieces of an even grid.
fn on_faces() -> Result<Vec<Row>, ValidateError> {
    let grid = even()?;
    let root = 2.0_f64.sqrt();
    let diagonal = 3.0_f64.sqrt();
    let cases = [
        ("on a voxel face", DVec3::new(-5.0, 4.0, 5.3), DVec3::X, 18.0),
        ("on a brick face", DVec3::new(-5.0, 8.0, 5.3), DVec3::X, 18.0),
        ("on a brick edge", DVec3::new(-5.0, 8.0, 8.0), DVec3::X, 18.0),
        ("on a face of the bounds", DVec3::new(-5.0, -1.0, 5.3), DVec3::X, 18.0),
        ("on an edge of the bounds", DVec3::new(-5.0, 17.0, -1.0), DVec3::X, 18.0),
        (
            "through voxel edges",
            DVec3::new(-3.0, -3.0, 4.0),
            DVec3::new(1.0, 1.0, 0.0) / root,
            18.0 * root,
        ),
        ("through voxel corners", DVec3::splat(-3.0), DVec3::ONE / diagonal, 18.0 * diagonal),
        ("through corners, back", DVec3::splat(20.0), DVec3::NEG_ONE / diagonal, 18.0 * diagonal),
    ];
    let mut rows = Vec::new();
    let mut profile = RayProfile::default();
    for (name, origin, direction, chord) in cases {
        let ray = Ray::new(origin, direction);
        let bounds = grid.bounds().and_then(|bounds| bounds.intersect(&ray));
        let span = bounds.unwrap_or(Span::new(0.0, 0.0));
        let depth = grid.optical_depth(&ray, span).x;
        grid.profile(&ray, span, &mut profile);
        let by_profile = profile.optical_depth(span.end).x;
        let off = (depth - chord).abs().max((by_profile - chord).abs());
        let name = format!("{name}: sum of pieces - chord");
        rows.push(Row::exact(FACES, name, 0.0, off, 1e-12 * chord));
    }
    let chord = |origin: DVec3, direction: DVec3| {
        let span = CUBE.intersect(&Ray::new(origin, direction));
        span.map_or(0.0, |span| span.length())
    };
    let face = chord(DVec3::new(-3.0, 1.0, 0.2), DVec3::X);
    let edge = chord(DVec3::new(-3.0, 1.0, -1.0), DVec3::X);
    let corners = chord(DVec3::splat(-3.0), DVec3::ONE / diagonal);
    rows.push(Row::exact(FACES, "box of fog: on a face", 2.0, face, 1e-14));
    rows.push(Row::exact(FACES, "box of fog: on an edge", 2.0, edge, 1e-14));
    rows.push(Row::exact(FACES, "box of fog: through corners", 2.0 * diagonal, corners, 1e-14));
    Ok(rows)
}

/// As a ray that is tilted a little.
fn along_axes() -> Result<Vec<Row>, ValidateError> {
    let cloud = Cloud::new().extinction(3.0)?;
    let tilt = DVec3::new(1.3e-9, -0.7e-9, 0.9e-9);
    let mut rows = Vec::new();
    for (name, zero) in [("0", 0.0), ("-0", -0.0)] {
        let directions = [
            DVec3::new(1.0, zero, zero),
            DVec3::new(zero, -1.0, zero),
            DVec3::new(zero, zero, 1.0),
        ];
        for direction in directions {
            let start = DVec3::new(0.0, 0.2, -0.3) - 2.0 * direction;
            let depth = |direction: DVec3| {
                cloud.optical_depth(&Ray::new(start, direction), Span::new(0.0, 4.0)).x
            };
            let tilted = depth(direction + tilt);
            let name = format!("zeros are {name}, along {}", axis_name(direction));
            rows.push(Row::exact(AXES, name, tilted, depth(direction), 1e-7));
        }
        let inside = CUBE.intersect(&Ray::new(DVec3::new(-3.0, 0.5, 0.5), directions[0]));
        let length = inside.map_or(f64::NAN, |span| span.length());
        rows.push(Row::exact(AXES, format!("zeros are {name}: chord of a box"), 2.0, length, 0.0));
        let beside = CUBE.intersect(&Ray::new(DVec3::new(-3.0, 1.5, 0.5), directions[0]));
        rows.push(Row::holds(AXES, format!("zeros are {name}: beside a box"), beside.is_none()));
    }
    Ok(rows)
}

fn axis_name(direction: DVec3) -> &'static str {
    match direction.abs().max_position() {
        0 => "x",
        1 => "y",
        _ => "z",
    }
}

/// No end of a ray is looked for where there is nothing.
fn past_the_grid() -> Result<Vec<Row>, ValidateError> {
    let grid = even()?;
    let forever = Span::new(0.0, f64::INFINITY);
    let cases = [
        ("beside the grid", DVec3::new(0.0, 50.0, 0.0), DVec3::X),
        ("away from it", DVec3::new(50.0, 3.0, 3.0), DVec3::X),
        ("on its face but for a rounding", DVec3::new(-5.0, 17.0 + 1e-12, 3.0), DVec3::X),
    ];
    let mut random = Stream::Experiment.random(0, 0);
    let mut rows = Vec::new();
    for (name, origin, direction) in cases {
        let ray = Ray::new(origin, direction);
        let transmittance = grid.transmittance(&ray, forever).x;
        let flight = grid.sample_flight(&ray, forever, Rgb::ONE, &mut random);
        let escapes = flight == Flight::Escape { weight: Rgb::ONE };
        rows.push(Row::exact(MISSES, format!("{name}: T"), 1.0, transmittance, 0.0));
        rows.push(Row::holds(MISSES, format!("{name}: a photon escapes"), escapes));
    }
    let through = Ray::new(DVec3::new(-50.0, 3.0, 3.0), DVec3::X);
    let depth = grid.optical_depth(&through, forever).x;
    rows.push(Row::exact(MISSES, "through the grid: depth", 18.0, depth, 1e-12));
    Ok(rows)
}
