//! `photonvdb new`: a commented scene that renders as it is, around a volume or of a preset.

pub mod args;
mod relative;
mod text;
mod view;
mod volume;

use std::path::Path;

use photonvdb::math::DVec3;
use photonvdb::scene::Preset;

use super::console::say;
use super::error::CliError;
use super::report::is_stdout;
use super::text_file::write_text;
use args::NewArguments;
use relative::relative_to;
use text::{SceneText, line, number, quoted, short};
use view::{View, rounded};
use volume::{Glow, Volume};

/// Scattering of a medium that nothing else is known of: bright smoke, a little forward.
const ALBEDO: f64 = 0.9;
const G: f64 = 0.3;

/// Of one that glows: it must absorb, for heat glows as much as it absorbs.
const GLOWING_ALBEDO: f64 = 0.8;

/// Mean cosine above which few photons fly towards the camera, and those that do count for much.
const SHARP: f64 = 0.7;

/// Share of the lights beside a medium that glows.
const DIMMED: f64 = 0.2;

/// Writes the scene.
pub fn run(arguments: &NewArguments) -> Result<(), CliError> {
    let path = &arguments.scene;
    // A name that is taken is told before any work.
    if path.exists() && !arguments.force && !is_stdout(path) {
        return Err(CliError::Exists { path: path.clone() });
    }
    let scene = match (&arguments.from, arguments.preset) {
        (Some(file), preset) => around_volume(arguments, file, preset)?,
        (None, Some(preset)) => of_preset(arguments, preset),
        (None, None) => return Err(CliError::NothingToStartFrom),
    };
    write_text(path, &scene.join())?;
    if !is_stdout(path) {
        let name = path.display();
        say(&format!(
            "wrote {name}; now: photonvdb render {name} -o {}",
            path.with_extension("exr").display()
        ));
    }
    Ok(())
}

/// A block of a preset's medium, so large that it has the optical depth asked for.
fn of_preset(arguments: &NewArguments, preset: Preset) -> SceneText {
    let depth = arguments.optical_depth;
    let edge = depth / preset.max_sigma_t();
    let half = rounded(DVec3::splat(0.5 * edge), 0.1 * edge);
    let bit = |corner: usize, axis: usize| 2.0 * (corner >> axis & 1) as f64 - 1.0;
    let corners: Vec<DVec3> =
        (0..8).map(|c| half * DVec3::new(bit(c, 0), bit(c, 1), bit(c, 2))).collect();
    let view = View::around(&corners, arguments.up.direction());
    let mut medium = "[medium]\n".to_owned();
    medium += &line("kind", "\"homogeneous\"", "");
    medium += &preset_line(preset);
    let bounds = format!("{{ min = {}, max = {} }}", text::numbers(-half), text::numbers(half));
    medium +=
        &line("bounds", &bounds, &format!("m: optical depth {} from face to face", number(depth)));
    medium += &preset_values(preset, false);
    SceneText {
        opening: opening(&format!("the preset {}", preset.name), &arguments.scene),
        camera: text::camera(&view),
        medium,
        lights: text::lights(&view, 1.0),
        gathering: gathering(Some(preset)),
    }
}

/// A scene that has a volume in its frame.
fn around_volume(
    arguments: &NewArguments,
    file: &Path,
    preset: Option<Preset>,
) -> Result<SceneText, CliError> {
    let volume = Volume::open(file, arguments.grid.as_deref(), arguments.volume.limits())?;
    let view = View::around(&volume.corners, arguments.up.direction());
    let density_scale = volume.density_scale(&view, arguments.optical_depth)?;
    let low = volume.corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = volume.corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let glow = volume.glow((high - low).max_element())?;
    let directory = match arguments.scene.parent() {
        Some(directory) if !is_stdout(&arguments.scene) => directory,
        _ => Path::new(""),
    };
    let grid = volume.density();
    say(&format!(
        "{}: density from grid {:?}, {} active voxels, {} m across",
        file.display(),
        grid.unique_name,
        grid.active_voxel_count,
        short((high - low).max_element())
    ));

    if let Some(crop) = volume.worth_cropping() {
        let file = file.display();
        say(&format!(
            "most of its active voxels are empty; without them it renders faster and sharper: photonvdb convert {file} -o small.vdb --crop {crop}"
        ));
    }

    let mut medium = "[medium]\n".to_owned();
    medium += &line("kind", "\"vdb\"", "");
    medium += &preset.map_or_else(String::new, preset_line);
    medium += &line("file", &quoted(&relative_to(directory, file)?), "");
    medium += &line("density", &quoted(&grid.unique_name), &others(&volume));
    if grid.is_level_set() {
        medium += &line("sdf_to_fog", "true", "it is a level set: filled with fog");
    }
    let meaning = format!(
        "sigma_t [1/m] of value 1: the camera's rays through it have a mean optical depth of {}",
        number(arguments.optical_depth)
    );
    medium += &line("density_scale", &short(density_scale), &meaning);
    medium += &match preset {
        Some(preset) => preset_values(preset, true),
        None => scattering(glow.is_some(), volume.color()),
    };
    medium += &match &glow {
        Some(glow) => glowing(glow),
        None => cold(&volume)?,
    };
    let dimmed = if glow.is_some() { DIMMED } else { 1.0 };
    let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned();
    Ok(SceneText {
        opening: opening(&name, &arguments.scene),
        camera: text::camera(&view),
        medium,
        lights: text::lights(&view, dimmed),
        gathering: gathering(preset),
    })
}

