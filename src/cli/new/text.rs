//! The scene as it is written: TOML with a comment wherever there is something to choose.

use std::fmt::Write as _;

use photonvdb::math::DVec3;

use super::view::{VERTICAL_FOV, View};

/// A scene in parts, each the text of a section.
pub struct SceneText {
    pub opening: String,
    pub camera: String,
    pub medium: String,
    pub lights: String,
    /// What the scene says of gathering, if anything.
    pub gathering: &'static str,
}

impl SceneText {
    /// All of it.
    pub fn join(&self) -> String {
        let Self { opening, camera, medium, lights, gathering } = self;
        format!("{opening}\n{camera}\n{medium}\n{lights}\n{PHOTONS}{gathering}")
    }
}

/// The count stays open, so that a target error or a time budget may choose it.
const PHOTONS: &str = "\
[photons]
# count = 1_000_000             # a pass; where it is left open, --target-error and --time-budget choose
";

/// The section for a medium whose droplets throw light forward.
pub const BOUNCE: &str = "
[render]
gather = \"bounce\"               # light is thrown forward: paths that bounce are smoother than photons alone
";

/// A line of a key with its comment, aligned where the value is short.
pub fn line(key: &str, value: &str, comment: &str) -> String {
    let setting = format!("{key} = {value}");
    match comment {
        "" => format!("{setting}\n"),
        _ if setting.len() > 70 => format!("# {comment}\n{setting}\n"),
        _ => format!("{setting:31} # {comment}\n"),
    }
}

/// A number, written so that it reads as one of TOML.
pub fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A number of three digits.
pub fn short(value: f64) -> String {
    number(format!("{value:.2e}").parse().unwrap_or(value))
}

/// Three numbers.
pub fn numbers(values: DVec3) -> String {
    format!("[{}]", values.to_array().map(number).join(", "))
}

/// Text in quotes, escaped where need be.
pub fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// The section of a camera.
pub fn camera(view: &View) -> String {
    let mut text = "[camera]\n".to_owned();
    text += &line("position", &numbers(view.position), "");
    text += &line(
        "look_at",
        &numbers(view.look_at),
        "the middle of the medium, whose bounds fill the frame",
    );
    if view.up != DVec3::Y {
        text += &line("up", &numbers(view.up), "");
    }
    text += &line("vertical_fov", &number(VERTICAL_FOV), "degrees, over the height of the image");
    text + &line("resolution", &format!("{:?}", view.resolution), "pixels")
}

/// A sun from the left and a sky, both dimmed by a factor.
pub fn lights(view: &View, dimmed: f64) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "[[light]]{:22} # a sun from the upper left, before the medium", "");
    text += &line("kind", "\"directional\"", "");
    text += &line(
        "direction",
        &numbers(view.direction(0.75, -0.5, 0.45)),
        "where its light travels to",
    );
    text += &line("irradiance", &rgb([6.0, 5.4, 4.6], dimmed), "W/m^2, RGB");
    let _ = writeln!(text, "\n[[light]]{:22} # a sky all around; it is the background, too", "");
    text += &line("kind", "\"environment\"", "");
    text + &line("radiance", &rgb([0.06, 0.09, 0.14], dimmed), "W/(m^2 sr)")
}

fn rgb(color: [f64; 3], dimmed: f64) -> String {
    format!("[{}]", color.map(|channel| short(channel * dimmed)).join(", "))
}
