//! An OpenVDB file: its grids, their places and values, and whether each can be rendered as a density.

use std::fmt;
use std::path::Path;

use photonvdb::math::{DAffine3, DVec3};
use photonvdb::medium::vdb::{GridSummary, Limits, VdbFile, VolumeSource};
use serde::Serialize;

use super::grid_values::{Figure, GridValues, read_values};
use crate::cli::error::CliError;
use crate::cli::{print_json, print_to_stdout};

/// Shows the grids of the file at `path`.
pub fn inspect(path: &Path, as_json: bool, limits: &Limits) -> Result<(), CliError> {
    let file = VdbFile::open_within(path, limits)?;
    let grids = file.grids().iter().enumerate();
    let grids: Vec<Grid> =
        grids.map(|(index, summary)| Grid::of(&file, index, summary, limits)).collect();
    if as_json {
        return print_json(&Listing { grids, damage: file.damage() });
    }
    let plural = if grids.len() == 1 { "" } else { "s" };
    let mut text = format!("{}: {} grid{plural}\n", path.display(), grids.len());
    text.extend(grids.iter().map(Grid::describe));
    if let Some(damage) = file.damage() {
        text += &format!("\ndamaged beyond these grids: {damage}\n");
    }
    print_to_stdout(&text)
}

/// What `--json` shows.
#[derive(Serialize)]
struct Listing {
    grids: Vec<Grid>,
    /// Why the list is not complete, if it is not.
    damage: Option<String>,
}

/// One grid, as `--json` shows it. What is unknown is `null`.
#[derive(Serialize)]
struct Grid {
    /// As scenes name it: `density[1]` for the second grid of that name.
    name: String,
    #[serde(rename = "type")]
    value_type: String,
    class: String,
    half: bool,
    compression: String,
    map: String,
    /// Rows of the matrix that a row vector is multiplied with, as OpenVDB stores it.
    index_to_world: Option<[[f64; 4]; 4]>,
    /// Length of the edges of a voxel \[world units\].
    voxel_size: Option<[f64; 3]>,
    background: Option<f64>,
    active_voxels: u64,
    active_tiles: u64,
    leaf_count: u64,
    /// Lowest and highest active voxel.
    bbox_index: Option<[[i32; 3]; 2]>,
    /// The box around those voxels' positions \[world units\].
    bbox_world: Option<[[f64; 3]; 2]>,
    #[serde(flatten)]
    values: GridValues,
    memory_bytes: u64,
    /// Whether it can be rendered as a density.
    usable: bool,
    /// Why not.
    reason: Option<String>,
    /// Keys of a scene's medium that can name the grid.
    usable_as: Vec<&'static str>,
}

impl Grid {
    fn of(file: &VdbFile, index: usize, summary: &GridSummary, limits: &Limits) -> Self {
        let (values, unreadable) = match read_values(file, index, summary, limits) {
            Ok(values) => (values, None),
            Err(error) => (GridValues::default(), Some(error.to_string())),
        };
        let reason = refusal(summary).or(unreadable);
        let bbox = summary.active_bbox.map(|bbox| [bbox.min, bbox.max]);
        Self {
            name: summary.unique_name.clone(),
            value_type: summary.value_type.clone(),
            class: summary.class.clone(),
            half: summary.half,
            compression: summary.compression.clone(),
            map: summary.map.clone(),
            index_to_world: summary.index_to_world.as_ref().map(row_vector_matrix),
            voxel_size: summary.index_to_world.as_ref().map(voxel_size),
            background: summary.background,
            active_voxels: summary.active_voxel_count,
            active_tiles: summary.active_tile_count,
            leaf_count: summary.leaf_count,
            bbox_index: bbox,
            bbox_world: summary.index_to_world.zip(bbox).map(|(map, bbox)| world_box(&map, bbox)),
            values,
            memory_bytes: summary.memory_bytes,
            usable: reason.is_none(),
            usable_as: uses(summary, reason.is_none()),
            reason,
        }
    }

    /// A paragraph.
    fn describe(&self) -> String {
        let half = if self.half { ", saved as half" } else { "" };
        let mut lines = vec![
            format!("\n{}", if self.name.is_empty() { "(no name)" } else { &self.name }),
            format!("{}, {}{half}, compression {}", self.value_type, self.class, self.compression),
            format!(
                "{} active voxels in {} leaves and {} tiles, {:.1} MiB in memory",
                self.active_voxels,
                self.leaf_count,
                self.active_tiles,
                self.memory_bytes as f64 / f64::from(1 << 20)
            ),
        ];
        lines.extend(self.describe_values());
        if let Some(size) = self.voxel_size {
            lines.push(format!("voxel size {}", size.map(short).join(" x ")));
        }
        if let Some([min, max]) = self.bbox_index {
            let [min, max] = [min, max].map(|voxel| voxel.map(|i| i.to_string()).join(" "));
            lines.push(format!("index bounds {min} to {max}"));
        }
        if let Some([min, max]) = self.bbox_world {
            let [min, max] = [min, max].map(|corner| corner.map(short).join(" "));
            lines.push(format!("world bounds {min} to {max}"));
        }
        lines.push(match (&self.reason, &self.usable_as[..]) {
            (None, uses) => format!("can be rendered: {}", uses.join(", ")),
            (Some(_), ["color"]) => "can be rendered as color".into(),
            (Some(reason), _) => format!("cannot be rendered: {reason}"),
        });
        lines.join("\n  ") + "\n"
    }
}

