//! What a volume asks of a scene: its grids, where it is, and how dense.

use std::path::Path;

use photonvdb::math::{DAffine3, DVec3, Ray, Span, max_channel};
use photonvdb::medium::grid::{BrickPrecision, DensityGrid};
use photonvdb::medium::vdb::{
    GridSummary, Limits, SparseGrid, VdbFile, VolumeSource, find_density,
    find_density_or_level_set, fog_of_level_set, sanitize_density,
};
use photonvdb::medium::{Bounds, Extinction, GridExtinction, blackbody_xyz};

use super::view::View;
use crate::cli::error::CliError;

/// Words in the names of grids that are densities, and of grids that are not.
const DENSITY_WORDS: [&str; 9] =
    ["density", "smoke", "soot", "cloud", "fog", "steam", "vapor", "mist", "dust"];
const OTHER_WORDS: [&str; 11] = [
    "temp",
    "heat",
    "flame",
    "fire",
    "fuel",
    "burn",
    "react",
    "vel",
    "press",
    "shadow",
    "divergence",
];

/// What is hotter glows visibly \[K\]; grids of smaller numbers are no kelvin.
const LEAST_KELVIN: f64 = 700.0;

/// What a camera set for a sun of a few W/m^2 sees of the hottest place \[W/(m^2 sr)\].
const GLOW_RADIANCE: f64 = 10.0;

/// Rays along either side of the frame that measure the depth.
const RAYS_A_SIDE: usize = 64;

/// Rays of a smaller share of the greatest depth only graze the medium.
const GRAZING: f64 = 0.01;

/// The largest number that a scene may hold.
const LARGEST_SCALE: f64 = 1e30;

/// A volume and how a scene may use it.
pub struct Volume {
    file: VdbFile,
    limits: Limits,
    density: usize,
    extinction: GridExtinction,
    /// Index space that densities above 0 take, and one voxel beyond.
    seen: Option<[[f64; 3]; 2]>,
    /// Bounds of what is seen of it, one voxel beyond densities above 0.
    pub corners: Vec<DVec3>,
    /// Extinction of density 1 while depths are measured, so that no ray is opaque \[1/m\].
    trial_scale: f64,
}

/// Light of a volume's own: keys of `[medium]`.
pub struct Glow {
    /// Key and name of the grid.
    pub grid: (&'static str, String),
    pub emission_scale: f64,
}

impl Volume {
    /// Opens a file and reads its density.
    pub fn open(path: &Path, grid: Option<&str>, limits: Limits) -> Result<Self, CliError> {
        let file = VdbFile::open_within(path, &limits)?;
        let density = choose_density(&file, grid)?;
        let summary = &file.grids()[density];
        let unusable = |reason: String| CliError::UnusableGrid {
            grid: summary.unique_name.clone(),
            path: path.into(),
            reason,
        };
        let mut sparse = file.load_scalar(density, &limits)?;
        if summary.is_level_set() {
            sparse = fog_of_level_set(sparse);
        }
        sanitize_density(&mut sparse);
        let grid =
            DensityGrid::build(&sparse, BrickPrecision::Single, &file.limits_beside(&limits))
                .map_err(|error| unusable(error.to_string()))?;
        let trial_scale = trial_scale(&grid, &sparse.index_to_world);
        let extinction = GridExtinction::new(grid, sparse.index_to_world, trial_scale);
        let Some(Bounds::Parallelepiped(shape)) = extinction.bounds() else {
            return Err(unusable("no density is above 0".into()));
        };
        let bit = |corner: usize, axis: usize| corner >> axis & 1;
        let seen = seen_box(&sparse);
        let corners = match seen {
            Some(ends) => {
                let corner = |c| DVec3::from_array([0, 1, 2].map(|axis| ends[bit(c, axis)][axis]));
                (0..8).map(|c| sparse.index_to_world.transform_point3(corner(c))).collect()
            }
            None => {
                let along = |c: usize, axis: usize| shape.edges()[axis] * bit(c, axis) as f64;
                let corner = |c| shape.corner() + along(c, 0) + along(c, 1) + along(c, 2);
                (0..8).map(corner).collect()
            }
        };
        Ok(Self { file, limits, density, extinction, seen, corners, trial_scale })
    }

