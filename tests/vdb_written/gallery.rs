//! The grids of the files of this folder: leaves and tiles of every kind, in small.

use std::io::Cursor;
use std::path::Path;

use photonvdb::math::{DAffine3, DVec3};
use photonvdb::medium::vdb::{
    GridClass, GridToWrite, MetadataValue, SparseGrid, Tile, VdbWriter, WriteCompression,
    WriteOptions,
};

/// Name and bytes of every file.
pub fn files() -> Vec<(String, Vec<u8>)> {
    use WriteCompression::{ActiveMask, Blosc, None, Zip};
    let named = |compression| match compression {
        None => "none",
        ActiveMask => "mask",
        Zip => "zip",
        Blosc => "blosc",
    };
    let mut files = Vec::new();
    for compression in [ActiveMask, Zip, Blosc] {
        for half in [false, true] {
            let name = format!("{}{}.vdb", named(compression), if half { "_half" } else { "" });
            files.push((name, many_grids(&WriteOptions { compression, half })));
        }
    }
    // Without a mask every node has all its values: one grid of few nodes is enough.
    files.push(("none_half.vdb".into(), one_leaf(&WriteOptions { compression: None, half: true })));
    files
}

/// Grids of numbers: a fog with leaves and tiles of all sizes, a level set, one of extreme values.
pub fn scalars() -> [SparseGrid<f32>; 3] {
    let uniform = DAffine3 {
        translation: DVec3::new(0.5, -1e5, 3.0),
        ..DAffine3::from_scale(DVec3::splat(0.1))
    };
    let mut fog = empty(0.0, uniform);
    let ball = |voxel: [i32; 3]| 1.0 - length(voxel, 8) / 11.5;
    for origin in origins(0, 16).chain([[-8; 3]]) {
        push_leaf(&mut fog, origin, |voxel| (ball(voxel).max(0.0), ball(voxel) > 0.0));
    }
    let tile = |origin, dim, value, active| Tile { origin, dim, value, active };
    fog.tiles = vec![
        tile([16, 0, 8], 8, 0.25, true),
        tile([16, 8, 8], 8, 0.5, false),
        tile([128, 0, 0], 128, 1e-3, true),
        tile([4096, -4096, 0], 4096, 0.1, true),
        tile([-8192, 0, 0], 4096, 0.7, false),
    ];

    let turned = DAffine3::from_rotation_y(0.25) * DAffine3::from_scale(DVec3::splat(0.05));
    let mut surface = empty(0.15, turned);
    for origin in origins(-16, 0) {
        push_leaf(&mut surface, origin, |voxel| {
            let distance = 0.05 * (length(voxel, -8) - 6.0);
            (distance.clamp(-0.15, 0.15), distance.abs() < 0.15)
        });
    }

    let mut extremes = empty(2.0, DAffine3::from_scale(DVec3::new(1.0, -2.0, 0.25)));
    let numbers = [0.0, -0.0, f32::INFINITY, -f32::INFINITY, 1e-40, 65_519.0, 65_520.0, 2049.0];
    let number = |place: usize| numbers[place % numbers.len()];
    // Inactive values: the negative, one other, it and the background, two others, many.
    let inactive: [fn(usize) -> f32; 5] = [
        |_| -2.0,
        |_| 5.0,
        |place| if place % 3 == 0 { 2.0 } else { 5.0 },
        |place| if place % 3 == 0 { 6.0 } else { 5.0 },
        |place| place as f32,
    ];
    for (leaf, inactive) in inactive.into_iter().enumerate() {
        let origin = [1 << 30, -(1 << 30), 8 * leaf as i32];
        push_leaf(&mut extremes, origin, |voxel| {
            let place = (0..3).fold(0, |place, axis| place << 3 | (voxel[axis] & 7) as usize);
            if place % 2 == 0 { (number(place / 2), true) } else { (inactive(place), false) }
        });
    }
    [fog, surface, extremes]
}

