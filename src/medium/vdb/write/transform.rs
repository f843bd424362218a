//! A grid's map from index to world space, as the plainest of OpenVDB's kinds that has it exactly.

use super::error::GridProblem;
use super::metadata::put_string;
use crate::math::{DAffine3, DVec3};
use crate::medium::vdb::transform::is_invertible;

/// The name and numbers of a map.
pub(super) fn transform_bytes(index_to_world: &DAffine3) -> Result<Vec<u8>, GridProblem> {
    if !is_invertible(index_to_world) {
        return Err(GridProblem::Transform);
    }
    let axes = index_to_world.matrix3;
    let scale = DVec3::new(axes.x_axis.x, axes.y_axis.y, axes.z_axis.z);
    let translation = index_to_world.translation;
    let mut bytes = Vec::new();
    if axes != glam::DMat3::from_diagonal(scale) {
        put_string(&mut bytes, "AffineMap");
        put_numbers(&mut bytes, &glam::DMat4::from(*index_to_world).to_cols_array());
        return Ok(bytes);
    }
    let is_uniform = scale.x == scale.y && scale.y == scale.z;
    let is_translated = translation != DVec3::ZERO;
    let name = match (is_uniform, is_translated) {
        (true, false) => "UniformScaleMap",
        (true, true) => "UniformScaleTranslateMap",
        (false, false) => "ScaleMap",
        (false, true) => "ScaleTranslateMap",
    };
    put_string(&mut bytes, name);
    if is_translated {
        put_numbers(&mut bytes, &translation.to_array());
    }
    // Readers take these as they are: scale, voxel size, inverse, its square and its half.
    let inverse = 1.0 / scale;
    for numbers in [scale, scale.abs(), inverse, inverse * inverse, inverse / 2.0] {
        put_numbers(&mut bytes, &numbers.to_array());
    }
    Ok(bytes)
}

fn put_numbers(bytes: &mut Vec<u8>, numbers: &[f64]) {
    numbers.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::vdb::cursor::Cursor;
    use crate::medium::vdb::transform::Transform;

    #[test]
    fn each_map_is_written_as_its_kind_and_read_back_exactly() {
        let scale = |x, y, z| DAffine3::from_scale(DVec3::new(x, y, z));
        let moved = |map: DAffine3| DAffine3 { translation: DVec3::new(0.1, -2e6, 3.0), ..map };
        let turned = DAffine3::from_rotation_z(0.3) * scale(0.1, 0.1, 0.1);
        for (map, kind) in [
            (scale(0.1, 0.1, 0.1), "UniformScaleMap"),
            (scale(-0.1, 0.1, 0.3), "ScaleMap"),
            (moved(scale(0.1, 0.1, 0.1)), "UniformScaleTranslateMap"),
            (moved(scale(0.1, 1e-3, 0.1)), "ScaleTranslateMap"),
            (turned, "AffineMap"),
            (moved(turned), "AffineMap"),
        ] {
            let bytes = transform_bytes(&map).unwrap();
            let mut cursor = Cursor::new(&bytes, 0);
            let read = Transform::read(&mut cursor).unwrap();
            assert_eq!((read.map.as_str(), read.index_to_world.unwrap()), (kind, map));
            assert_eq!(cursor.position(), bytes.len());
        }
    }

    #[test]
    fn a_map_without_inverse_is_refused() {
        for scale in [0.0, f64::NAN, f64::INFINITY] {
            let map = DAffine3::from_scale(DVec3::new(1.0, scale, 1.0));
            assert_eq!(transform_bytes(&map), Err(GridProblem::Transform));
        }
    }
}