impl Grid {
    fn describe_values(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let values = &self.values;
        if let (Some(min), Some(max), Some(mean)) = (values.min, values.max, values.mean) {
            let background =
                self.background.map_or_else(String::new, |b| format!(", background {}", short(b)));
            lines.push(format!("values {min} to {max}, mean {mean}{background}"));
        }
        if values.nonfinite_voxels > 0 {
            lines.push(format!("{} voxels are NaN or infinite", values.nonfinite_voxels));
        }
        // A level set is negative inside, a velocity anywhere.
        if values.negative_voxels > 0 && self.usable {
            lines.push(format!("{} voxels are negative", values.negative_voxels));
        }
        lines
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(value) => f.write_str(&short(*value)),
            Self::Vector(values) => write!(f, "({})", values.map(short).join(", ")),
        }
    }
}

/// What a scene can use a grid for.
fn uses(summary: &GridSummary, is_density: bool) -> Vec<&'static str> {
    let is_vector = matches!(summary.value_type.as_str(), "vec3s" | "vec3d");
    if is_density {
        vec!["density", "temperature", "flame"]
    } else if is_vector && summary.unusable.is_none() {
        vec!["color"]
    } else {
        Vec::new()
    }
}

/// Why a grid cannot serve as a density, as far as its summary tells.
fn refusal(summary: &GridSummary) -> Option<String> {
    if summary.unusable.is_some() {
        return summary.unusable.clone();
    }
    if !summary.is_usable_scalar() {
        let value_type = &summary.value_type;
        let use_of_vectors =
            if value_type.starts_with("vec3") { " (it may be a scene's color)" } else { "" };
        return Some(format!(
            "it holds {value_type} values, and a density is one number a voxel{use_of_vectors}"
        ));
    }
    let level_set = "it is a level set, which holds distances to a surface; \
                     render with --sdf-to-fog to fill it with fog";
    summary.is_level_set().then(|| level_set.to_string())
}

fn row_vector_matrix(map: &DAffine3) -> [[f64; 4]; 4] {
    let axis = |axis: DVec3| [axis.x, axis.y, axis.z, 0.0];
    let [x, y, z] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    let origin = map.translation;
    [axis(x), axis(y), axis(z), [origin.x, origin.y, origin.z, 1.0]]
}

fn voxel_size(map: &DAffine3) -> [f64; 3] {
    [map.matrix3.x_axis.length(), map.matrix3.y_axis.length(), map.matrix3.z_axis.length()]
}

/// The box around the eight corners of an index box, carried to the world.
fn world_box(map: &DAffine3, bbox: [[i32; 3]; 2]) -> [[f64; 3]; 2] {
    let corners = (0..8).map(|corner: usize| {
        let end = |axis: usize| f64::from(bbox[corner >> axis & 1][axis]);
        map.transform_point3(DVec3::new(end(0), end(1), end(2)))
    });
    let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (min, max) = corners.fold(empty, |(min, max), at| (min.min(at), max.max(at)));
    [min.to_array(), max.to_array()]
}

/// Six digits of a number, with an exponent where it is very large or very small.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    let is_plain = rounded == 0.0 || (1e-4..1e9).contains(&rounded.abs());
    if is_plain || !rounded.is_finite() { rounded.to_string() } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let expected = [(0.1_f32 as f64, "0.1"), (-3.4e38, "-3.4e38"), (0.0, "0"), (1e-5, "1e-5")];
        for (value, text) in expected {
            assert_eq!(short(value), text);
        }
        assert_eq!(short(123_456_789.0), "123457000");
        assert_eq!(short(f64::NAN), "NaN");
    }

    #[test]
    fn a_turned_box_is_enclosed() {
        let quarter = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let [min, max] = world_box(&quarter, [[0, 0, 0], [3, 1, 2]]);
        let difference = |a: [f64; 3], b: [f64; 3]| (0..3).map(move |i| (a[i] - b[i]).abs());
        assert!(difference(min, [-1.0, 0.0, 0.0]).all(|d| d < 1e-12), "{min:?}");
        assert!(difference(max, [0.0, 3.0, 2.0]).all(|d| d < 1e-12), "{max:?}");
        assert_eq!(
            row_vector_matrix(&DAffine3::from_translation(DVec3::X))[3],
            [1.0, 0.0, 0.0, 1.0]
        );
    }
}
