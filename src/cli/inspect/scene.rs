//! A scene: its plan.

use std::path::Path;

use photonvdb::scene::{Overrides, Plan, Scene};
use serde_json::json;

use crate::cli::error::CliError;
use crate::cli::{print_json, print_to_stdout};

/// Shows what the scene at `path` needs.
pub fn inspect(path: &Path, as_json: bool, max_volume_memory: Option<u64>) -> Result<(), CliError> {
    let overrides = Overrides { max_volume_memory, ..Overrides::default() };
    let scene = Scene::load_with(path, &overrides)?;
    let plan = Plan::of(&scene);
    if as_json {
        return print_json(&json!({
            "plan": plan,
            "scene_hash": format!("{:016x}", scene.hash),
            "warnings": scene.warnings,
        }));
    }
    let warnings: String =
        scene.warnings.iter().map(|warning| format!("warning: {warning}\n")).collect();
    let [width, height] = [scene.camera.width, scene.camera.height];
    print_to_stdout(&format!(
        "{}: {width} x {height} pixels, hash {:016x}\n{plan}\n{warnings}",
        path.display(),
        scene.hash
    ))
}
