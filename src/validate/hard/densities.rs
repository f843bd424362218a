//! Densities that are none: NaN, infinite, negative, and far larger than all around.

use super::super::error::ValidateError;
use super::super::field::{extinction, sparse};
use super::super::report::Row;
use super::super::stage::{one_watt, scene, smoke, trace};
use super::FEW;
use crate::math::{DAffine3, DVec3, Ray, Span};
use crate::medium::Extinction;
use crate::medium::vdb::sanitize_density;

const GROUP: &str = "NaN, infinite, negative densities";

pub(super) fn rows() -> Result<Vec<Row>, ValidateError> {
    let cases = [
        ("NaN", f32::NAN),
        ("infinite", f32::INFINITY),
        ("minus infinite", f32::NEG_INFINITY),
        ("negative", -3.0),
    ];
    let depth_with = |value: f32| {
        let grid = with_value(value);
        let grid = extinction(&grid, DAffine3::IDENTITY, 1.0)?;
        let ray = Ray::new(DVec3::new(-1.0, 1.0, 1.0), DVec3::X);
        let depth = grid.optical_depth(&ray, Span::new(0.0, 6.0)).x;
        Ok::<_, ValidateError>((depth, grid))
    };
    let (empty, _) = depth_with(0.0)?;
    let mut rows = Vec::new();
    for (name, value) in cases {
        let (depth, grid) = depth_with(value)?;
        let max = grid.max_sigma_t();
        rows.push(Row::exact(GROUP, format!("{name}: counts as 0"), empty, depth, 0.0));
        rows.push(Row::exact(GROUP, format!("{name}: majorant"), 1.0, max, 0.0));
        let count = sanitize_density(&mut with_value(value)).total() as f64;
        rows.push(Row::exact(GROUP, format!("{name}: counted"), 1.0, count, 0.0));
        let scene = scene(smoke(grid, 0.9, 0.3), vec![one_watt(DVec3::ONE)], FEW)?;
        let balance = trace(&scene).balance;
        let whole = (balance.absorbed + balance.escaped).x / balance.emitted.x;
        rows.push(Row::exact(GROUP, format!("{name}: power is kept"), 1.0, whole, 1e-12));
    }
    Ok(rows)
}

/// A cube of density 1 with one other voxel in its middle.
fn with_value(value: f32) -> crate::medium::vdb::SparseGrid<f32> {
    sparse([0; 3], [2; 3], 0.0, |voxel| if voxel == [1; 3] { f64::from(value) } else { 1.0 })
}
