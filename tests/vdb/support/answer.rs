//! Compares a file read by this project with what the OpenVDB library said of it.

use std::path::Path;

use photonvdb::math::{DAffine3, DVec3};
use photonvdb::medium::vdb::{GridSummary, Limits, SparseGrid, VdbFile, VolumeSource, f16};
use serde_json::Value;

use super::hash::{Bits, hashes, leaf_voxels};
use super::sampler::check_box_samples;

/// Types of voxel that are listed and refused.
const REFUSED_TYPES: [&str; 4] = ["bool", "mask", "vec3i", "points"];

/// Compares the file with the answer beside it. Says, for each grid, what was done; or what
/// differs.
pub fn check_file(path: &Path) -> Result<Vec<String>, String> {
    let json =
        std::fs::read_to_string(path.with_extension("json")).map_err(|error| error.to_string())?;
    let answer: Value = serde_json::from_str(&json).map_err(|error| error.to_string())?;
    let file = VdbFile::open(path).map_err(|error| error.to_string())?;
    let expected = answer["grids"].as_array().ok_or("no grids in the answer")?;
    same("number of grids", &file.grids().len(), &expected.len())?;

    let mut report = Vec::new();
    for (place, grid) in expected.iter().enumerate() {
        let name = text(&grid["name"]);
        let before = expected[..place].iter().filter(|other| text(&other["name"]) == name).count();
        let mut indices = (0..expected.len()).filter(|&index| file.grids()[index].name == name);
        let index = indices.nth(before).ok_or_else(|| format!("no grid {name:?}"))?;
        let shown = name.chars().take(30).collect::<String>();
        let outcome = check_grid(&file, index, grid)
            .map_err(|difference| format!("grid {shown:?}: {difference}"))?;
        report.push(format!("{shown:?} {outcome}"));
    }
    Ok(report)
}

fn check_grid(file: &VdbFile, index: usize, expected: &Value) -> Result<String, String> {
    let summary = &file.grids()[index];
    check_summary(summary, expected)?;
    if let Some(reason) = &summary.unusable {
        let error =
            file.load_scalar(index, &Limits::default()).err().ok_or("an unusable grid was read")?;
        if !error.to_string().contains(reason) {
            return Err(format!("the error {error} does not give the reason"));
        }
        return Ok(format!("refused: {reason}"));
    }
    let words = match summary.value_type.as_str() {
        "float" => check_scalar::<f32>(file, index, expected, |value| value)?,
        "double" => check_scalar::<f64>(file, index, expected, |value| value as f32)?,
        "half" => check_scalar::<f16>(file, index, expected, f16::to_f32)?,
        "int32" => check_scalar::<i32>(file, index, expected, |value| value as f32)?,
        "int64" => check_scalar::<i64>(file, index, expected, |value| value as f32)?,
        "vec3s" => check_vector::<[f32; 3]>(file, index, expected, |value| value)?,
        "vec3d" => {
            check_vector::<[f64; 3]>(file, index, expected, |value| value.map(|c| c as f32))?
        }
        other => return Err(format!("a grid of {other} was not refused")),
    };
    Ok(format!("{}: {words}", summary.value_type))
}

fn check_summary(summary: &GridSummary, expected: &Value) -> Result<(), String> {
    let tree = text(&expected["type"]);
    let is_points = summary.value_type == "points";
    if !is_points && !tree.starts_with(&format!("Tree_{}_", summary.value_type)) {
        return Err(format!("type {} of {tree}", summary.value_type));
    }
    same("half", &summary.half, &expected["half"].as_bool().unwrap_or(false))?;
    same("class", &summary.class.as_str(), &text(&expected["class"]))?;
    same("map", &summary.map.as_str(), &text(&expected["map"]))?;

    let is_linear = summary.map != "NonlinearFrustumMap";
    let must_be_read = is_linear
        && tree.ends_with("_5_4_3")
        && tree.matches('_').count() == 4
        && !REFUSED_TYPES.contains(&summary.value_type.as_str());
    same("usable", &summary.unusable.is_none(), &must_be_read)?;
    if is_linear {
        let matrix = summary.index_to_world.ok_or("no transform")?;
        check_matrix(matrix, &expected["index_to_world_rowvec"])?;
    }

    // Of trees that cannot be walked, the counts are those the writer left.
    same("active voxels", &Some(summary.active_voxel_count), &expected["active_voxels"].as_u64())?;
    let bbox = summary.active_bbox.map(|bbox| [bbox.min, bbox.max]);
    let expected_bbox =
        expected["bbox"].as_array().map(|corners| [triple(&corners[0]), triple(&corners[1])]);
    same("bbox", &bbox, &expected_bbox)?;
    if must_be_read {
        same("leaves", &Some(summary.leaf_count), &expected["leaf_count"].as_u64())?;
        same("active tiles", &Some(summary.active_tile_count), &expected["active_tiles"].as_u64())?;
        if let Some(background) = summary.background {
            near("background", background, number(&expected["background"]))?;
        }
    }
    Ok(())
}