    /// The grid of densities.
    pub fn density(&self) -> &GridSummary {
        &self.file.grids()[self.density]
    }

    /// The voxels to keep, as `photonvdb convert --crop` takes them, where most of those that are active are empty.
    pub fn worth_cropping(&self) -> Option<String> {
        let [low, high] = self.seen?;
        let active = self.density().active_bbox?;
        let longest = |edge: &dyn Fn(usize) -> f64| (0..3).map(edge).fold(0.0, f64::max);
        let seen = longest(&|axis| high[axis] - low[axis]);
        let all = longest(&|axis| f64::from(active.max[axis]) - f64::from(active.min[axis]));
        let ends = [low, high].concat();
        let ends: Vec<String> = ends.iter().map(|end| format!("{end:.0}")).collect();
        (seen < 0.5 * all).then(|| ends.join(","))
    }

    /// Other grids of numbers, as scenes name them.
    pub fn other_grids(&self) -> Vec<&str> {
        let others =
            self.file.grids().iter().enumerate().filter(|(index, _)| *index != self.density);
        let usable = others.filter(|(_, grid)| grid.is_usable_scalar());
        usable.map(|(_, grid)| grid.unique_name.as_str()).collect()
    }

    /// The name of a grid of colours.
    pub fn color(&self) -> Option<&str> {
        let is_color = |grid: &&GridSummary| {
            let name = grid.name.to_lowercase();
            matches!(grid.value_type.as_str(), "vec3s" | "vec3d")
                && grid.unusable.is_none()
                && (name == "cd"
                    || ["color", "colour", "albedo"].iter().any(|word| name.contains(word)))
        };
        self.file.grids().iter().find(is_color).map(|grid| grid.unique_name.as_str())
    }

    /// The `density_scale` \[1/m per value\] at which the camera's rays have that mean optical depth. Rays that miss the
    /// medium or only graze it do not count.
    pub fn density_scale(&self, view: &View, optical_depth: f64) -> Result<f64, CliError> {
        let depths: Vec<f64> = view.rays(RAYS_A_SIDE).iter().map(|ray| self.depth(ray)).collect();
        let deepest = depths.iter().copied().fold(0.0, f64::max);
        let (sum, count) = depths
            .into_iter()
            .filter(|depth| *depth > GRAZING * deepest)
            .fold((0.0, 0_u32), |(sum, count), depth| (sum + depth, count + 1));
        let scale = self.trial_scale * optical_depth * f64::from(count) / sum;
        let reason = match scale {
            _ if !scale.is_finite() => "no ray of the camera meets it",
            _ if scale > LARGEST_SCALE => "its densities are as good as 0",
            _ => return Ok(scale),
        };
        Err(CliError::UnusableGrid {
            grid: self.density().unique_name.clone(),
            path: self.file.name().into(),
            reason: reason.into(),
        })
    }

    fn depth(&self, ray: &Ray) -> f64 {
        max_channel(self.extinction.optical_depth(ray, Span::new(0.0, f64::INFINITY)))
    }

    /// How it glows, if it has a grid of temperatures in kelvin or else of flames.
    ///
    /// `size` is the extent of the medium \[m\].
    pub fn glow(&self, size: f64) -> Result<Option<Glow>, CliError> {
        if let Some((name, max)) = self.hottest()?.filter(|(_, max)| *max >= LEAST_KELVIN) {
            let brightest = blackbody_xyz(max).y;
            let grid = ("temperature", name);
            return Ok(Some(Glow { grid, emission_scale: GLOW_RADIANCE / brightest }));
        }
        let Some(index) = self.named(&["flame", "fire"]) else { return Ok(None) };
        let max = self.max(index)?;
        let grid = ("flame", self.file.grids()[index].unique_name.clone());
        // Flames fill a tenth of the medium or so.
        let scale = GLOW_RADIANCE / (0.1 * size * max);
        Ok(scale.is_finite().then_some(Glow { grid, emission_scale: scale }))
    }

    /// The grid of temperatures and its largest value.
    pub fn hottest(&self) -> Result<Option<(String, f64)>, CliError> {
        let Some(index) = self.named(&["temp", "heat"]) else { return Ok(None) };
        Ok(Some((self.file.grids()[index].unique_name.clone(), self.max(index)?)))
    }