fn opening(source: &str, scene: &Path) -> String {
    let scene = if is_stdout(scene) { Path::new("scene.toml") } else { scene };
    let name = Path::new(scene.file_name().unwrap_or(scene.as_os_str()));
    format!(
        "# Made from {} by photonvdb new, to be changed. Every key: photonvdb schema --markdown\n\
         # photonvdb render {} -o {} --preview {}\n",
        one_line(source),
        one_line(&name.to_string_lossy()),
        one_line(&name.with_extension("exr").to_string_lossy()),
        one_line(&name.with_extension("png").to_string_lossy()),
    )
}

/// What a comment can hold of a name.
fn one_line(name: &str) -> String {
    name.replace(char::is_control, " ")
}

fn others(volume: &Volume) -> String {
    let names = volume.other_grids();
    if names.is_empty() {
        return "the only grid of numbers".into();
    }
    let shown: Vec<_> = names.iter().take(6).map(|name| one_line(name)).collect();
    let more = if names.len() > shown.len() { ", ..." } else { "" };
    format!("other grids of numbers: {}{more}", shown.join(", "))
}

fn scattering(glows: bool, color: Option<&str>) -> String {
    let mut text = String::new();
    match color {
        Some(name) => text += &line("color", &quoted(name), "a grid of RGB that tints the albedo"),
        None if glows => {
            text += &line("albedo", &number(GLOWING_ALBEDO), "the rest is absorbed, and glows");
        }
        None => {
            text += &line(
                "albedo",
                &number(ALBEDO),
                "sigma_s / sigma_t: 0.2 soot, 0.9 smoke, 0.999 cloud; or RGB",
            )
        }
    }
    let phase = format!("{{ kind = \"henyey-greenstein\", g = {} }}", number(G));
    text + &line("phase", &phase, "g: 0 all ways alike, towards 1 forward")
}

fn glowing(glow: &Glow) -> String {
    let (key, name) = &glow.grid;
    let meaning = match *key {
        "temperature" => "its numbers are kelvin: heat glows as a blackbody",
        _ => "flames glow",
    };
    let scale = line(
        "emission_scale",
        &short(glow.emission_scale),
        "as a camera's exposure: lower it where it is too bright",
    );
    line(key, &quoted(name), meaning) + &scale
}

/// A grid of temperatures that are no kelvin, left to the user.
fn cold(volume: &Volume) -> Result<String, CliError> {
    let Some((name, max)) = volume.hottest()?.filter(|(_, max)| *max > 0.0) else {
        return Ok(String::new());
    };
    let comment = format!("values up to {}, which are no kelvin: to make it glow", short(max));
    Ok(format!(
        "# {}# {}",
        line("temperature", &quoted(&name), &comment),
        line(
            "temperature_scale",
            &short(1800.0 / max),
            "and an albedo below 1, for what glows absorbs"
        )
    ))
}

fn preset_line(preset: Preset) -> String {
    line("preset", &quoted(preset.name), preset.about())
}

/// What a preset sets, as comments: of a volume all but how dense it is.
fn preset_values(preset: Preset, is_volume: bool) -> String {
    let mut text = "# It sets, where nothing is said here:\n".to_owned();
    for setting in preset.settings().filter(|line| !(is_volume && line.starts_with("sigma_t"))) {
        text += &format!("#   {setting}\n");
    }
    text
}

/// How light of a preset is gathered, where the default would be the slower way to a smooth picture.
fn gathering(preset: Option<Preset>) -> &'static str {
    match preset {
        Some(preset) if preset.mean_cosine() > SHARP => text::BOUNCE,
        _ => "",
    }
}
