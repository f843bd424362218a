//! Density volumes of scenes, on the smoke plume of `media/` and on the small files of `scene_volumes/`.

use std::path::{Path, PathBuf};

use photonvdb::medium::{Bounds, MediumExtinction, Parallelepiped, blackbody_radiance};
use photonvdb::scene::{GridRole, MediumKind, Overrides, Plan, Scene, SceneError};

fn media(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("media").join(name)
}

fn small(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scene_volumes").join(name)
}

/// Loads a scene beside a file `volume.vdb`, with these lines in its medium.
fn load(volume: &Path, medium: &str) -> Result<Scene, SceneError> {
    load_with(volume, medium, &Overrides::default())
}

fn load_with(volume: &Path, medium: &str, overrides: &Overrides) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(volume, folder.path().join("volume.vdb")).unwrap();
    let scene = format!(
        "[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\n\
         [medium]\nkind = \"vdb\"\nfile = \"volume.vdb\"\nalbedo = 0.5\n{medium}\n\
         [[light]]\nkind = \"environment\"\nradiance = 1\n"
    );
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, scene).unwrap();
    Scene::load_with(&path, overrides)
}

/// The error, without the folder it happened in.
fn refusal(volume: &Path, medium: &str) -> String {
    refusal_with(volume, medium, &Overrides::default())
}

fn refusal_with(volume: &Path, medium: &str, overrides: &Overrides) -> String {
    let message = load_with(volume, medium, overrides).unwrap_err().to_string();
    let words = message.split(' ').map(|word| match word.rfind("/volume.vdb") {
        Some(at) => &word[at + 1..],
        None => word,
    });
    let message = words.collect::<Vec<_>>().join(" ");
    message.rsplit_once("scene.toml").unwrap().1.to_owned()
}