/// The matrix of the file, element by element.
fn check_matrix(matrix: DAffine3, expected: &Value) -> Result<(), String> {
    let numbers = glam::DMat4::from(matrix).to_cols_array();
    for (index, number_read) in numbers.iter().enumerate() {
        near("matrix", *number_read, number(&expected[index]))?;
    }
    Ok(())
}

fn check_scalar<V: Bits>(
    file: &VdbFile,
    index: usize,
    expected: &Value,
    convert: impl Fn(V) -> f32,
) -> Result<String, String> {
    let stored: SparseGrid<V> =
        file.load_stored(index, &Limits::default()).map_err(|error| error.to_string())?;
    let words = check_values(&stored, expected)?;
    check_sums(&stored, expected)?;

    let scalar = file.load_scalar(index, &Limits::default()).map_err(|error| error.to_string())?;
    let converted = stored.values.iter().map(|&value| convert(value).bits());
    if !converted.eq(scalar.values.iter().map(|value| value.bits())) || scalar.masks != stored.masks
    {
        return Err("the grid as f32 differs".into());
    }
    let background = convert(stored.background).bits();
    same("background as f32", &scalar.background.bits(), &background)?;
    let [between, in_structure] = check_box_samples(&scalar, expected)?;
    Ok(format!("{words}, {between} samples between voxels ({in_structure} as density)"))
}

fn check_vector<V: Bits>(
    file: &VdbFile,
    index: usize,
    expected: &Value,
    convert: impl Fn(V) -> [f32; 3],
) -> Result<String, String> {
    let stored: SparseGrid<V> =
        file.load_stored(index, &Limits::default()).map_err(|error| error.to_string())?;
    let words = check_values(&stored, expected)?;
    let vector = file.load_vector(index, &Limits::default()).map_err(|error| error.to_string())?;
    let converted = stored.values.iter().map(|&value| convert(value).bits());
    if !converted.eq(vector.values.iter().map(|value| value.bits())) {
        return Err("the grid as f32 differs".into());
    }
    Ok(words)
}

/// Every voxel and tile, by the hashes, and the samples.
fn check_values<V: Bits>(grid: &SparseGrid<V>, expected: &Value) -> Result<String, String> {
    let [active, all, tiles] = hashes(grid);
    same(
        "hash of active voxels",
        &format!("{active:x}").as_str(),
        &text(&expected["leaf_on_hash"]),
    )?;
    same("hash of all voxels", &format!("{all:x}").as_str(), &text(&expected["leaf_all_hash"]))?;
    same("hash of tiles", &format!("{tiles:x}").as_str(), &text(&expected["tile_hash"]))?;
    same("leaves", &Some(grid.leaves.len() as u64), &expected["leaf_count"].as_u64())?;
    let active_count = leaf_voxels(grid).filter(|voxel| voxel.1).count() as u64;
    same("active leaf voxels", &Some(active_count), &expected["active_leaf_voxels"].as_u64())?;

    let samples = expected["samples"].as_array().ok_or("no samples")?;
    for sample in samples {
        check_sample(grid, sample)
            .map_err(|difference| format!("sample {}: {difference}", sample["ijk"]))?;
    }
    Ok(format!(
        "{} leaves, {active_count} active voxels, {} samples",
        grid.leaves.len(),
        samples.len()
    ))
}

