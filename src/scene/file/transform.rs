//! `medium.transform`

use serde::Serialize;

use super::table::{OneOrThree, Table};
use crate::math::{DAffine3, DMat3, DVec3};
use crate::scene::error::Problem;

/// `medium.transform`: moves a volume after the file's own transform, from the file's world to the scene's.
///
/// | key | type | unit | default | range | meaning |
/// |---|---|---|---|---|---|
/// | `scale` | number or 3 numbers | | 1 | not 0 | applied first |
/// | `rotate` | 3 numbers | degrees | `[0, 0, 0]` | | about the fixed x axis first, then y, then z |
/// | `translate` | 3 numbers | m | `[0, 0, 0]` | | applied last |
/// | `matrix` | 16 numbers | | | invertible, last row 0 0 0 1 | instead of the others: row-major, for column vectors, translation in the 4th column |
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
#[allow(missing_docs)]
pub enum TransformSection {
    Steps { translate: DVec3, rotate: DVec3, scale: DVec3 },
    Matrix { matrix: [f64; 16] },
}

/// Determinant over the product of the axes' lengths, below which a transform flattens space.
const SINGULAR: f64 = 1e-12;

impl TransformSection {
    /// Reads `transform` of a medium.
    pub(super) fn read(medium: &Table) -> Result<Self, Problem> {
        let table = medium.section("transform")?;
        table.allow(&["translate", "rotate", "scale", "matrix"])?;
        let section = match table.get("matrix")? {
            Some(matrix) => Self::Matrix { matrix },
            None => Self::Steps {
                translate: table.get_or("translate", DVec3::ZERO)?,
                rotate: table.get_or("rotate", DVec3::ZERO)?,
                scale: table.get_or("scale", OneOrThree(DVec3::ONE))?.0,
            },
        };
        section.check(&table)?;
        Ok(section)
    }

    fn check(&self, table: &Table) -> Result<(), Problem> {
        let Self::Matrix { matrix } = self else {
            return table.ensure("scale", !self.is_singular(), "must not be 0");
        };
        if let Some(key) = ["translate", "rotate", "scale"].into_iter().find(|key| table.has(key)) {
            let text = "give either matrix or translate, rotate and scale, not both";
            return Err(table.problem(key, text));
        }
        let is_affine = matrix[12..] == [0.0, 0.0, 0.0, 1.0];
        table.ensure("matrix", is_affine, "the last of the 4 rows must be 0, 0, 0, 1")?;
        table.ensure("matrix", !self.is_singular(), "must be invertible: it flattens the volume")
    }

    fn is_singular(&self) -> bool {
        let m = self.affine().matrix3;
        let lengths = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
        let determinant = m.determinant();
        determinant == 0.0 || determinant.abs() < SINGULAR * lengths
    }

    /// From the file's world space to the scene's.
    pub fn affine(&self) -> DAffine3 {
        match self {
            Self::Steps { translate, rotate, scale } => {
                let [x, y, z] = rotate.to_array().map(f64::to_radians);
                let rotation = DMat3::from_rotation_z(z)
                    * DMat3::from_rotation_y(y)
                    * DMat3::from_rotation_x(x);
                DAffine3::from_mat3_translation(rotation * DMat3::from_diagonal(*scale), *translate)
            }
            Self::Matrix { matrix: m } => DAffine3::from_cols(
                DVec3::new(m[0], m[4], m[8]),
                DVec3::new(m[1], m[5], m[9]),
                DVec3::new(m[2], m[6], m[10]),
                DVec3::new(m[3], m[7], m[11]),
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_then_turns_about_x_then_y_then_moves() {
        let steps = TransformSection::Steps {
            translate: DVec3::new(10.0, 20.0, 30.0),
            rotate: DVec3::new(90.0, 90.0, 0.0),
            scale: DVec3::new(1.0, 2.0, 3.0),
        };
        // y = 2 -> scaled (0, 2, 0) -> about x: (0, 0, 2) -> about y: (2, 0, 0).
        let moved = steps.affine().transform_point3(DVec3::Y);
        assert!(moved.abs_diff_eq(DVec3::new(12.0, 20.0, 30.0), 1e-12), "{moved}");
    }

    #[test]
    fn matrix_is_row_major_with_translation_in_the_last_column() {
        let matrix =
            [0.0, -1.0, 0.0, 5.0, 1.0, 0.0, 0.0, 6.0, 0.0, 0.0, 1.0, 7.0, 0.0, 0.0, 0.0, 1.0];
        let moved = TransformSection::Matrix { matrix }.affine().transform_point3(DVec3::X);
        assert_eq!(moved, DVec3::new(5.0, 7.0, 7.0));
    }
}
