//! Voxels of any size and shape, anywhere.

use super::super::error::ValidateError;
use super::super::field::{extinction, sparse};
use super::super::report::Row;
use crate::math::{DAffine3, DMat3, DVec3, Ray, Rgb, Span, Stream};
use crate::medium::{Extinction, Flight};

const GROUP: &str = "extreme voxels";

/// Depth of a cell of corner densities 0.5, 1.5, 2, 0, 3, 0.25, 0, 5 along its diagonal of length sqrt 3.
const DIAGONAL_DEPTH: f64 = 3.355_848_439_664_7;

pub(super) fn rows() -> Result<Vec<Row>, ValidateError> {
    let shapes = [
        ("1e-12 m", DVec3::splat(1e-12)),
        ("1e12 m", DVec3::splat(1e12)),
        ("1 : 1e6 : 1e-6", DVec3::new(1.0, 1e6, 1e-6)),
        ("1e-6 : 1 : 1e6", DVec3::new(1e-6, 1.0, 1e6)),
    ];
    let mut rows = Vec::new();
    for (name, size) in shapes {
        let place = DAffine3::from_scale(size);
        let scale = 3.0_f64.sqrt() / size.length();
        rows.push(along_diagonal(name, [0; 3], place, scale, 1e-12)?);
        rows.push(flight(name, place, scale)?);
    }
    // The grid's own coordinates far from 0, turned, and far from the origin of the world.
    for shift in [1 << 20, -(1 << 30)] {
        let turn = DMat3::from_rotation_y(0.4) * DMat3::from_rotation_x(1.1);
        let matrix = turn * 0.5;
        let origin = DVec3::new(1e6, -2e6, 3e5) - matrix * DVec3::splat(f64::from(shift));
        let place = DAffine3::from_mat3_translation(matrix, origin);
        let name = format!("voxel {shift}, turned, 2e6 m away");
        rows.push(along_diagonal(&name, [shift; 3], place, 2.0, 1e-6)?);
    }
    Ok(rows)
}

/// The eight voxels of the cell at `corner`.
fn cell(corner: [i32; 3]) -> crate::medium::vdb::SparseGrid<f32> {
    let values = [[[0.5, 1.5], [2.0, 0.0]], [[3.0, 0.25], [0.0, 5.0]]];
    sparse(corner, corner.map(|c| c + 1), 0.0, |voxel| {
        let [x, y, z] = [0, 1, 2].map(|axis| (voxel[axis] - corner[axis]) as usize);
        values[x][y][z]
    })
}

/// The ray across the cell.
fn diagonal(corner: [i32; 3], place: DAffine3) -> (Ray, Span) {
    let from = place.transform_point3(DVec3::from_array(corner.map(f64::from)));
    let across = place.matrix3 * DVec3::ONE;
    (Ray::new(from, across.normalize()), Span::new(0.0, across.length()))
}

fn along_diagonal(
    name: &str,
    corner: [i32; 3],
    place: DAffine3,
    scale: f64,
    tolerance: f64,
) -> Result<Row, ValidateError> {
    let grid = extinction(&cell(corner), place, scale)?;
    let (ray, span) = diagonal(corner, place);
    let depth = grid.optical_depth(&ray, span).x;
    let tolerance = tolerance * DIAGONAL_DEPTH;
    Ok(Row::exact(GROUP, format!("{name}: depth"), DIAGONAL_DEPTH, depth, tolerance))
}

/// Free flights end where there is something, by either way of sampling.
fn flight(name: &str, place: DAffine3, scale: f64) -> Result<Row, ValidateError> {
    let grid = extinction(&cell([0; 3]), place, scale)?;
    let (ray, span) = diagonal([0; 3], place);
    let exact = grid.invert_flight(&ray, span, Rgb::ONE, 0.5);
    let depth = match exact {
        Flight::Collision { distance, .. } => grid.optical_depth(&ray, Span::new(0.0, distance)).x,
        Flight::Escape { .. } => f64::NAN,
    };
    let mut random = Stream::Experiment.random(0, 0);
    let ends = (0..200).all(|_| match grid.sample_flight(&ray, span, Rgb::ONE, &mut random) {
        Flight::Collision { distance, .. } => (span.start..=span.end).contains(&distance),
        Flight::Escape { .. } => true,
    });
    let depth = if ends { depth } else { f64::NAN };
    let half = std::f64::consts::LN_2;
    Ok(Row::exact(GROUP, format!("{name}: depth of the median flight"), half, depth, 1e-10))
}
