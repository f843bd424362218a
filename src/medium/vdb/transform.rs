//! A grid's map from index to world space.
//!
//! OpenVDB multiplies row vectors and keeps the translation in a matrix's last row; the same 16
//! numbers, read as columns, are the matrix of column vectors used here.

use glam::DMat4;

use super::cursor::Cursor;
use super::fault::Fault;
use crate::math::{DAffine3, DVec3};

/// A map as read: its bytes are consumed even where it cannot be used, so that a stream can be read
/// on.
#[derive(Clone, Debug)]
pub(super) struct Transform {
    /// OpenVDB's name of the map.
    pub map: String,
    /// The map, or why it cannot be used.
    pub index_to_world: Result<DAffine3, Fault>,
}

impl Transform {
    /// Reads a map. Fails only where its length is not known.
    pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<Self, Fault> {
        let map = cursor.string("the transform")?;
        let index_to_world = match map.as_str() {
            // After the scale come values derived from it: voxel size, inverses.
            "UniformScaleMap" | "ScaleMap" => {
                let numbers: [f64; 15] = cursor.f64s("the transform")?;
                checked(DMat4::from_scale(triple(&numbers, 0)))
            }
            "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
                let numbers: [f64; 18] = cursor.f64s("the transform")?;
                let scale = DMat4::from_scale(triple(&numbers, 3));
                checked(DMat4::from_translation(triple(&numbers, 0)) * scale)
            }
            "TranslationMap" => {
                let numbers: [f64; 3] = cursor.f64s("the transform")?;
                checked(DMat4::from_translation(triple(&numbers, 0)))
            }
            "AffineMap" | "UnitaryMap" => checked(matrix(cursor)?),
            "NonlinearFrustumMap" => {
                // Bounds, taper and depth, then the name and matrix of its linear part.
                cursor.f64s::<8>("the transform")?;
                cursor.string("the transform")?;
                matrix(cursor)?;
                Err(Fault::Unsupported(
                    "it lies in a camera's frustum (a non-linear transform); \
                resample it to a uniform grid first"
                        .into(),
                ))
            }
            other => {
                return Err(Fault::Unsupported(format!(
                    "its transform is of the unknown kind {other:?}; \
                save it again with OpenVDB 12 or older"
                )));
            }
        };
        Ok(Self { map, index_to_world })
    }
}

fn triple(numbers: &[f64], first: usize) -> DVec3 {
    DVec3::new(numbers[first], numbers[first + 1], numbers[first + 2])
}

fn matrix(cursor: &mut Cursor<'_>) -> Result<DMat4, Fault> {
    Ok(DMat4::from_cols_array(&cursor.f64s("the transform")?))
}

/// The map, when it is affine, finite and can be inverted.
fn checked(matrix: DMat4) -> Result<DAffine3, Fault> {
    let affine = DAffine3::from_mat4(matrix);
    let is_affine = matrix.row(3) == glam::DVec4::W;
    if is_affine && is_invertible(&affine) {
        Ok(affine)
    } else {
        Err(Fault::Unsupported(
            "its transform cannot be inverted; export it with a voxel size above zero".into(),
        ))
    }
}

/// Whether the map is finite and has an inverse that is.
pub(super) fn is_invertible(map: &DAffine3) -> bool {
    map.is_finite() && map.matrix3.determinant().is_normal() && map.inverse().is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(map: &str, numbers: &[f64]) -> Vec<u8> {
        let mut bytes = (map.len() as u32).to_le_bytes().to_vec();
        bytes.extend_from_slice(map.as_bytes());
        numbers.iter().for_each(|number| bytes.extend_from_slice(&number.to_le_bytes()));
        bytes
    }

    #[test]
    fn the_last_row_of_the_file_is_the_translation() {
        let file =
            bytes("AffineMap", &[0., 2., 0., 0., -3., 0., 0., 0., 0., 0., 1., 0., 5., 6., 7., 1.]);
        let transform = Transform::read(&mut Cursor::new(&file, 0)).unwrap();
        // A row vector (1, 0, 0) picks the first row.
        let world = transform.index_to_world.unwrap().transform_point3(DVec3::X);
        assert_eq!(world, DVec3::new(5., 8., 7.));
    }

    #[test]
    fn the_maps_without_a_scale_are_read_too() {
        let read = |map, numbers: &[f64]| {
            let file = bytes(map, numbers);
            let transform = Transform::read(&mut Cursor::new(&file, 0)).unwrap();
            transform.index_to_world.unwrap().transform_point3(DVec3::new(1., 2., 3.))
        };
        assert_eq!(read("TranslationMap", &[10., 20., 30.]), DVec3::new(11., 22., 33.));
        // The quarter turn that takes x to y.
        let turn = [0., 1., 0., 0., -1., 0., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];
        assert_eq!(read("UnitaryMap", &turn), DVec3::new(-2., 1., 3.));
    }

    #[test]
    fn a_transform_that_cannot_be_inverted_is_named_and_consumed() {
        for numbers in [[0.0; 15], [f64::NAN; 15], [f64::INFINITY; 15], [1e-200; 15]] {
            let file = bytes("ScaleMap", &numbers);
            let mut cursor = Cursor::new(&file, 0);
            let transform = Transform::read(&mut cursor).unwrap();
            assert!(transform.index_to_world.unwrap_err().to_string().contains("inverted"));
            assert_eq!(cursor.position(), file.len());
        }
    }

    #[test]
    fn a_perspective_matrix_is_refused() {
        let mut numbers = DMat4::IDENTITY.to_cols_array();
        numbers[3] = 0.5;
        let file = bytes("AffineMap", &numbers);
        assert!(Transform::read(&mut Cursor::new(&file, 0)).unwrap().index_to_world.is_err());
    }
}
