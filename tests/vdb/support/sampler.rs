//! Lookups between voxels against the library's BoxSampler: the voxels as read, the sampling
//! structure in index space, and the extinction in world space.

use photonvdb::math::{DAffine3, DVec3};
use photonvdb::medium::Extinction;
use photonvdb::medium::grid::{DensityGrid, GridExtinction};
use photonvdb::medium::vdb::SparseGrid;
use serde_json::Value;

use super::answer::{number, text, value_at};

/// Of the largest of the eight values around a place: the library blends in `f32`.
const TOLERANCE: f64 = 1e-6;
/// Where the library's `f32` become subnormal.
const SMALLEST: f64 = f32::MIN_POSITIVE as f64;

/// Compares the grid with all samples of the answer. Says how many there were, and how many of them
/// were looked up in the sampling structure too.
pub fn check_box_samples(grid: &SparseGrid<f32>, expected: &Value) -> Result<[usize; 2], String> {
    let Some(samples) = expected["box_samples"].as_array() else {
        // The library's sampler gives whole numbers for grids of whole numbers.
        let is_whole = text(&expected["value_type"]).starts_with("int");
        return if is_whole { Ok([0, 0]) } else { Err("no samples between voxels".into()) };
    };
    let densities = DensityGrid::from_sparse(grid);
    let extinction = GridExtinction::new(DensityGrid::from_sparse(grid), grid.index_to_world, 1.0);
    let mut structure_count = 0;
    for sample in samples {
        let index = triple(&sample["index"]);
        let world = triple(&sample["world"]);
        let expected = number(&sample["value"]);
        let in_sample = |what: String| format!("BoxSampler at {index}: {what}");
        check_place(&grid.index_to_world, index, world).map_err(in_sample)?;

        let taps = taps(grid, index);
        let blend = blend(&taps, index);
        let largest = taps.iter().fold(0.0, |max: f64, tap| max.max(tap.abs()));
        if !expected.is_finite() {
            // Differences of the largest values overflow in `f32`.
            if blend.is_finite() && largest < f64::from(f32::MAX) / 4.0 {
                return Err(in_sample(format!("{blend} instead of {expected}")));
            }
            continue;
        }
        let tolerance = TOLERANCE * largest + SMALLEST;
        let near = |what: &str, value: f64, expected: f64| {
            if (value - expected).abs() <= tolerance {
                return Ok(());
            }
            Err(in_sample(format!("{what} {value} instead of {expected}")))
        };
        near("voxels", blend, expected)?;

        // What is no density counts as 0 in the structure, and nothing lies outside its bounds.
        let Some((lower, upper)) = densities.render_bounds() else { continue };
        let is_inside = (index.cmpge(lower) & index.cmple(upper)).all();
        if taps.iter().any(|&tap| tap < 0.0) {
            continue;
        }
        let expected = if is_inside { expected } else { 0.0 };
        near("density", densities.density(index), expected)?;
        // In world space rounding may put a place on the face to either side of it.
        let from_face = (index - lower).min(upper - index).min_element().abs();
        if from_face > 1e-6 && extinction.bounds().is_some() {
            near("extinction", extinction.sigma_t(world).x, expected)?;
        }
        structure_count += 1;
    }
    Ok([samples.len(), structure_count])
}

/// Index to world and back, to rounding.
fn check_place(index_to_world: &DAffine3, index: DVec3, world: DVec3) -> Result<(), String> {
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    let translation = index_to_world.translation.abs();
    let there = index_to_world.transform_point3(index);
    let tolerance = ROUNDING * (terms(index_to_world, index) + translation);
    if (there - world).abs().cmpgt(tolerance).any() {
        return Err(format!("world {there} instead of {world}"));
    }
    let inverse = index_to_world.inverse();
    let back = inverse.transform_point3(world);
    let tolerance = ROUNDING * (terms(&inverse, world.abs() + translation) + index.abs());
    if (back - index).abs().cmpgt(tolerance).any() {
        return Err(format!("index {back} instead of {index}"));
    }
    Ok(())
}

/// The sums of a matrix product with all terms positive: what its rounding is relative to.
fn terms(map: &DAffine3, vector: DVec3) -> DVec3 {
    let [x, y, z] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    x.abs() * vector.x.abs() + y.abs() * vector.y.abs() + z.abs() * vector.z.abs()
}

/// The eight values around a place; number 4x + 2y + z is offset by (x, y, z).
fn taps(grid: &SparseGrid<f32>, index: DVec3) -> [f64; 8] {
    let base = index.floor().as_ivec3();
    std::array::from_fn(|corner| {
        let offset = [corner >> 2, corner >> 1 & 1, corner & 1];
        let voxel = std::array::from_fn(|axis| base[axis] + offset[axis] as i32);
        f64::from(value_at(grid, voxel).1)
    })
}

fn blend(taps: &[f64; 8], index: DVec3) -> f64 {
    let weight = index - index.floor();
    let share = |axis: usize, upper: usize| [1.0 - weight[axis], weight[axis]][upper];
    let shares =
        |corner: usize| share(0, corner >> 2) * share(1, corner >> 1 & 1) * share(2, corner & 1);
    taps.iter().enumerate().map(|(corner, tap)| shares(corner) * tap).sum()
}

fn triple(value: &Value) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|axis| number(&value[axis])))
}