fn many_grids(options: &WriteOptions) -> Vec<u8> {
    let [fog, surface, extremes] = scalars();
    let velocity = velocity();
    let mut wind = GridToWrite {
        class: GridClass::Staggered,
        ..GridToWrite::new("Geschwindigkeit (größte)", &velocity)
    };
    let kind = MetadataValue::text("contravariant relative");
    wind.metadata.insert("vector_type".into(), kind);
    wind.metadata.insert("frame".into(), MetadataValue::float(24.5));
    written(
        &[
            GridToWrite { class: GridClass::FogVolume, ..GridToWrite::new("density", &fog) },
            GridToWrite { class: GridClass::LevelSet, ..GridToWrite::new("surface", &surface) },
            wind,
            GridToWrite::new("density", &extremes),
        ],
        options,
    )
}

fn one_leaf(options: &WriteOptions) -> Vec<u8> {
    let mut grid = empty(-1.0, DAffine3::IDENTITY);
    push_leaf(&mut grid, [-8, 0, 120], |voxel| (length(voxel, 0) / 100.0, voxel[0] % 2 == 0));
    written(&[GridToWrite::new("density", &grid)], options)
}

fn velocity() -> SparseGrid<[f32; 3]> {
    let transform = DAffine3 {
        translation: DVec3::new(-1.0, 0.0, 1e-3),
        ..DAffine3::from_scale(DVec3::new(0.1, 0.2, 0.3))
    };
    let mut grid = empty([0.0; 3], transform);
    for origin in [[0, 0, 0], [0, 0, 8]] {
        push_leaf(&mut grid, origin, |voxel| {
            let value = voxel.map(|along| along as f32 / 7.0);
            (if voxel[2] < 12 { value } else { [0.0, 0.0, 1.0] }, voxel[2] < 12)
        });
    }
    let value = [0.1, -0.2, 1e-7];
    grid.tiles = vec![
        Tile { origin: [8, 8, 8], dim: 8, value, active: true },
        Tile { origin: [-128, 0, 128], dim: 128, value, active: true },
    ];
    grid
}

fn written(grids: &[GridToWrite<'_>], options: &WriteOptions) -> Vec<u8> {
    let names: Vec<&str> = grids.iter().map(|grid| grid.name).collect();
    let output = Cursor::new(Vec::new());
    let mut writer = VdbWriter::new(output, Path::new("gallery"), &names, options).unwrap();
    grids.iter().for_each(|grid| drop(writer.write_grid(grid).unwrap()));
    writer.finish().unwrap().into_inner()
}

fn empty<V>(background: V, index_to_world: DAffine3) -> SparseGrid<V> {
    SparseGrid {
        background,
        index_to_world,
        leaves: Vec::new(),
        masks: Vec::new(),
        values: Vec::new(),
        tiles: Vec::new(),
    }
}

/// Adds a leaf with the value of each voxel, and whether it is active.
fn push_leaf<V>(grid: &mut SparseGrid<V>, origin: [i32; 3], value: impl Fn([i32; 3]) -> (V, bool)) {
    let mut mask = [0; 8];
    for offset in 0..512 {
        let place = [offset >> 6, offset >> 3 & 7, offset & 7];
        let voxel = std::array::from_fn(|axis| origin[axis] + place[axis] as i32);
        let (value, active) = value(voxel);
        grid.values.push(value);
        mask[offset >> 6] |= u64::from(active) << (offset & 63);
    }
    grid.leaves.push(origin);
    grid.masks.push(mask);
}

/// Origins of the leaves of a cube.
fn origins(from: i32, to: i32) -> impl Iterator<Item = [i32; 3]> {
    let along = move || (from..to).step_by(8);
    along().flat_map(move |x| along().flat_map(move |y| along().map(move |z| [x, y, z])))
}

/// Distance of a voxel from the one at `centre` along all axes; the square root is rounded the same
/// everywhere.
fn length(voxel: [i32; 3], centre: i32) -> f32 {
    (voxel.map(|along| (along - centre).pow(2)).iter().sum::<i32>() as f32).sqrt()
}