fn shape(scene: &Scene) -> Parallelepiped {
    match scene.medium.bounds {
        Bounds::Parallelepiped(shape) => shape,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_volume_is_found_beside_the_scene() {
    let scene = load(&media("smoke_plume.vdb"), "density_scale = 35").unwrap();
    assert_eq!(scene.warnings, Vec::<String>::new());
    let MediumExtinction::Grid(grid) = &scene.medium.extinction else {
        panic!("{:?}", scene.medium.bounds)
    };
    assert_eq!(grid.density_scale(), 35.0);
    assert_eq!(grid.grid().statistics().active_voxel_count, 119_778);
    let plan = Plan::of(&scene);
    assert_eq!((plan.medium, plan.majorants), (MediumKind::Grid, true));
    assert!(plan.expected_stored > 100_000, "{plan}");
}

#[test]
fn the_scene_moves_the_volume_after_the_file() {
    let still = shape(&load(&media("smoke_plume.vdb"), "").unwrap());
    let moved = "transform = { translate = [10, 20, 30], rotate = [0, 90, 0], scale = [1, 2, 1] }";
    let moved = shape(&load(&media("smoke_plume.vdb"), moved).unwrap());
    // About y by 90 degrees, x goes to -z and z to x.
    let turn = |v: glam::DVec3| glam::DVec3::new(v.z, 2.0 * v.y, -v.x);
    let expected = turn(still.corner()) + glam::DVec3::new(10.0, 20.0, 30.0);
    assert!(moved.corner().abs_diff_eq(expected, 1e-12), "{moved:?}");
    for (moved, still) in moved.edges().iter().zip(still.edges()) {
        assert!(moved.abs_diff_eq(turn(still), 1e-12), "{moved:?}");
    }
    let matrix = "transform = { matrix = [0,0,1,10, 0,2,0,20, -1,0,0,30, 0,0,0,1] }";
    let by_matrix = shape(&load(&media("smoke_plume.vdb"), matrix).unwrap());
    assert!(by_matrix.corner().abs_diff_eq(moved.corner(), 1e-12), "{by_matrix:?}");
}

#[test]
fn a_scale_of_zero_is_transparent() {
    let scene = load(&media("smoke_plume.vdb"), "density_scale = 0").unwrap();
    let MediumExtinction::Uniform(uniform) = scene.medium.extinction else { panic!() };
    assert_eq!(uniform.sigma_t, 0.0);
    assert_eq!(Plan::of(&scene).expected_stored, 0);
}

#[test]
fn the_content_of_a_volume_matters() {
    let hash = |name, medium| load(&media(name), medium).unwrap().hash;
    let smoke = hash("smoke_plume.vdb", "");
    assert_eq!(hash("smoke_plume.vdb", "density_scale = 1.0"), smoke);
    assert_ne!(hash("cloud.vdb", ""), smoke);
    assert_ne!(hash("smoke_plume.vdb", "density_scale = 2"), smoke);
    assert_ne!(hash("smoke_plume.vdb", "transform = { scale = 2 }"), smoke);
    assert_ne!(hash("smoke_plume.vdb", "density = \"temperature\""), smoke);
}

#[test]
fn what_a_file_lacks_is_named() {
    assert_eq!(
        refusal(&media("smoke_plume.vdb"), "density = \"dens\""),
        ":8: medium.density: volume.vdb has no grid \"dens\"; \
         name one it holds: \"density\" (float), \"temperature\" (float)"
    );
    assert_eq!(
        refusal(&Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml"), ""),
        ":6: medium.file: volume.vdb is not an OpenVDB file; give a file saved as .vdb"
    );
    assert_eq!(
        refusal(&small("empty.vdb"), ""),
        ":4: medium.density: grid \"density\" of volume.vdb is empty: no density is above 0"
    );
    assert_eq!(
        refusal(&small("no_grids.vdb"), ""),
        ":4: medium.density: volume.vdb has no grid \"density\"; it holds no grids at all"
    );
}

#[test]
fn what_is_no_density_counts_as_zero_and_is_told() {
    let scene = load(&small("nan_inf_neg.vdb"), "").unwrap();
    let [warning] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
    let expected =
        "volume.vdb: 5 values are no densities (1 NaN, 2 infinite, 2 negative); they count as 0";
    assert!(warning.ends_with(expected), "{warning}");
}

/// The colour of a voxel's centre, of a scene whose medium has these lines.
fn color_at(medium: &str, place: [f64; 3]) -> [f64; 3] {
    let scene = load(&small("colored.vdb"), medium).unwrap();
    scene.medium.albedo_at(place.into()).to_array()
}

#[test]
fn a_color_grid_is_chosen_by_name() {
    // The scene's own albedo is 0.5.
    assert_eq!(color_at("color = \"Cd\"", [2.0, 3.0, 4.0]), [0.25, 0.25, 0.4375]);
    assert_eq!(color_at("color = \"half\"", [6.5, 3.0, 4.0]), [0.8125, 0.25, 0.296875]);
    let moved = "color = \"Cd\"\ntransform = { translate = [10, 0, 0] }";
    assert_eq!(color_at(moved, [12.0, 3.0, 4.0]), [0.25, 0.25, 0.4375]);

    let scene = load(&small("colored.vdb"), "color = \"Cd\"").unwrap();
    assert_eq!(scene.warnings, Vec::<String>::new());
    let plan = Plan::of(&scene);
    let used: Vec<_> = plan.grids.iter().map(|grid| (grid.role, grid.name.as_str())).collect();
    assert_eq!(used, [(GridRole::Density, "density"), (GridRole::Color, "Cd")]);
    assert!(plan.chromatic && plan.to_string().contains("color from grid \"Cd\", "), "{plan}");
    let plain = Plan::of(&load(&small("colored.vdb"), "").unwrap());
    assert_eq!(plain.grids.len(), 1, "{plain}");

    let scene = load(&small("colored.vdb"), "color = \"broken\"").unwrap();
    let [warning] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
    let expected =
        "volume.vdb: 4 values are no colours (1 NaN, 1 infinite, 2 negative); they count as 0";
    assert!(warning.ends_with(expected), "{warning}");
}

#[test]
fn a_grid_that_is_no_color_is_refused() {
    assert_eq!(
        refusal(&small("colored.vdb"), "color = \"temperature\""),
        ":8: medium.color: grid \"temperature\" of volume.vdb holds float values where vectors \
         (vec3s or vec3d) are wanted; name another grid"
    );
    assert_eq!(
        refusal(&small("colored.vdb"), "color = \"cd\""),
        ":8: medium.color: volume.vdb has no grid \"cd\"; name one it holds: \"density\" (float), \
         \"Cd\" (vec3s), \"half\" (vec3s), \"broken\" (vec3s), \"temperature\" (float)"
    );
}

/// A volume alone in the dark, with these lines in its medium.
fn load_unlit(volume: &Path, medium: &str) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    let scene = format!(
        "[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\n\
         [medium]\nkind = \"vdb\"\nfile = \"{}\"\n{medium}\n",
        volume.display()
    );
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, scene).unwrap();
    Scene::load(&path)
}

fn emissivity_at(medium: &str, place: [f64; 3]) -> [f64; 3] {
    let scene = load_unlit(&small("colored.vdb"), medium).unwrap();
    assert_eq!(scene.warnings, Vec::<String>::new());
    scene.medium.emissivity_at(place.into()).to_array()
}

#[test]
fn heat_and_flames_are_chosen_by_name() {
    let warm = blackbody_radiance(1500.0);
    let heat = "albedo = 0.75\ndensity_scale = 2\ntemperature = \"temperature\"";
    assert_eq!(emissivity_at(heat, [3.0; 3]), (warm * 0.5).to_array());
    let dim = format!("{heat}\nemission_scale = 0.5");
    assert_eq!(emissivity_at(&dim, [3.0; 3]), (warm * 0.25).to_array());
    let hotter = format!("{heat}\ntemperature_scale = 2\ntemperature_offset = -1000");
    assert_eq!(emissivity_at(&hotter, [3.0; 3]), (blackbody_radiance(2000.0) * 0.5).to_array());
    // Where the colour takes the albedo to 1 nothing is absorbed, and nothing glows.
    let colored = "color = \"Cd\"\ntemperature = \"temperature\"";
    let [red, green, _] = emissivity_at(colored, [4.5, 3.0, 3.0]);
    assert_eq!((red, green), (0.0, 0.5 * warm.y));

    let flame = "albedo = 1\nflame = \"temperature\"\nflame_color = [0.5, 0.25, 0]";
    assert_eq!(emissivity_at(flame, [3.0; 3]), [750.0, 375.0, 0.0]);
    let both = "albedo = 0.5\ntemperature = \"temperature\"\nflame = \"density\"\nflame_color = 2";
    let both = load_unlit(&small("colored.vdb"), both).unwrap();
    let plan = Plan::of(&both);
    let roles: Vec<_> = plan.grids.iter().map(|grid| grid.role).collect();
    assert_eq!(roles, [GridRole::Density, GridRole::Temperature, GridRole::Flame]);
    assert!(plan.to_string().contains("no light but its own: majorants, emission"), "{plan}");
    let plain = Plan::of(&load(&small("colored.vdb"), "").unwrap());
    assert!(plain.to_string().contains("majorants, no emission"), "{plain}");
}

#[test]
fn what_does_not_glow_is_told() {
    let warning = |volume: PathBuf, medium: &str| {
        let scene = load_unlit(&volume, medium).unwrap();
        let [warning] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
        warning.clone()
    };
    let relative = "albedo = 0.5\ntemperature = \"temperature\"";
    assert_eq!(
        warning(media("smoke_plume.vdb"), relative),
        "medium.temperature: no place is hotter than 2 K, and none glows; \
         give temperature_scale (1 to 3 thousand for a grid of 0 to 1)"
    );
    assert_eq!(
        warning(small("colored.vdb"), "albedo = 1\ntemperature = \"temperature\""),
        "the medium does not glow: where it is hot it absorbs nothing; lower its albedo, or name \
         a flame grid"
    );
    // Only a part of the file's density is hot: the other way round flames are cut off.
    let cut = warning(media("fire.vdb"), "albedo = 1\ndensity = \"flame\"\nflame = \"density\"");
    assert!(cut.ends_with("reach beyond the density grid's bounds and are cut off there"), "{cut}");
    let scene = load_unlit(&media("fire.vdb"), "albedo = 1\nflame = \"flame\"").unwrap();
    assert_eq!(scene.warnings, Vec::<String>::new());
}

#[test]
fn a_grid_that_does_not_glow_is_refused() {
    assert_eq!(
        refusal(&small("colored.vdb"), "temperature = \"Cd\""),
        ":8: medium.temperature: grid \"Cd\" of volume.vdb holds vec3s values where numbers are \
         wanted; name another grid"
    );
    assert_eq!(
        refusal(&media("cloud.vdb"), "flame = \"flame\""),
        ":8: medium.flame: volume.vdb has no grid \"flame\"; name one it holds: \"density\" (float)"
    );
}

#[test]
fn strictness_makes_what_is_no_density_an_error() {
    let strict = Overrides { strict: true, ..Overrides::default() };
    assert_eq!(
        refusal_with(&small("nan_inf_neg.vdb"), "", &strict),
        ":4: medium.density: grid \"density\" of volume.vdb: 5 values are no densities \
         (1 NaN, 2 infinite, 2 negative); mend the file, or leave out --strict to count them as 0"
    );
    load_with(&media("smoke_plume.vdb"), "", &strict).unwrap();
}

#[test]
fn a_level_set_is_refused_unless_it_is_to_be_filled() {
    let level_set = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vdb/levelset_mask.vdb");
    let refused = refusal(&level_set, "density = \"surface\"");
    assert!(refused.contains("\"surface\" of volume.vdb is a level set"), "{refused}");
    assert!(refused.contains("--sdf-to-fog, or medium.sdf_to_fog = true"), "{refused}");

    let filled = |medium: &str, overrides: &Overrides| {
        let scene = load_with(&level_set, medium, overrides).unwrap();
        let MediumExtinction::Grid(grid) = &scene.medium.extinction else { panic!() };
        let statistics = grid.grid().statistics();
        assert_eq!((statistics.active_voxel_count, statistics.max_density), (33_371, 1.0));
        scene
    };
    let by_flag = Overrides { sdf_to_fog: Some(true), ..Overrides::default() };
    let by_key = filled("sdf_to_fog = true", &Overrides::default());
    assert_eq!(by_key.warnings, Vec::<String>::new());
    assert_eq!(filled("density = \"surface\"", &by_flag).warnings, Vec::<String>::new());
    assert_eq!(filled("", &by_flag).hash, by_key.hash);

    let fog = load_with(&media("smoke_plume.vdb"), "", &by_flag).unwrap();
    assert!(
        fog.warnings[0].ends_with("is no level set and is used as it is"),
        "{:?}",
        fog.warnings
    );
}

#[test]
fn memory_is_limited_on_request() {
    let limited = |max| Overrides { max_volume_memory: Some(max), ..Overrides::default() };
    let refused = refusal_with(&media("smoke_plume.vdb"), "", &limited(100_000));
    assert!(refused.contains("the limit on memory is 97.7 KiB"), "{refused}");
    assert!(refused.contains("--max-volume-memory"), "{refused}");
    load_with(&media("smoke_plume.vdb"), "", &limited(100 << 20)).unwrap();
}

#[test]
fn the_majorant_is_finite_at_any_scale() {
    for scale in ["1e-30", "1e30"] {
        let scene = load(&media("smoke_plume.vdb"), &format!("density_scale = {scale}")).unwrap();
        let MediumExtinction::Grid(grid) = &scene.medium.extinction else { panic!() };
        assert!(grid.max_sigma_t().is_finite());
    }
}