fn check_sample<V: Bits>(grid: &SparseGrid<V>, sample: &Value) -> Result<(), String> {
    let voxel = triple(&sample["ijk"]);
    let (active, value) = value_at(grid, voxel);
    same("active", &Some(active), &sample["active"].as_bool())?;
    if !sample["value"].is_array() {
        near("value", value.number(), number(&sample["value"]))?;
    }
    let place = grid.index_to_world.transform_point3(DVec3::from_array(voxel.map(f64::from)));
    for (axis, along) in place.to_array().into_iter().enumerate() {
        let expected = number(&sample["world"][axis]);
        // The library multiplies and adds in another order.
        if (along - expected).abs() > 1e-12 * expected.abs().max(1.0) {
            return Err(format!("world {along} instead of {expected}"));
        }
    }
    Ok(())
}

/// The value at a voxel, wherever it is stored, and whether it is active.
pub fn value_at<V: Bits>(grid: &SparseGrid<V>, voxel: [i32; 3]) -> (bool, V) {
    let inside = |origin: &[i32; 3], dim: i64| {
        (0..3).all(|axis| (0..dim).contains(&(i64::from(voxel[axis]) - i64::from(origin[axis]))))
    };
    if let Some(leaf) = grid.leaves.iter().position(|origin| inside(origin, 8)) {
        let place: [usize; 3] =
            std::array::from_fn(|axis| (voxel[axis] - grid.leaves[leaf][axis]) as usize);
        let offset = place[0] << 6 | place[1] << 3 | place[2];
        let active = grid.masks[leaf][offset >> 6] >> (offset & 63) & 1 == 1;
        return (active, grid.values[512 * leaf + offset]);
    }
    match grid.tiles.iter().find(|tile| inside(&tile.origin, i64::from(tile.dim))) {
        Some(tile) => (tile.active, tile.value),
        None => (false, grid.background),
    }
}

/// Smallest and largest finite value and the sum of the finite ones, over active leaf voxels.
fn check_sums<V: Bits>(grid: &SparseGrid<V>, expected: &Value) -> Result<(), String> {
    let active = || leaf_voxels(grid).filter(|voxel| voxel.1).map(|(_, _, value)| value.number());
    let finite = || active().filter(|value| value.is_finite());
    if let (Some(min), Some(max)) = (expected["leaf_min"].as_f64(), expected["leaf_max"].as_f64()) {
        near("min", finite().fold(f64::INFINITY, f64::min), min)?;
        near("max", finite().fold(f64::NEG_INFINITY, f64::max), max)?;
    }
    let nonfinite = active().filter(|value| !value.is_finite()).count() as u64;
    same("values not finite", &Some(nonfinite), &expected["nonfinite"].as_u64())?;

    // The order of the sum is not that of the library.
    let magnitude: f64 = finite().map(f64::abs).sum();
    let difference = finite().sum::<f64>() - number(&expected["leaf_sum"]);
    if difference.abs() > 1e-11 * magnitude {
        return Err(format!("sum differs by {difference}"));
    }
    Ok(())
}

fn same<T: PartialEq + std::fmt::Debug>(what: &str, read: &T, expected: &T) -> Result<(), String> {
    if read == expected {
        Ok(())
    } else {
        Err(format!("{what} is {read:?} instead of {expected:?}"))
    }
}

/// Equal but for the last bit, which the JSON reader does not always get right; NaN equals NaN. The
/// hashes have compared every bit.
fn near(what: &str, read: f64, expected: f64) -> Result<(), String> {
    let is_near = (read - expected).abs() <= 4e-16 * expected.abs();
    if is_near || read == expected || (read.is_nan() && expected.is_nan()) {
        Ok(())
    } else {
        Err(format!("{what} is {read:?} instead of {expected:?}"))
    }
}

pub fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

pub fn number(value: &Value) -> f64 {
    match value.as_str() {
        Some("inf") => f64::INFINITY,
        Some("-inf") => f64::NEG_INFINITY,
        Some(_) => f64::NAN,
        None => value.as_f64().unwrap_or(f64::NAN),
    }
}

fn triple(value: &Value) -> [i32; 3] {
    std::array::from_fn(|axis| {
        value[axis].as_i64().and_then(|along| i32::try_from(along).ok()).unwrap_or(0)
    })
}
