//! The same fog as numbers and as a VDB of one value: every light, every g, the same image but for the noise.

use photonvdb::light::{
    DirectionalLight, Environment, EnvironmentImage, Light, PointLight, QuadLight, SphereLight,
    SpotLight,
};
use photonvdb::math::{DAffine3, DVec3, Rgb};
use photonvdb::medium::grid::DensityGrid;
use photonvdb::medium::vdb::{
    GridToWrite, Limits, SparseGrid, VdbFile, VolumeSource, WriteOptions, write_vdb,
};
use photonvdb::medium::{GridExtinction, Medium};
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::Scene;

use crate::transport_support::*;

const SIGMA_T: f64 = 1.5;
const ALBEDO: f64 = 0.9;

/// What kernels may read differently: a ball cut off by a face is integrated in closed form or by points.
const KERNEL_BIAS: f64 = 0.005;

/// A file of active voxels from -3 to 3 and a background of the same value, so that fog fills the cube to its faces.
fn written() -> VdbFile {
    let leaf = |x: i32, y: i32, z: i32| [8 * x, 8 * y, 8 * z];
    let leaves: Vec<[i32; 3]> = (0..8).map(|n| leaf(-(n >> 2), -(n >> 1 & 1), -(n & 1))).collect();
    let active = |origin: [i32; 3]| {
        let mut mask = [0_u64; 8];
        for offset in 0..512_usize {
            let voxel = [offset >> 6, offset >> 3 & 7, offset & 7];
            let inside = (0..3).all(|axis| (-3..=3).contains(&(origin[axis] + voxel[axis] as i32)));
            mask[offset >> 6] |= u64::from(inside) << (offset & 63);
        }
        mask
    };
    let grid = SparseGrid {
        background: 0.75,
        index_to_world: DAffine3::from_scale(DVec3::splat(0.25)),
        masks: leaves.iter().map(|leaf| active(*leaf)).collect(),
        values: vec![0.75; 512 * leaves.len()],
        leaves,
        tiles: Vec::new(),
    };
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("fog.vdb");
    write_vdb(&path, &[GridToWrite::new("density", &grid)], &WriteOptions::default()).unwrap();
    VdbFile::open(&path).unwrap()
}

fn grid(file: &VdbFile, g: f64) -> Medium {
    let sparse = file.load_scalar(0, &Limits::default()).unwrap();
    let place = sparse.index_to_world;
    let grid = DensityGrid::from_sparse(&sparse);
    grid_medium(GridExtinction::new(grid, place, SIGMA_T / 0.75), Rgb::splat(ALBEDO), g)
}

fn lights() -> Vec<(&'static str, Light)> {
    let position = DVec3::new(-2.0, 1.5, 0.5);
    let pixels = (0..32).map(|i| [((i * 7) % 5) as f32; 3]).collect();
    vec![
        ("point inside", one_watt(DVec3::new(0.3, 0.4, 0.2))),
        ("point outside", Light::Point(PointLight { position, intensity: Rgb::ONE })),
        (
            "spot",
            Light::Spot(SpotLight {
                position,
                axis: -position.normalize(),
                intensity: Rgb::splat(9.0),
                cone_angle: 0.3,
                falloff_angle: 0.2,
            }),
        ),
        (
            "directional",
            Light::Directional(DirectionalLight {
                direction: DVec3::new(-0.4, -0.8, -0.45).normalize(),
                irradiance: Rgb::ONE,
            }),
        ),
        ("sky", white_sky()),
        (
            "painted sky",
            Light::Environment(Environment::Image(Box::new(EnvironmentImage::new(
                8, 4, pixels, 0.4,
            )))),
        ),
        (
            "quad",
            Light::Quad(QuadLight {
                corner: DVec3::new(-1.0, 2.0, -1.0),
                edge_u: DVec3::X * 1.5,
                edge_v: DVec3::Z,
                radiance: Rgb::ONE,
                is_visible: true,
            }),
        ),
        (
            "sphere",
            Light::Sphere(SphereLight {
                center: DVec3::new(1.5, 0.5, 1.2),
                radius: 0.4,
                radiance: Rgb::ONE,
                is_visible: true,
            }),
        ),
    ]
}

/// Mean of each quarter of the image.
fn rendered(medium: Medium, light: Light) -> [Runs; 4] {
    let mut scene: Scene = scene(medium, light, 3000);
    (scene.camera.width, scene.camera.height) = (16, 16);
    scene.estimate.k = 20;
    scene.render.samples_per_pixel = 1;
    over_seeds(&mut scene, |scene| {
        let film = render(scene, &RenderOptions::passes(1), &Unobserved).unwrap().film;
        let mut sums = [0.0; 4];
        for (index, pixel) in film.pixels.iter().enumerate() {
            let quarter =
                index / film.width * 2 / film.height * 2 + index % film.width * 2 / film.width;
            sums[quarter] += pixel.radiance().x * 4.0 / film.pixels.len() as f64;
        }
        sums
    })
}

#[test]
fn every_light_and_g_gives_one_image() {
    let file = written();
    for g in [0.0, 0.6, -0.4] {
        for ((name, light), (_, again)) in lights().into_iter().zip(lights()) {
            let of_grid = rendered(grid(&file, g), light);
            let of_numbers = rendered(grey_fog(CUBE, SIGMA_T, ALBEDO, g), again);
            for (quarter, (a, b)) in of_grid.iter().zip(of_numbers).enumerate() {
                let what = format!("{name}, g {g}, quarter {quarter}, of {:.4}", b.mean);
                a.minus(b).assert_within(0.0, KERNEL_BIAS * b.mean, &what);
            }
        }
    }
}