    fn named(&self, words: &[&str]) -> Option<usize> {
        let grids = self.file.grids();
        (0..grids.len()).find(|&index| {
            index != self.density
                && grids[index].is_usable_scalar()
                && contains(&grids[index].name, words)
        })
    }

    /// The largest value of an active voxel.
    fn max(&self, index: usize) -> Result<f64, CliError> {
        let mut sparse: SparseGrid<f32> = self.file.load_scalar(index, &self.limits)?;
        sanitize_density(&mut sparse);
        let tiles = sparse.tiles.iter().map(|tile| tile.value);
        let values = sparse.values.iter().copied().chain(tiles);
        Ok(values.fold(0.0, f32::max).into())
    }
}

/// The box about the densities above 0, one voxel beyond them, in index space: files often hold many active voxels of density 0.
/// `None` where the background has a density, which fills whatever the active voxels span.
fn seen_box(grid: &SparseGrid<f32>) -> Option<[[f64; 3]; 2]> {
    if grid.background > 0.0 {
        return None;
    }
    let mut ends = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let mut include = |low: [f64; 3], high: [f64; 3]| {
        for axis in 0..3 {
            ends[0][axis] = ends[0][axis].min(low[axis] - 1.0);
            ends[1][axis] = ends[1][axis].max(high[axis] + 1.0);
        }
    };
    let leaves = grid.leaves.iter().zip(&grid.masks).zip(grid.values.chunks_exact(512));
    for ((origin, mask), values) in leaves {
        for (offset, _) in values.iter().enumerate().filter(|(_, value)| **value > 0.0) {
            if mask[offset >> 6] >> (offset & 63) & 1 == 1 {
                let voxel = [offset >> 6, offset >> 3 & 7, offset & 7];
                let place =
                    std::array::from_fn(|axis| f64::from(origin[axis]) + voxel[axis] as f64);
                include(place, place);
            }
        }
    }
    for tile in grid.tiles.iter().filter(|tile| tile.active && tile.value > 0.0) {
        let low = tile.origin.map(f64::from);
        include(low, low.map(|c| c + f64::from(tile.dim) - 1.0));
    }
    ends[0].iter().all(|end| end.is_finite()).then_some(ends)
}

/// A scale at which no way through a grid is deeper than 1 \[1/m per value\].
fn trial_scale(grid: &DensityGrid, index_to_world: &DAffine3) -> f64 {
    let Some((min, max)) = grid.render_bounds() else { return 1.0 };
    let [x, y, z] = (max - min).to_array();
    let edges = index_to_world.matrix3;
    let way =
        (edges.x_axis * x).length() + (edges.y_axis * y).length() + (edges.z_axis * z).length();
    1.0 / (way * f64::from(grid.statistics().max_density))
}

/// The grid named, or the one that looks most like a density.
fn choose_density(file: &VdbFile, name: Option<&str>) -> Result<usize, CliError> {
    if let Some(name) = name {
        return Ok(find_density_or_level_set(file, name, true)?);
    }
    let found = find_density(file, "density", false);
    let grids = file.grids();
    let rank = |index: &usize| {
        let grid = &grids[*index];
        let is_density = contains(&grid.name, &DENSITY_WORDS);
        (!grid.is_level_set(), is_density, grid.active_voxel_count)
    };
    let fits = |index: &usize| {
        let grid = &grids[*index];
        grid.is_usable_scalar()
            && grid.active_voxel_count > 0
            && !contains(&grid.name, &OTHER_WORDS)
    };
    match found {
        Ok(index) => Ok(index),
        Err(error) => {
            let best = (0..grids.len()).filter(fits).max_by_key(rank);
            let has_numbers = grids.iter().any(GridSummary::is_usable_scalar);
            best.ok_or_else(|| match has_numbers || grids.is_empty() {
                true => error.into(),
                false => CliError::NoDensity { path: file.name().into() },
            })
        }
    }
}

fn contains(name: &str, words: &[&str]) -> bool {
    let name = name.to_lowercase();
    words.iter().any(|word| name.contains(word))
}
